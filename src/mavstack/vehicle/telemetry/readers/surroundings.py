"""The readers of rangefinders and obstacles."""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.vehicle.telemetry.readers.conversions import UINT16_MAX, scaled
from mavstack.vehicle.telemetry.surroundings import Distance, Obstacles

if TYPE_CHECKING:
    from mavstack.vehicle.telemetry.telemetry import Telemetry

_CENTI: Final = 100.0
#: Seconds after which a measurement is out of date.
MAX_AGE: Final = 5.0
_NORTH: Final = (common.MavFrame.GLOBAL, common.MavFrame.LOCAL_NED)


def read_distances(telemetry: Telemetry) -> dict[int, Distance]:
    """Return the measurements of DISTANCE_SENSOR by the id of the sensor."""
    return {number: _distance(message) for number, message in telemetry.distance_sensors(MAX_AGE).items()}


def _distance(message: common.DistanceSensor) -> Distance:
    in_range = message.min_distance <= message.current_distance <= message.max_distance
    return Distance(
        distance=message.current_distance / _CENTI if in_range else None,
        min_distance=message.min_distance / _CENTI,
        max_distance=message.max_distance / _CENTI,
        orientation=message.orientation,
        kind=message.type,
        quality=scaled(message.signal_quality, 0, 1.0),
    )


def read_obstacles(telemetry: Telemetry) -> Obstacles | None:
    """Return the sectors of OBSTACLE_DISTANCE; None without a recent one."""
    age, message = telemetry.age(common.ObstacleDistance), telemetry.latest(common.ObstacleDistance)
    if message is None or age is None or age > MAX_AGE:
        return None
    increment = message.increment_f or float(message.increment)
    return Obstacles(
        tuple(_sector(each, message.max_distance) for each in message.distances),
        increment,
        message.angle_offset,
        message.frame in _NORTH,
    )


def _sector(distance: int, limit: int) -> float | None:
    if distance == UINT16_MAX:
        return None
    return inf if distance > limit else distance / _CENTI
