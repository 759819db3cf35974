"""Distances that a companion computer measures, as OBSTACLE_DISTANCE and DISTANCE_SENSOR.

Both have whole centimetres. In OBSTACLE_DISTANCE `max_distance + 1` means that a sector is free, and 65535
that nothing is known about it. The first of the 72 sectors looks forward, the others follow clockwise.
"""

from __future__ import annotations

from math import inf, isnan, tau
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from collections.abc import Sequence

SECTORS: Final = 72
SECTOR_WIDTH: Final = 5.0
UNKNOWN: Final = 65_535
_MAX_DISTANCE: Final = 650.0
_CENTIMETRES: Final = 100.0
_CIRCLE: Final = 360.0


def obstacle_message(
    distances: Sequence[float],
    time_usec: int,
    *,
    min_distance: float,
    max_distance: float,
    increment: float | None = None,
    angle_offset: float = 0.0,
    kind: int = common.MavDistanceSensor.LASER,
) -> common.ObstacleDistance:
    """Return OBSTACLE_DISTANCE in the axes of the body.

    Args:
        distances: Metres in each sector, clockwise; infinity: free, NaN: not known.
        time_usec: The time of the measurement in microseconds.
        min_distance: The smallest distance that the sensor measures, metres.
        max_distance: The largest distance that the sensor measures, metres.
        increment: The width of a sector, degrees; None: the sectors go around.
        angle_offset: The direction of the first sector, degrees from forward, clockwise.
        kind: The MAV_DISTANCE_SENSOR.

    Raises:
        InvalidArgumentError: There are no or more than 72 sectors, or the range is not possible.
    """
    if not 1 <= len(distances) <= SECTORS:
        raise InvalidArgumentError(f"obstacles need 1 to {SECTORS} sectors, got {len(distances)}")
    low, high = _range(min_distance, max_distance)
    increment = _CIRCLE / len(distances) if increment is None else float(increment)
    if not 0 < increment * len(distances) <= _CIRCLE + 1e-6:
        raise InvalidArgumentError(f"sectors must cover up to 360 degrees, got increment {increment}")
    centimetres = [_sector(each, low, high) for each in distances]
    return common.ObstacleDistance(
        time_usec=time_usec,
        sensor_type=kind,
        distances=centimetres + [UNKNOWN] * (SECTORS - len(centimetres)),
        increment=round(increment),
        increment_f=increment,
        angle_offset=angle_offset,
        min_distance=low,
        max_distance=high,
        frame=common.MavFrame.BODY_FRD,
    )


def scan_sectors(ranges: Sequence[float], angle_min: float, angle_increment: float) -> list[float]:
    """Return the nearest distance in each of 72 sectors of a laser scan of ROS.

    Args:
        ranges: Metres; infinity: nothing in range, NaN: not known.
        angle_min: The angle of the first range in radians from forward, counter-clockwise.
        angle_increment: The angle between two ranges in radians, counter-clockwise.

    Returns:
        72 distances clockwise from forward, for `obstacle_message`.
    """
    found = [float("nan")] * SECTORS
    width = tau / SECTORS
    for number, distance in enumerate(ranges):
        angle = -(angle_min + number * angle_increment) % tau
        sector = int(angle / width + 0.5) % SECTORS
        if not isnan(distance) and not distance >= found[sector]:
            found[sector] = distance
    return found


def distance_message(
    distance: float,
    time_boot_ms: int,
    *,
    orientation: int,
    min_distance: float,
    max_distance: float,
    kind: int = common.MavDistanceSensor.LASER,
    number: int = 0,
) -> common.DistanceSensor:
    """Return DISTANCE_SENSOR.

    Args:
        distance: Metres; infinity: nothing in range.
        time_boot_ms: The time of the measurement in milliseconds.
        orientation: The MAV_SENSOR_ORIENTATION: 25 looks down, 0 forward.
        min_distance: The smallest distance that the sensor measures, metres.
        max_distance: The largest distance that the sensor measures, metres.
        kind: The MAV_DISTANCE_SENSOR.
        number: The id of the sensor.

    Raises:
        InvalidArgumentError: The distance or the range is not possible.
    """
    low, high = _range(min_distance, max_distance)
    if isnan(distance) or distance < 0:
        raise InvalidArgumentError(f"a distance must be positive or infinite, got {distance}")
    in_range = distance <= max_distance
    return common.DistanceSensor(
        time_boot_ms=time_boot_ms & 0xFFFFFFFF,
        min_distance=low,
        max_distance=high,
        current_distance=max(round(distance * _CENTIMETRES), 0) if in_range else high + 1,
        type=kind,
        id=number,
        orientation=orientation,
        covariance=UNKNOWN & 0xFF,
        signal_quality=100 if in_range else 1,
    )


def _range(low: float, high: float) -> tuple[int, int]:
    if not 0 <= low < high <= _MAX_DISTANCE:
        raise InvalidArgumentError(
            f"min_distance and max_distance must be within 0 to {_MAX_DISTANCE:g} m, got {low} and {high}"
        )
    return round(low * _CENTIMETRES), round(high * _CENTIMETRES)


def _sector(distance: float, low: int, high: int) -> int:
    if isnan(distance):
        return UNKNOWN
    if distance == inf or distance * _CENTIMETRES > high:
        return high + 1
    return max(round(distance * _CENTIMETRES), low)
