"""The goal of an orbit: the circle that was asked for, in its direction, at its altitude."""

from __future__ import annotations

from math import inf, isfinite, pi
from typing import TYPE_CHECKING, Final

from mavstack.errors import InvalidArgumentError
from mavstack.geodesy import distance
from mavstack.services.arguments import check_number
from mavstack.vehicle.actions.arrival import WING_HEIGHT, default_tolerance
from mavstack.vehicle.actions.circling import QUARTER, WHOLE, CircleTracker
from mavstack.vehicle.vehicle_type import flies_on_wing

if TYPE_CHECKING:
    from mavstack.vehicle.geography import Location
    from mavstack.vehicle.vehicle import Vehicle

#: The smallest tolerance of a radius on rotors in metres, and the tolerance as a fraction of the radius.
_HOVER_TOLERANCE: Final = (1.0, 0.1)
#: The same two tolerances on a wing.
_WING_TOLERANCE: Final = (10.0, 0.25)
#: The distance along the circle in metres after which a vehicle on rotors is taken to fly the circle.
_PROOF: Final = 50.0
#: The smallest and the largest angle of this distance, in degrees.
_MIN_PROOF, _MAX_PROOF = 15.0, 60.0


def check_radius(radius: float) -> None:
    """Raise unless a radius in metres is that of a circle; a negative one is flown counter-clockwise."""
    check_number("radius", radius, finite=False)
    if not (isfinite(radius) and radius):
        raise InvalidArgumentError(
            f"orbit radius must be finite and not 0 (negative: counter-clockwise), got {radius}"
        )


class Orbiting:
    """The arrival on a circle; a negative radius is counter-clockwise."""

    def __init__(self, vehicle: Vehicle, center: Location, radius: float, asked: float | None) -> None:
        self._vehicle, self._center, self._radius = vehicle, center, radius
        self._asked = asked
        self._circle = CircleTracker(vehicle)

    def reached(self) -> bool:
        """Return whether the vehicle is on the circle and flies along it in its direction."""
        self._circle.update(self._center.latitude, self._center.longitude)
        return self._proven and self._in_direction and self._fits and self._height() <= self._height_limit

    def remaining(self) -> float | None:
        """Return the metres to the circle, over ground and in altitude; None if they are not known."""
        position = self._vehicle.position
        if position is None:
            return None
        center = self._center
        away = distance(position.latitude, position.longitude, center.latitude, center.longitude)
        return abs(away - abs(self._radius)) + self._height()

    def signs(self) -> object:
        """Return a value that changes with the flight around the centre, for one circle."""
        return round(max(min(self._circle.swept, WHOLE), -WHOLE) / 15.0)

    def failure(self) -> str | None:
        """Return how a whole circle differs from the one asked for; None as long as it may change."""
        circle = self._circle
        if abs(circle.swept) < WHOLE or circle.radius is None:
            return None
        if not self._in_direction:
            return f"it circles {'clockwise' if circle.swept > 0 else 'counter-clockwise'}"
        if self._fits:
            return None
        return (
            f"it circles at {circle.radius:.0f} m instead of {abs(self._radius):g} m; "
            "its firmware ignores the radius, or its speed is too high for it"
        )

    def detail(self) -> str:
        """Return what keeps the vehicle from its circle, for an error; empty if nothing is known."""
        height = self._height()
        if self._proven and height > self._height_limit:
            return f"its altitude is {height:.1f} m off, the tolerance is {self._height_limit:g} m"
        return ""

    @property
    def tolerance(self) -> float:
        """The largest error of the radius in metres."""
        minimum, part = _WING_TOLERANCE if self._on_wing else _HOVER_TOLERANCE
        return max(minimum, part * abs(self._radius)) if self._asked is None else self._asked

    @property
    def _on_wing(self) -> bool:
        return flies_on_wing(self._vehicle.vehicle_type, self._vehicle.vtol_state)

    @property
    def _proven(self) -> bool:
        needed = QUARTER
        if not self._on_wing:
            needed = min(max(_PROOF / abs(self._radius) * 180.0 / pi, _MIN_PROOF), _MAX_PROOF)
        return abs(self._circle.swept) >= needed

    @property
    def _in_direction(self) -> bool:
        return self._circle.swept * self._radius > 0

    @property
    def _fits(self) -> bool:
        radius = self._circle.radius
        return radius is not None and abs(radius - abs(self._radius)) <= self.tolerance

    @property
    def _height_limit(self) -> float:
        if self._asked is not None:
            return self._asked
        height = WING_HEIGHT if self._on_wing else default_tolerance(self._vehicle).height
        return inf if height is None else height

    def _height(self) -> float:
        """Return the error of the altitude in metres; 0 if it does not count or is not known."""
        position, altitude = self._vehicle.position, self._center.altitude
        height = None if position is None else position.relative_altitude
        return 0.0 if altitude is None or height is None else abs(altitude - height)
