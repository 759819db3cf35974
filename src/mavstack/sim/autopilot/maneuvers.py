"""Maneuvers of each vehicle type: hold a position, fly to one, and detect the arrival.

A vehicle that hovers, drives or dives stops at its target. A wing circles to hold a position, has reached a
point when it has passed it, and climbs and descends on its way. A VTOL does either.
Points are local metres: north, east, down.
"""

from __future__ import annotations

from math import atan2, copysign, cos, hypot, isfinite, sin
from typing import TYPE_CHECKING, TypeAlias

from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot

Point: TypeAlias = tuple[float, float, float]

#: Altitude errors in metres within which an altitude counts as reached: for hovering vehicles and for wings.
_ALTITUDE_REACHED = 1.0
_WING_ALTITUDE_REACHED = 8.0
#: Without a target a wing flies a line of this length straight ahead, in metres.
_AHEAD = 2000.0
#: Share of the maximum acceleration that is used to brake before a planned stop.
_BRAKING = 0.6


class Maneuvers:
    """Maneuvers of a vehicle that stops at its target: copter, sub, VTOL in hover."""

    #: True for vehicles that circle to hold a position.
    circles = False

    def __init__(self, autopilot: SimulatedAutopilot) -> None:
        self.autopilot = autopilot
        self.body = autopilot.body
        #: The speed in m/s that a command or mission item set; None to use the flight parameters.
        self.speed: float | None = None
        self.climb: float | None = None
        self.sink: float | None = None
        #: The yaw in radians that a command or mission item set; None if the yaw is free.
        self.yaw: float | None = None
        self._repeat: Callable[[], None] = lambda: None

    # Position

    @property
    def place(self) -> Point:
        """The estimated position."""
        here = self.body.estimate
        return here.north, here.east, here.down

    @property
    def height(self) -> float:
        """Height above ground or water in metres, by the rangefinder in its range, else estimated."""
        measured = self.body.sensors.distance
        return measured if isfinite(measured) else -self.body.estimate.down

    @property
    def stopping_point(self) -> Point:
        """The point where the vehicle comes to rest if it brakes now."""
        here = self.body.estimate
        speed = hypot(here.velocity_north, here.velocity_east)
        seconds = speed / (2 * _BRAKING * max(self.body.limits.acceleration, 0.1))
        return here.north + here.velocity_north * seconds, here.east + here.velocity_east * seconds, here.down

    def distance(self, point: Point) -> float:
        """Return the distance to a point over the ground, in metres."""
        north, east, _ = self.place
        return hypot(point[0] - north, point[1] - east)

    def bearing(self, point: Point) -> float:
        """Return the bearing of a point, in radians from north."""
        north, east, _ = self.place
        return atan2(point[1] - east, point[0] - north)

    def ahead(self, distance: float, course: float | None = None) -> Point:
        """Return a point at the current altitude, on a course or straight ahead."""
        north, east, down = self.place
        course = self.body.estimate.yaw if course is None else course
        return north + cos(course) * distance, east + sin(course) * distance, down

    # Motion

    def reset_choices(self) -> None:
        """Discard the chosen speeds and yaw."""
        self.speed = self.climb = self.sink = self.yaw = None

    def hold(self, point: Point | None = None, *, radius: float | None = None) -> Point:
        """Hold a point, or the stopping point; `radius` is the circle's for a vehicle that circles."""
        point = point or self.stopping_point
        self.go_to(point)
        return point

    def go_to(
        self,
        point: Point,
        *,
        start: Point | None = None,
        yaw: float | None = None,
        speed: float | None = None,
        sink: float | None = None,
    ) -> None:
        """Go to a point and stay there.

        Args:
            point: The target.
            start: The start of the line to follow; None for the straight way.
            yaw: The heading in radians; None for the chosen one.
            speed: m/s; None for the chosen one.
            sink: The descent rate in m/s; None for the chosen one.
        """
        flight_parameters = self.autopilot.flight_parameters
        self.autopilot.target = point
        chosen = self.yaw
        self._repeat = lambda: Maneuvers.go_to(
            self, point, start=start, yaw=yaw if self.yaw == chosen else self.yaw, sink=sink
        )
        self.body.go_to(
            *point,
            start=start,
            speed=speed or self.speed or flight_parameters.cruise_speed,
            climb=self.climb or flight_parameters.climb_speed,
            sink=sink or self.sink or flight_parameters.sink_speed,
            yaw=self.yaw if yaw is None else yaw,
        )

    def circle(
        self, centre: Point, radius: float, *, speed: float | None = None, yaw: float | None = None
    ) -> None:
        """Circle a point; a positive radius means clockwise, seen from above."""
        self.autopilot.target = centre
        self._repeat = lambda: Maneuvers.circle(self, centre, radius, yaw=yaw)
        speed = speed or self.speed or self.autopilot.flight_parameters.cruise_speed
        self.body.circle(*centre, copysign(max(abs(radius), 1.0), radius), speed=speed, yaw=yaw)

    def reissue(self) -> None:
        """Apply speeds and yaw that were chosen since to the motion in progress."""
        if self.autopilot.target is not None:
            self._repeat()

    def fly_on(self, course: float | None = None, *, down: float | None = None) -> None:
        """Fly far along a course, or straight ahead, to another altitude on the way."""
        north, east, here = self.place
        down = here if down is None else down
        far_north, far_east, _ = self.ahead(_AHEAD, course)
        self.go_to((far_north, far_east, down), start=(north, east, down))

    # Arrival

    def has_reached(self, point: Point, radius: float | None = None) -> bool:
        """Return whether the vehicle has reached a point."""
        near = self.distance(point) <= (radius or self.autopilot.flight_parameters.acceptance_radius)
        return near and self.is_at_altitude(point[2])

    def is_at_altitude(self, down: float) -> bool:
        """Return whether the vehicle is at the altitude of its target."""
        return abs(self.place[2] - down) <= _ALTITUDE_REACHED

    def has_entered_circle(self, centre: Point, radius: float) -> bool:
        """Return whether the vehicle is on the circle rather than on its way to it."""
        return abs(self.distance(centre) - abs(radius)) <= max(0.3 * abs(radius), 1.0)


