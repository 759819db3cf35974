"""The parameters of vehicles in Foxglove's panel: `/mavros/param/RTL_ALT`.

A client gets the values that are known; the first request downloads the others, which follow when they come.
"""

from __future__ import annotations

import asyncio
import logging
from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.endpoints import NO_CONTROL
from mavstack.errors import MavstackError
from mavstack.security.roles import Role

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from mavstack.bridges.core.vehicle_bridge import VehicleBridge

logger = logging.getLogger("mavstack.bridges")
Value = int | float
#: Maximum number of parameters that are written at the same time.
MAX_WRITES: Final = 64
#: The text before the MAVLink parameter name in a Foxglove parameter name.
_FOLDER: Final = "/param/"


class FoxgloveParameters:
    """The parameters of all vehicles of a bridge. All methods run in the event loop.

    Args:
        vehicles: The vehicles of the bridge.
        role: The role of the bus.
        publish: Publishes values by name.
    """

    def __init__(
        self,
        vehicles: Mapping[int, VehicleBridge],
        role: Role,
        publish: Callable[[Mapping[str, Value]], object],
    ) -> None:
        self._vehicles = vehicles
        self._role = role
        self._publish = publish
        self._downloaded: set[int] = set()
        self._tasks: set[asyncio.Task[None]] = set()

    def values(self, names: Iterable[str] = ()) -> dict[str, Value]:
        """Return the known values of these names, of all if there are none."""
        wanted = set(names)
        found = {name: value for vehicle in self._vehicles.values() for name, value in _known(vehicle)}
        return {name: value for name, value in found.items() if not wanted or name in wanted}

    def download(self) -> None:
        """Download the parameters of the vehicles of which that was not done."""
        for vehicle in self._vehicles.values():
            if vehicle.vehicle.system not in self._downloaded:
                self._downloaded.add(vehicle.vehicle.system)
                self._start(self._download(vehicle))

    def write(self, name: str, value: object) -> str:
        """Begin to write a parameter; return why not, or an empty text."""
        if self._role < Role.ADMINISTER:
            return f"writing {name} refused: {NO_CONTROL} and the role administer"
        vehicle, key = self._find(name)
        if vehicle is None:
            return f"writing {name} refused: there is no such vehicle"
        if isinstance(value, bool) or not isinstance(value, int | float):
            return f"writing {name} refused: the value must be a number, got {value!r:.40}"
        if len(self._tasks) >= MAX_WRITES:
            return f"writing {name} refused: {MAX_WRITES} writes are under way"
        self._start(self._write(vehicle, key, value))
        return ""

    async def close(self) -> None:
        """Cancel the running work."""
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)

    def _find(self, name: str) -> tuple[VehicleBridge | None, str]:
        namespace, _, key = name.rpartition(_FOLDER)
        found = (each for each in self._vehicles.values() if each.names.namespace == namespace)
        return next(found, None), key

    def _start(self, work: Any) -> None:
        task = asyncio.get_running_loop().create_task(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def _download(self, vehicle: VehicleBridge) -> None:
        try:
            await vehicle.vehicle.params.download()
        except MavstackError as error:
            self._downloaded.discard(vehicle.vehicle.system)
            logger.info("%s", error)
        self._publish(dict(_known(vehicle)))

    async def _write(self, vehicle: VehicleBridge, key: str, value: Value) -> None:
        try:
            await vehicle.vehicle.params.set(key, value)
        except (MavstackError, ValueError, TypeError) as error:
            logger.warning("writing %s failed: %s", key, error)
        self._publish({name: each for name, each in _known(vehicle) if name.endswith(f"{_FOLDER}{key}")})


def _known(vehicle: VehicleBridge) -> list[tuple[str, Value]]:
    namespace = vehicle.names.namespace
    return [
        (f"{namespace}{_FOLDER}{name}", each.value) for name, each in vehicle.vehicle.params.cached.items()
    ]
