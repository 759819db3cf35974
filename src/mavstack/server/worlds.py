"""Worlds of real firmware that clients of the station start and stop.

A client names a firmware, a vehicle and a body; it cannot name files or modules of this machine. Programs are
those that the operator of the station has given names (`mav web --program px4=PATH`).
"""

from __future__ import annotations

import asyncio
import logging
from contextlib import suppress
from dataclasses import replace
from itertools import count
from typing import TYPE_CHECKING, Any, Final

from mavstack.errors import InvalidArgumentError, LinkError, MavstackError
from mavstack.http.bodies import RefusedError
from mavstack.simulators.firmware_session import FirmwareOptions, FirmwareSession
from mavstack.simulators.physics import PHYSICS

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.server.sources import Sources

_log = logging.getLogger("mavstack.server")
#: Maximum number of simultaneous worlds, and of log lines that are kept for each.
MAX_WORLDS: Final = 16
MAX_LINES: Final = 200
#: Kinds of physics that read a model from a file.
_FILES: Final = frozenset({"mujoco", "log"})


class StationWorld:
    """One world of the station.

    Attributes:
        id: Its id.
        session: The world and its program.
        source: The id of the source of its vehicle; None: there is none.
    """

    def __init__(self, number: str, options: FirmwareOptions) -> None:
        self.id = number
        self._lines: list[str] = []
        self.session = FirmwareSession(options, on_event=self._add, on_line=self._add)
        self.source: str | None = None
        self._run: asyncio.Task[None] | None = None
        self._error: str | None = None

    async def open(self) -> None:
        """Open the world, and start its program."""
        await self.session.__aenter__()
        self._run = asyncio.get_running_loop().create_task(self._fly())

    async def close(self) -> None:
        """End its program, and close the world."""
        if self._run is not None:
            self._run.cancel()
            with suppress(asyncio.CancelledError):
                await self._run
        await self.session.__aexit__(None, None, None)

    def values(self) -> dict[str, Any]:
        """Return the world as JSON."""
        simulator, options = self.session.simulator, self.session.options
        return {
            "id": self.id,
            "firmware": options.firmware,
            "vehicle": self.session.vehicle,
            "physics": options.physics or self.session.vehicle,
            "port": simulator.port,
            "source": self.source,
            "time": round(simulator.time, 6),
            "speed": simulator.pace.speed,
            "paused": simulator.pace.is_paused,
            "status": self._error or simulator.status,
            "faults": sorted(simulator.sensors.faults.active),
            "lines": self._lines[-MAX_LINES:],
        }

    async def _fly(self) -> None:
        while True:
            try:
                await self.session.run()
            except MavstackError as error:
                self._error = str(error)
                return
            except Exception:  # noqa: BLE001 (of the physics)
                _log.exception("the world %s failed", self.id)
                self._error = "the physics failed; the log of the station has the reason"
                return

    def _add(self, line: str) -> None:
        self._lines.append(line)
        del self._lines[:-MAX_LINES]


class Worlds:
    """The worlds of a station.

    Args:
        sources: The sources of the station; the vehicle of a program becomes one.
        programs: Programs by name that clients may start.
    """

    def __init__(self, sources: Sources, programs: Mapping[str, str]) -> None:
        self._sources, self.programs = sources, dict(programs)
        self._numbers = count(1)
        self._worlds: dict[str, StationWorld] = {}

    @property
    def physics(self) -> tuple[str, ...]:
        """The kinds of physics that clients may choose."""
        return tuple(name for name in PHYSICS if name not in _FILES)

    def list(self) -> list[StationWorld]:
        """Return the worlds, oldest first."""
        return list(self._worlds.values())

    def find(self, number: str) -> StationWorld:
        """Return a world by its id; raises `RefusedError` if there is none."""
        world = self._worlds.get(number)
        if world is None:
            raise RefusedError(404, f"there is no simulator {number[:20]}")
        return world

    async def add(self, options: FirmwareOptions, program: str | None) -> StationWorld:
        """Start a world.

        Args:
            options: Its options.
            program: The name of its program; None: the firmware is started elsewhere.

        Raises:
            RefusedError: There are too many worlds, or a name is not allowed.
            InvalidArgumentError: An option is wrong.
            LinkError: Its port is taken.
        """
        if len(self._worlds) >= MAX_WORLDS:
            raise RefusedError(409, f"there are {MAX_WORLDS} simulators already: remove one")
        kind = (options.physics or "copter").partition(":")[0]
        if kind not in PHYSICS or kind in _FILES:
            known = ", ".join(self.physics)
            raise RefusedError(403, f"clients may choose the physics {known}, not {kind[:40]}")
        if program is not None and program not in self.programs:
            known = ", ".join(self.programs) or "none; mav web --program NAME=PATH gives one a name"
            raise RefusedError(403, f"there is no program {program[:40]}: {known}")
        binary = None if program is None else self.programs[program]
        world = StationWorld(str(next(self._numbers)), replace(options, binary=binary))
        await world.open()
        self._worlds[world.id] = world
        if binary is not None:
            await self._add_source(world)
        return world

    async def remove(self, number: str) -> StationWorld:
        """Stop a world, its program and its source."""
        world = self.find(number)
        del self._worlds[number]
        if world.source is not None:
            with suppress(RefusedError):
                await self._sources.remove(world.source)
        await world.close()
        return world

    async def close(self) -> None:
        """Stop all worlds."""
        for world in self.list():
            await self.remove(world.id)

    async def _add_source(self, world: StationWorld) -> None:
        """Open the link to the vehicle; a port that the station listens on already serves too."""
        try:
            world.source = (await self._sources.add(world.session.url)).id
        except (LinkError, InvalidArgumentError, RefusedError) as error:
            _log.info(
                "the vehicle of simulator %s is expected at a source of the station: %s", world.id, error
            )
