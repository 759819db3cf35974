"""The circle that a vehicle flies around a place, as its reported positions show it.

A wing cannot stop at a place: it has arrived when it circles it. The radius of its circle depends on the
firmware, its parameters, the speed and the wind; the circle is therefore detected by the flight itself:

    samples      bearing from the place, distance, altitude, for each reported position
    stretch      the latest samples whose distances differ by less than a third: on a circle, not on a line
    swept        the angle of the stretch, positive clockwise
    established  the stretch has swept a quarter of a circle, which no straight pass does

On a straight line the distance stays within a ratio r over an angle of 2 acos(1/r): 79 degrees for 1.3.
"""

from __future__ import annotations

from collections import deque
from math import atan2, degrees, remainder
from typing import TYPE_CHECKING, Final, NamedTuple

from mavstack.geodesy import distance, offset

if TYPE_CHECKING:
    from mavstack.vehicle.telemetry.values import Position
    from mavstack.vehicle.vehicle import Vehicle

#: The largest distance from the centre in a stretch of positions, divided by the smallest.
_MAX_RATIO: Final = 1.3
#: The angle of a stretch in degrees that shows a circle: the stretch of a straight pass sweeps less.
QUARTER: Final = 90.0
#: The angle of a whole circle in degrees; a stretch keeps no older positions.
WHOLE: Final = 360.0
#: The smallest step between two samples, in metres.
_MIN_STEP: Final = 0.2
#: The smallest step between two samples, as a fraction of the distance from the centre.
_MIN_STEP_PART: Final = 0.02
#: The distance from the centre in metres below which the bearing is not certain.
_MIN_DISTANCE: Final = 1.0
#: The angle in degrees by which a vehicle turns back before a new stretch begins; larger than the noise of
#: positions.
_REVERSAL: Final = 5.0
_MAX_SAMPLES: Final = 1000


class _Sample(NamedTuple):
    angle: float
    distance: float
    altitude: float | None


class CircleTracker:
    """Follows the flight of a vehicle around a place."""

    def __init__(self, vehicle: Vehicle) -> None:
        self._vehicle = vehicle
        self._center: tuple[float, float] | None = None
        self._last: Position | None = None
        self._bearing = 0.0
        self._stretch: deque[_Sample] = deque(maxlen=_MAX_SAMPLES)

    def update(self, latitude: float, longitude: float) -> None:
        """Take in the present position; another place begins a new circle."""
        if self._center != (latitude, longitude):
            self._center = latitude, longitude
            self._stretch.clear()
            self._last = None
        position = self._vehicle.position
        if position is None:
            return
        away = distance(latitude, longitude, position.latitude, position.longitude)
        if not self._has_moved(position, max(_MIN_STEP, away * _MIN_STEP_PART)):
            return
        self._last = position
        if away < _MIN_DISTANCE:
            self._stretch.clear()
            return
        self._add(position, away, _bearing(latitude, longitude, position))

    def _has_moved(self, position: Position, metres: float) -> bool:
        last = self._last
        if last is None:
            return True
        return distance(last.latitude, last.longitude, position.latitude, position.longitude) >= metres

    def _add(self, position: Position, away: float, bearing: float) -> None:
        stretch = self._stretch
        angle = stretch[-1].angle + remainder(bearing - self._bearing, 360.0) if stretch else 0.0
        self._bearing = bearing
        stretch.append(_Sample(angle, away, position.relative_altitude))
        self._drop_what_is_no_circle()

    def _drop_what_is_no_circle(self) -> None:
        stretch, kept, extreme = self._stretch, 0, 0.0
        newest = stretch[-1]
        nearest = farthest = newest.distance
        for sample in reversed(stretch):
            nearest, farthest = min(nearest, sample.distance), max(farthest, sample.distance)
            turned = newest.angle - sample.angle
            extreme = max(extreme, turned, key=abs)
            if farthest > nearest * _MAX_RATIO or abs(extreme) - abs(turned) > _REVERSAL:
                break
            kept += 1
            if abs(turned) > WHOLE:
                break
        while len(stretch) > kept:
            stretch.popleft()

    @property
    def swept(self) -> float:
        """The angle of the present circle in degrees, positive clockwise; at most a little above 360."""
        return self._stretch[-1].angle - self._stretch[0].angle if self._stretch else 0.0

    @property
    def established(self) -> bool:
        """True if the vehicle circles the place rather than passes it."""
        return abs(self.swept) >= QUARTER

    @property
    def radius(self) -> float | None:
        """The mean distance over the last quarter of the circle, in metres; None before the first sample."""
        quarter = self._quarter()
        return sum(sample.distance for sample in quarter) / len(quarter) if quarter else None

    @property
    def climbed(self) -> float | None:
        """The range of altitudes over the last quarter of the circle, in metres; None if not known."""
        altitudes = [sample.altitude for sample in self._quarter() if sample.altitude is not None]
        return max(altitudes) - min(altitudes) if altitudes else None

    def _quarter(self) -> list[_Sample]:
        stretch = self._stretch
        return [sample for sample in stretch if abs(stretch[-1].angle - sample.angle) <= QUARTER]


def _bearing(latitude: float, longitude: float, position: Position) -> float:
    """Return the bearing of a position from a place, in degrees clockwise from north."""
    north, east = offset(latitude, longitude, position.latitude, position.longitude)
    return degrees(atan2(east, north)) % 360.0
