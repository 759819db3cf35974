"""A connection to vehicles: a node that finds the vehicles among the components on its links.

    async with mavstack.connect("udpin://0.0.0.0:14550") as connection:
        vehicle = await connection.wait_for_vehicle()
        await vehicle.arm()
        await vehicle.takeoff(10)

A vehicle is a system with an autopilot; the type and autopilot of the heartbeat decide that, not the
component id. Cameras, gimbals, companion computers and other ground stations are never vehicles.
The connection's `events` include the events of vehicles; see `mavstack.vehicle.events`.
"""

from __future__ import annotations

import asyncio
import logging
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, TypedDict

from mavstack.errors import InvalidArgumentError, RemoteError
from mavstack.node import Node
from mavstack.node.api_object import ReadOnly
from mavstack.services import DEFAULT_WAIT_TIMEOUT
from mavstack.vehicle.events import (
    SystemIdConflict,
    VehicleEvent,
    VehicleFound,
    VehicleLost,
    VehicleRebooted,
    VehicleReturned,
)
from mavstack.vehicle.group import Group
from mavstack.vehicle.status_text_capture import attach_status_texts
from mavstack.vehicle.vehicle import Vehicle
from mavstack.vehicle.vehicle_tracker import VehicleTracker

if TYPE_CHECKING:
    from collections.abc import Generator, Mapping
    from typing import Self, Unpack

    from mavstack._core import HasCoreDialect
    from mavstack.links import Link
    from mavstack.links.settings import Version
    from mavstack.security import SigningKey, TimestampStore
    from mavstack.services import Address, Operation, Service
    from mavstack.services.heartbeat import ComponentInfo
    from mavstack.vehicle.swarm import Swarm
    from mavstack.vehicle.swarm.controller import SwarmOptions

logger = logging.getLogger("mavstack.vehicle")
_WARNINGS = (SystemIdConflict, VehicleLost, VehicleRebooted)


class NodeOptions(TypedDict, total=False):
    """The keyword arguments of `Node`: the identity of the local component, and how it sends."""

    system: int
    component: int
    type: int
    autopilot: int
    dialect: HasCoreDialect | None
    version: Version
    signing: SigningKey | None
    timestamps: TimestampStore | None
    heartbeat: bool
    heartbeat_rate: float
    channel: str | None
    input_interval: float


