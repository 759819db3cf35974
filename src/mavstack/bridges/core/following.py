"""The vehicles of a connection as a bridge follows them: found, lost, returned, and their status texts."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from mavstack.services.statustext import StatusText
from mavstack.vehicle import VehicleFound, VehicleLost, VehicleReturned

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from mavstack.vehicle import Connection, Vehicle


class FollowedVehicle(Protocol):
    """A vehicle on a bus."""

    def set_connected(self, *, connected: bool) -> None:
        """Publish that the vehicle was lost or returned."""

    def receive_status_text(self, severity: int, text: str) -> None:
        """Publish a status text of the vehicle."""


async def follow_vehicles(
    connection: Connection, add: Callable[[Vehicle], object], vehicles: Mapping[int, FollowedVehicle]
) -> None:
    """Follow the vehicles until the task is cancelled.

    Args:
        connection: The open connection.
        add: Called with each vehicle that is found from now on.
        vehicles: The vehicles on the bus, by system id.
    """
    async with connection.events(VehicleFound, VehicleLost, VehicleReturned, StatusText) as events:
        async for event in events:
            match event:
                case VehicleFound(vehicle=vehicle):
                    add(vehicle)
                case VehicleLost(vehicle=vehicle) | VehicleReturned(vehicle=vehicle):
                    if (known := vehicles.get(vehicle.system)) is not None:
                        known.set_connected(connected=isinstance(event, VehicleReturned))
                case StatusText(source=source, severity=severity, text=text):
                    if (known := vehicles.get(source.system)) is not None:
                        known.receive_status_text(severity, text)
