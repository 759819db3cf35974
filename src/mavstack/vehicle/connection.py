"""A connection to vehicles: a node that knows which of those it hears are vehicles.

    async with mavstack.connect("udpin://0.0.0.0:14550") as node:
        vehicle = await node.vehicle()
        await vehicle.arm()
        await vehicle.takeoff(10)

A vehicle is a system with an autopilot; what its heartbeat says it is counts, not its component id. Cameras,
gimbals, companion computers and other ground stations are components, and never taken for one.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mavstack.dialects import common
from mavstack.node import Node
from mavstack.node.node import FIRST_HEARTBEAT
from mavstack.vehicle.vehicle import Vehicle

if TYPE_CHECKING:
    from collections.abc import Generator, Mapping
    from typing import Self

    from mavstack.links import Link


class Connection(Node):
    """A node whose vehicles are at hand; made by `connect`, opened by `async with` or `await`."""

    def __init__(self, *links: str | Link, **options: Any) -> None:  # noqa: ANN401 (those of Node)
        super().__init__(*links, **options)
        self._vehicles: dict[int, Vehicle] = {}

    async def vehicle(self, system: int | None = None, *, timeout: float = FIRST_HEARTBEAT) -> Vehicle:
        """The first vehicle heard, or that of a system; raises `RemoteTimeout` if there is none in time."""
        remote = await self.autopilot(system, timeout=timeout)
        return self._vehicle_of(remote.address.system, remote.address.component)

    @property
    def vehicles(self) -> Mapping[int, Vehicle]:
        """Every vehicle that was heard, by its system id, in the order in which they were found."""
        for address, info in self.components.items():
            if info.is_autopilot:
                self._vehicle_of(*address)
        return self._vehicles

    def _vehicle_of(self, system: int, component: int = common.MavComponent.AUTOPILOT1) -> Vehicle:
        known = self._vehicles.get(system)
        if known is None:
            known = self._vehicles[system] = Vehicle(self, self.remote(system, component))
        return known

    def __await__(self) -> Generator[Any, None, Self]:
        return self.open().__await__()


def connect(*links: str | Link, **options: Any) -> Connection:  # noqa: ANN401 (those of Node)
    """Connect to the vehicles on one link or several; the keywords are those of `Node`.

    The result is awaitable and an async context manager, as websockets' is.
    """
    return Connection(*links, **options)