class Connection(Node, ReadOnly):
    """A node that finds vehicles; made by `connect`, opened by `async with` or `await`.

    Args:
        *links: URLs such as "udpin://0.0.0.0:14550", or links.
        **options: The keyword arguments of `Node`.
    """

    def __init__(self, *links: str | Link, **options: Unpack[NodeOptions]) -> None:
        super().__init__(*links, **options)
        self._tracker = VehicleTracker(self.components, self._make_vehicle)

    async def wait_for_vehicle(
        self, system: int | None = None, *, timeout: float | None = DEFAULT_WAIT_TIMEOUT
    ) -> Vehicle:
        """Wait for a vehicle.

        Args:
            system: The system id of the vehicle; None: the first vehicle that is alive.
            timeout: Seconds to wait; None waits for ever.

        Returns:
            The vehicle.

        Raises:
            RemoteTimeout: There was none in time; the text names the components that were found instead.
        """
        description = "a vehicle" if system is None else f"vehicle {system}"
        found = await self.wait_for_component(
            lambda info: self._is_vehicle(info, system), description, timeout=timeout
        )
        return self._tracker.vehicles[found.address.system]

    async def wait_for_vehicles(self, count: int, *, timeout: float | None = DEFAULT_WAIT_TIMEOUT) -> Group:
        """Wait until `count` vehicles are alive.

        Args:
            count: The number of vehicles.
            timeout: Seconds to wait; None waits for ever.

        Returns:
            All vehicles that are alive, which may be more.

        Raises:
            RemoteTimeout: There were fewer in time; the text names the components that were found.
        """
        async with self.events(VehicleFound, VehicleReturned) as events:
            try:
                async with asyncio.timeout(timeout):
                    while len(alive := self._alive_vehicles()) < count:
                        await anext(events)
            except (TimeoutError, StopAsyncIteration):
                alive = self._alive_vehicles()
                raise self._wait_error(f"{count} vehicles", str(len(alive)), timeout) from None
        return Group(alive)

    @property
    def vehicles(self) -> Mapping[int, Vehicle]:
        """Every vehicle that was found, by system id, in the order in which they were found."""
        return MappingProxyType(self._tracker.vehicles)

    @property
    def ground_stations(self) -> Mapping[Address, ComponentInfo]:
        """Every other ground station that was found, by address."""
        return {address: info for address, info in self.components.items() if info.is_ground_station}

    def group(self, *systems: int) -> Group:
        """Return a group of vehicles.

        Args:
            *systems: The system ids of the vehicles; none: all vehicles that were found.

        Returns:
            The group.

        Raises:
            InvalidArgumentError: No vehicle with one of the system ids was found.
        """
        if unknown := sorted(set(systems) - set(self.vehicles)):
            known = ", ".join(map(str, self.vehicles)) or "none"
            raise InvalidArgumentError(f"no vehicle with system id {unknown[0]} was found; known: {known}")
        return Group(self.vehicles[system] for system in systems or self.vehicles)

    def swarm(self, *systems: int, options: SwarmOptions | None = None) -> Swarm:
        """Return a swarm of vehicles, which fly as one inside of its `async with` block.

        Args:
            *systems: The system ids of the vehicles, the leader first; none: all vehicles that were found.
            options: How they fly; None: the defaults.

        Returns:
            The swarm. Entering it raises the errors of `Vehicle.guided`.

        Raises:
            InvalidArgumentError: No vehicle with one of the system ids was found.
        """
        from mavstack.vehicle.swarm import Swarm

        return Swarm(self.group(*systems), options)

    def _alive_vehicles(self) -> list[Vehicle]:
        return [vehicle for vehicle in self.vehicles.values() if vehicle.alive]

    def _is_vehicle(self, info: ComponentInfo, system: int | None) -> bool:
        if system not in (None, info.address.system):
            return False
        vehicle = self._tracker.vehicles.get(info.address.system)
        return vehicle is not None and vehicle.address == info.address

    def _make_vehicle(self, address: Address) -> Vehicle:
        return Vehicle(self, self.component(*address))

    def _on_event(self, event: object, service: Service | None = None) -> None:
        super()._on_event(event, service)
        for vehicle_event in self._tracker.receive(event):
            if isinstance(vehicle_event, VehicleEvent):
                level = logging.WARNING if isinstance(vehicle_event, _WARNINGS) else logging.INFO
                logger.log(level, "%s", vehicle_event)
            super()._on_event(vehicle_event)

    def _on_operation_error(self, operation: Operation[Any], begun: float) -> None:
        vehicle = self._tracker.vehicles.get(operation.target.system)
        if vehicle is not None and isinstance(operation.error, RemoteError):
            attach_status_texts(operation.error, vehicle.telemetry.status_texts.since(begun))

    def __await__(self) -> Generator[Any, None, Self]:
        return self.open().__await__()

    async def __aenter__(self) -> Self:
        # jedi takes `Self` for the class whose body defines the method: without this override it completes a
        # `Node`.
        return await super().__aenter__()


def connect(*links: str | Link, **options: Unpack[NodeOptions]) -> Connection:
    """Connect to the vehicles on one link or several.

    Args:
        *links: URLs such as "udpin://0.0.0.0:14550" or "serial:///dev/ttyACM0?baud=115200", or links.
        **options: The keyword arguments of `Node`: `system`, `component`, `signing`, `dialect` and others.

    Returns:
        The connection: an async context manager, which can also be awaited to open it.

    Raises:
        LinkURLError: A URL is not valid.
        InvalidArgumentError: An option is not valid.
    """
    return Connection(*links, **options)
