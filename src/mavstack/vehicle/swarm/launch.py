"""The takeoff of a swarm: to one height where the starts are apart, else to layers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.services.arguments import check_numbers

if TYPE_CHECKING:
    from mavstack.vehicle.group import Group, Results
    from mavstack.vehicle.vehicle import Vehicle

#: The default takeoff altitude, in metres above home.
DEFAULT_ALTITUDE: Final = 10.0


async def take_off(
    group: Group, altitude: float, *, layer_spacing: float = 0.0, timeout: float | None = None
) -> Results[None]:
    """Arm the vehicles of a group that are on the ground, and let them take off.

    Args:
        group: The vehicles; the first one has the lowest layer.
        altitude: Metres above home of the lowest layer.
        layer_spacing: Metres by which each vehicle is higher than the one before.
        timeout: Seconds for each call; None sets no overall limit.

    Returns:
        The outcome of each vehicle; its errors are those of `Vehicle.arm` and `Vehicle.takeoff`. A vehicle
        in the air is not moved.
    """
    check_numbers(altitude=altitude, layer_spacing=layer_spacing)
    heights = {vehicle: altitude + index * layer_spacing for index, vehicle in enumerate(group)}

    async def launch(vehicle: Vehicle) -> None:
        if vehicle.in_air and vehicle.armed:  # just after a landing it may still say that it flies
            return
        if not vehicle.armed:
            await vehicle.arm(timeout=timeout)
        await vehicle.takeoff(heights[vehicle], timeout=timeout)

    return await group.each(launch, name="takeoff")
