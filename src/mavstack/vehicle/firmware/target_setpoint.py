"""A target sent as a setpoint, to vehicles that do not support DO_REPOSITION.

Setpoints have no acknowledgement, so the setpoint is repeated until the vehicle reports the target or moves.
"""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.geodesy import distance
from mavstack.services.setpoints import GlobalSetpoint

if TYPE_CHECKING:
    from mavstack.vehicle.geography import Location
    from mavstack.vehicle.telemetry.values import Position
    from mavstack.vehicle.vehicle import Vehicle

#: The largest number of times the setpoint is sent.
ATTEMPTS: Final = 10
#: Seconds between two of these setpoints.
INTERVAL: Final = 0.5
#: The distance in metres below which two places count as the same place.
_SAME_PLACE: Final = 1.0


async def send_target(vehicle: Vehicle, target: Location) -> None:
    """Send a target (SET_POSITION_TARGET_GLOBAL_INT) until the vehicle has it, or the attempts are used up.

    Args:
        vehicle: The vehicle, in a mode in which it follows setpoints.
        target: The target, its altitude in metres above home.
    """
    start = vehicle.position
    setpoint = GlobalSetpoint(target.latitude, target.longitude, target.altitude)
    for _ in range(ATTEMPTS):
        vehicle.component.send(setpoint.to_message(vehicle.address))
        await asyncio.sleep(INTERVAL)
        if _is_reported(vehicle, target) or _has_moved(start, vehicle.position):
            return


def _is_reported(vehicle: Vehicle, target: Location) -> bool:
    """Return whether the vehicle reports the target as its own."""
    reported = vehicle.latest(common.PositionTargetGlobalInt)
    if reported is None:
        return False
    place = reported.lat_int / 1e7, reported.lon_int / 1e7
    return distance(*place, target.latitude, target.longitude) < _SAME_PLACE


def _has_moved(start: Position | None, now: Position | None) -> bool:
    if start is None or now is None:
        return False
    climb = (now.relative_altitude or 0.0) - (start.relative_altitude or 0.0)
    path = distance(start.latitude, start.longitude, now.latitude, now.longitude)
    return max(path, abs(climb)) > _SAME_PLACE
