"""The bridge: all vehicles of a connection on all its sinks.

    async with connect(url) as connection, Bridge(connection, [sink]) as bridge:
        await bridge.serve_forever()

Nothing from a bus reaches a vehicle unless the role of the bridge allows it; by default it only observes.
"""

from __future__ import annotations

import asyncio
import logging
from typing import TYPE_CHECKING, Final

from mavstack.bridges.core.following import follow_vehicles
from mavstack.bridges.core.names import VehicleNames, checked_namespace
from mavstack.bridges.core.vehicle_bridge import VehicleBridge
from mavstack.security.roles import Role

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from types import TracebackType
    from typing import Self

    from mavstack.bridges.core.sink import Sink
    from mavstack.vehicle import Connection, Vehicle

logger = logging.getLogger("mavstack.bridges")
#: The prefix of the default vehicle name, which ends with the system id.
DEFAULT_NAME: Final = "uav"


class Bridge:
    """All vehicles of a connection on some buses; an async context manager.

    Args:
        connection: The open connection.
        sinks: The buses.
        namespace: The namespace before `/mavros`; empty: none.
        fleet: Every vehicle has its name before `/mavros`. Otherwise the first one has none.
        vehicle_names: The names of vehicles by system id; others are "uav" and their system id.
        role: The role of the buses.
        report: Called with a line about each vehicle that was found.

    Raises:
        InvalidArgumentError: A name is not one of ROS.
    """

    def __init__(
        self,
        connection: Connection,
        sinks: Sequence[Sink],
        *,
        namespace: str = "",
        fleet: bool = False,
        vehicle_names: Mapping[int, str] | None = None,
        role: Role = Role.OBSERVE,
        report: Callable[[str], None] = logger.info,
    ) -> None:
        self._connection = connection
        self._sinks = tuple(sinks)
        self._namespace = checked_namespace(namespace)
        self._fleet = fleet or bool(vehicle_names)
        self._names = {system: checked_namespace(name) for system, name in (vehicle_names or {}).items()}
        self._role = role
        self._report = report
        self._task: asyncio.Task[None] | None = None
        self._attaching: set[asyncio.Task[None]] = set()
        #: The vehicles on the buses, by system id.
        self.vehicles: dict[int, VehicleBridge] = {}

    async def open(self) -> Self:
        """Open the sinks and follow the vehicles.

        Returns:
            The bridge.
        """
        for sink in self._sinks:
            await sink.open()
        for vehicle in self._connection.vehicles.values():
            self._add(vehicle)
        await asyncio.gather(*self._attaching)
        self._task = asyncio.get_running_loop().create_task(
            follow_vehicles(self._connection, self._add, self.vehicles)
        )
        return self

    async def close(self) -> None:
        """Disconnect all vehicles and close the sinks. Idempotent."""
        if self._task is not None:
            self._task.cancel()
            await asyncio.gather(self._task, return_exceptions=True)
            self._task = None
        for task in self._attaching:
            task.cancel()
        await asyncio.gather(*self._attaching, return_exceptions=True)
        for vehicle in self.vehicles.values():
            await vehicle.close()
        self.vehicles.clear()
        for sink in self._sinks:
            await sink.close()

    async def serve_forever(self) -> None:
        """Wait until the task is cancelled."""
        await asyncio.get_running_loop().create_future()

    def _add(self, vehicle: Vehicle) -> None:
        if vehicle.system in self.vehicles:
            return
        names = self._names_of(vehicle)
        added = self.vehicles[vehicle.system] = VehicleBridge(vehicle, names, self._role)
        added.open()
        task = asyncio.get_running_loop().create_task(self._attach(added))
        self._attaching.add(task)
        task.add_done_callback(self._attaching.discard)

    async def _attach(self, added: VehicleBridge) -> None:
        for sink in self._sinks:
            await added.attach(sink)
        self._report(f"vehicle {added.vehicle.system} is {added.names.namespace}")

    def _names_of(self, vehicle: Vehicle) -> VehicleNames:
        if not self._fleet and not self.vehicles:
            return VehicleNames(self._namespace)
        name = self._names.get(vehicle.system, f"/{DEFAULT_NAME}{vehicle.system}")
        return VehicleNames(self._namespace + name)

    async def __aenter__(self) -> Self:
        return await self.open()

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await self.close()