class SurfaceManeuvers(Maneuvers):
    """Maneuvers of a rover or boat, which moves in the plane."""

    def is_at_altitude(self, down: float) -> bool:
        """Return True: the vehicle cannot leave the surface."""
        return True


class WingManeuvers(Maneuvers):
    """Maneuvers of a wing: a plane, a VTOL in forward flight."""

    circles = True

    def __init__(self, autopilot: SimulatedAutopilot) -> None:
        super().__init__(autopilot)
        self._start: Point | None = None

    def hold(self, point: Point | None = None, *, radius: float | None = None) -> Point:
        """Circle a point, or the current position."""
        point = point or self.place
        self.circle(point, radius or self.autopilot.flight_parameters.loiter_radius)
        return point

    def go_to(
        self,
        point: Point,
        *,
        start: Point | None = None,
        yaw: float | None = None,
        speed: float | None = None,
        sink: float | None = None,
    ) -> None:
        """Fly the line to a point and beyond; the yaw is the course."""
        self._start = start or self.place
        super().go_to(point, start=self._start, speed=speed, sink=sink)

    def has_reached(self, point: Point, radius: float | None = None) -> bool:
        """Return whether the point is near, or behind the vehicle along its line."""
        if self.distance(point) <= (radius or self.autopilot.flight_parameters.acceptance_radius):
            return True
        if self._start is None:
            return False
        north, east, _ = self.place
        along = (point[0] - self._start[0], point[1] - self._start[1])
        return (north - point[0]) * along[0] + (east - point[1]) * along[1] > 0 and hypot(*along) > 1.0

    def is_at_altitude(self, down: float) -> bool:
        """Return whether the altitude is within the error of a wing in turns."""
        return abs(self.place[2] - down) <= _WING_ALTITUDE_REACHED


class VtolManeuvers(WingManeuvers):
    """Maneuvers of a VTOL, by its current flight mode."""

    @property
    def hovers(self) -> bool:
        """True if the lift motors carry the vehicle, or are about to."""
        return not self.body.flies_forward

    @property
    def circles(self) -> bool:  # type: ignore[override]
        """True in forward flight."""
        return not self.hovers

    def hold(self, point: Point | None = None, *, radius: float | None = None) -> Point:
        """Stay at a point or circle it."""
        if self.hovers:
            return Maneuvers.hold(self, point, radius=radius)
        return super().hold(point, radius=radius)

    def go_to(
        self,
        point: Point,
        *,
        start: Point | None = None,
        yaw: float | None = None,
        speed: float | None = None,
        sink: float | None = None,
    ) -> None:
        """Go to a point, and stay there or fly on."""
        if self.hovers:
            Maneuvers.go_to(self, point, start=start, yaw=yaw, speed=speed, sink=sink)
        else:
            super().go_to(point, start=start, yaw=yaw, speed=speed, sink=sink)

    def has_reached(self, point: Point, radius: float | None = None) -> bool:
        """Return whether a point is reached, by the current flight mode."""
        if self.hovers:
            return Maneuvers.has_reached(self, point, radius)
        return super().has_reached(point, radius)

    def is_at_altitude(self, down: float) -> bool:
        """Return whether the altitude is reached, by the current flight mode."""
        return Maneuvers.is_at_altitude(self, down) if self.hovers else super().is_at_altitude(down)


_MANEUVERS: dict[VehicleType, type[Maneuvers]] = {
    VehicleType.PLANE: WingManeuvers,
    VehicleType.VTOL: VtolManeuvers,
    VehicleType.ROVER: SurfaceManeuvers,
    VehicleType.BOAT: SurfaceManeuvers,
}


def maneuvers_of(autopilot: SimulatedAutopilot) -> Maneuvers:
    """Return the maneuvers of the autopilot's vehicle type."""
    return _MANEUVERS.get(autopilot.vehicle.vehicle_type, Maneuvers)(autopilot)
