"""Values about the surroundings of a vehicle, in metres and degrees."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mavstack.dialects import common


@dataclass(frozen=True, slots=True)
class Distance:
    """The measurement of a rangefinder.

    Attributes:
        distance: Metres; None: nothing is in range.
        min_distance: The smallest distance that it measures, in metres.
        max_distance: The largest distance that it measures, in metres.
        orientation: The MAV_SENSOR_ORIENTATION: 25 looks down, 0 forward.
        kind: The MAV_DISTANCE_SENSOR: 0 laser, 1 sonar.
        quality: Percent.
    """

    distance: float | None
    min_distance: float
    max_distance: float
    orientation: common.MavSensorOrientation | int
    kind: common.MavDistanceSensor | int
    quality: float | None = None


@dataclass(frozen=True, slots=True)
class Obstacles:
    """The obstacles around a vehicle.

    Attributes:
        distances: Metres in each sector, clockwise; infinity: free, None: not known.
        increment: The width of a sector, in degrees.
        angle_offset: The direction of the first sector, in degrees clockwise from forward, or from north.
        from_north: True if directions count from north.
    """

    distances: tuple[float | None, ...]
    increment: float
    angle_offset: float = 0.0
    from_north: bool = False

    @property
    def nearest(self) -> tuple[float, float] | None:
        """The distance of the nearest obstacle in metres, and its direction in degrees; None without one."""
        seen = [(metres, at) for at, metres in enumerate(self.distances) if metres is not None]
        metres, sector = min(seen, default=(inf, 0))
        return None if metres == inf else (metres, (self.angle_offset + sector * self.increment) % 360.0)
