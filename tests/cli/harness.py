"""A harness that runs `mav` in this process against simulated vehicles, in virtual time.

The simulation lives on from one command to the next, so what one command sets another finds.
"""

from __future__ import annotations

import asyncio
import shlex
from itertools import repeat
from typing import TYPE_CHECKING

from mavstack.cli.common import connection
from mavstack.cli.shell import command as shell_command
from mavstack.links import MemoryNetwork, parse_url
from mavstack.node import Node
from mavstack.security.key_store import find_key
from mavstack.sim.fleet import Fleet
from mavstack.sim.simulation import Simulation
from mavstack.sim.vehicle_types import DEFAULT_HOME, Firmware, VehicleType
from mavstack.sim.virtual import run_virtually
from mavstack.vehicle import connect
from tests.sim.running import make_ready, reduce_telemetry, running

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable, Coroutine

    import pytest

    from mavstack.node import RemoteComponent
    from mavstack.sim.vehicle import SimulatedVehicle

COPTER, PX4_COPTER = (VehicleType.COPTER, Firmware.ARDUPILOT), (VehicleType.COPTER, Firmware.PX4)
EXAMPLE = "  mav "


class CliHarness:
    """Simulated vehicles that every command of `mav` reaches, whatever URL it is given."""

    def __init__(
        self,
        monkeypatch: pytest.MonkeyPatch,
        *kinds: tuple[VehicleType, str],
        ready: bool = False,
        payloads: bool = False,
        apart: bool = False,
    ) -> None:
        """Make a vehicle of each kind (one ArduPilot copter by default).

        They stand at one place, or `apart` as those of `mav sim`; if `ready`, they can arm.
        """
        self.simulation = Simulation(seed=5)
        chosen = kinds or (COPTER,)
        homes = Fleet(count=len(chosen)).homes() if apart else repeat(DEFAULT_HOME)
        for (vehicle_type, firmware), home in zip(chosen, homes, strict=False):
            vehicle = self.simulation.add(vehicle_type, firmware, home=home, camera=payloads, gimbal=payloads)
            reduce_telemetry(vehicle)
        if ready:
            make_ready(self.simulation)
        #: Coroutine of another ground station that runs beside a command.
        self.meanwhile: Callable[[RemoteComponent], Awaitable[None]] | None = None
        #: The URLs of the last connection.
        self.urls: tuple[str, ...] = ()
        self._network = MemoryNetwork()
        monkeypatch.setattr(asyncio, "run", self._run)
        monkeypatch.setattr(connection, "connect", self._connect)
        monkeypatch.setattr(shell_command, "connect", self._connect)

    @property
    def vehicle(self) -> SimulatedVehicle:
        """The first vehicle."""
        return self.simulation.vehicles[0]

    def put(self, path: str, data: bytes) -> None:
        """Put a file onto the vehicle."""
        self.vehicle.storage.store[path] = data  # type: ignore[index]

    def file(self, path: str) -> bytes | None:
        """A file of the vehicle, if it is there."""
        store = self.vehicle.storage.store
        return bytes(store[path]) if path in store else None  # type: ignore[index, operator]

    def has_directory(self, path: str) -> bool:
        try:
            self.vehicle.storage.store.list_directory(path)
        except OSError:
            return False
        return True

    def _connect(self, *urls: str, channel: str | None = None):
        self.urls = urls
        keys = [key for url in urls if (key := parse_url(url).options.get("signing_key"))]
        signing = find_key(keys[0]) if keys else None
        return connect(self._network.link(), signing=signing, channel=channel)

    def _run(self, work: Coroutine[None, None, int]) -> int:
        return run_virtually(self._simulated(work))

    async def _simulated(self, work: Coroutine[None, None, int]) -> int:
        self._network = MemoryNetwork()
        async with running(self.simulation, self._network.link()):
            return await (work if self.meanwhile is None else self._with_other_station(work))

    async def _with_other_station(self, work: Coroutine[None, None, int]) -> int:
        async with Node(self._network.link(), system=254) as other:
            beside = asyncio.create_task(self.meanwhile(await other.wait_for_autopilot()))
            code = await work
            await beside
        return code


def examples_of(text: str) -> list[list[str]]:
    """The commands that a help text shows, as words without `mav`."""
    lines = [line.removeprefix(EXAMPLE) for line in text.splitlines() if line.startswith(EXAMPLE)]
    return [shlex.split(line, comments=True) for line in lines]
