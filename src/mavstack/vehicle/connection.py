"""A connection to vehicles: a node that knows which of those it hears are vehicles.

    async with mavstack.connect("udpin://0.0.0.0:14550") as node:
        vehicle = await node.wait_for_vehicle()
        await vehicle.arm()
        await vehicle.takeoff(10)

A vehicle is a system with an autopilot; what its heartbeat says it is counts, not its component id. Cameras,
gimbals, companion computers and other ground stations are components, and never taken for one. What happens
to vehicles is told among the node's `events`; see `life`.
"""

from __future__ import annotations

import asyncio
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, TypedDict

from mavstack.errors import MavstackError, RemoteError, RemoteTimeout
from mavstack.node import Node
from mavstack.node.diagnostics import what_was_heard
from mavstack.services import DEFAULT_WAIT_TIMEOUT
from mavstack.vehicle.group import Group
from mavstack.vehicle.status_text_capture import attach_status_texts
from mavstack.vehicle.vehicle import Vehicle
from mavstack.vehicle.vehicle_tracker import VehicleFound, VehicleReturned, VehicleTracker

if TYPE_CHECKING:
    from collections.abc import Generator, Mapping
    from typing import Self, Unpack

    from mavstack._core import HasCoreDialect
    from mavstack.links import Link
    from mavstack.security import SigningKey, TimestampStore
    from mavstack.services import Address, Operation, Service
    from mavstack.services.heartbeat import ComponentInfo


class NodeOptions(TypedDict, total=False):
    """The keywords of `Node`: who we are, and how we speak."""

    system: int
    component: int
    type: int
    autopilot: int
    dialect: HasCoreDialect | None
    version: int
    signing: SigningKey | None
    timestamps: TimestampStore | None
    heartbeat: bool


class Connection(Node):
    """A node whose vehicles are at hand; made by `connect`, opened by `async with` or `await`."""

    def __init__(self, *links: str | Link, **options: Unpack[NodeOptions]) -> None:
        super().__init__(*links, **options)
        self._life = VehicleTracker(self.components, self._vehicle_at)

    async def wait_for_vehicle(
        self, system: int | None = None, *, timeout: float | None = DEFAULT_WAIT_TIMEOUT
    ) -> Vehicle:
        """The first vehicle that is there, or that of a system.

        Raises `RemoteTimeout` if there is none in time; its text tells what was heard instead.
        """
        what = "a vehicle's heartbeat" if system is None else f"the heartbeat of vehicle {system}"
        found = await self.wait_for_component(
            lambda info: self._is_vehicle(info, system), what, timeout=timeout
        )
        return self._life.vehicles[found.address.system]

    @property
    def vehicles(self) -> Mapping[int, Vehicle]:
        """Every vehicle that was heard, by its system id, in the order in which they were found."""
        return MappingProxyType(self._life.vehicles)

    @property
    def ground_stations(self) -> Mapping[Address, ComponentInfo]:
        """Every other ground station that was heard, by its address."""
        return {address: info for address, info in self.components.items() if info.is_ground_station}

    def group(self, *systems: int) -> Group:
        """The vehicles of these systems (none: all that were heard), to be asked as one."""
        if unknown := sorted(set(systems) - set(self.vehicles)):
            known = ", ".join(map(str, self.vehicles)) or "none"
            raise MavstackError(f"no vehicle has the system id {unknown[0]}; those heard: {known}")
        return Group(self.vehicles[system] for system in systems or self.vehicles)

    async def wait_for_vehicles(self, count: int, *, timeout: float | None = DEFAULT_WAIT_TIMEOUT) -> Group:
        """All vehicles that are there, as soon as there are so many; raises `RemoteTimeout`."""
        async with self.events(VehicleFound, VehicleReturned) as events:
            try:
                async with asyncio.timeout(timeout):
                    while len(there := self._there()) < count:
                        await anext(events)
            except (TimeoutError, StopAsyncIteration):
                there = self._there()
                links = ", ".join(str(link.url) for link in self.links) or "no link"
                answer = f"{len(there)} in {timeout:g} s; {what_was_heard(self)}"
                raise RemoteTimeout(f"heartbeats of {count} vehicles", links, answer=answer) from None
        return Group(there)

    def _there(self) -> list[Vehicle]:
        return [vehicle for vehicle in self.vehicles.values() if vehicle.alive]

    def _is_vehicle(self, info: ComponentInfo, system: int | None) -> bool:
        vehicle = self._life.vehicles.get(info.address.system)
        return vehicle is not None and vehicle.address == info.address and system in (None, vehicle.system)

    def _vehicle_at(self, address: Address) -> Vehicle:
        return Vehicle(self, self.component(*address))

    def _happened(self, event: object, service: Service | None = None) -> None:
        super()._happened(event, service)
        for meaning in self._life.follow(event):
            super()._happened(meaning)

    def _failed(self, operation: Operation[Any], begun: float) -> None:
        vehicle = self._life.vehicles.get(operation.target.system)
        if vehicle is not None and isinstance(operation.error, RemoteError):
            attach_status_texts(operation.error, vehicle.telemetry.status_texts.since(begun))

    def __await__(self) -> Generator[Any, None, Self]:
        return self.open().__await__()


def connect(*links: str | Link, **options: Unpack[NodeOptions]) -> Connection:
    """Connect to the vehicles on one link or several; the keywords are those of `Node`.

    The result is awaitable and an async context manager, as websockets' is.
    """
    return Connection(*links, **options)
