"""How each type of vehicle holds a place, goes to one, and knows that it is there.

What hovers, drives or swims stops at its target. A wing cannot: it holds a place by circling it, has reached
a point when it has passed it, and climbs and sinks on its way. A VTOL is one or the other.
Points are local metres: north, east, down.
"""

from __future__ import annotations

from math import atan2, copysign, cos, hypot, isfinite, sin
from typing import TYPE_CHECKING, Protocol, TypeAlias

from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.sim.autopilot.flight_parameters import FlightParameters
    from mavstack.sim.motion import Body

Point: TypeAlias = tuple[float, float, float]

#: How near in altitude counts as there.
_ALTITUDE_REACHED = 1.0
_WING_ALTITUDE_REACHED = 8.0
#: A wing's line to nowhere in particular is so long.
_AHEAD = 2000.0
#: The share of its acceleration with which a vehicle plans to stop.
_BRAKING = 0.6


class ManeuverVehicle(Protocol):
    """The vehicle that maneuvers move."""

    type: VehicleType


class ManeuverHost(Protocol):
    """The autopilot whose vehicle the maneuvers move."""

    body: Body
    flight_parameters: FlightParameters
    #: The point that the vehicle flies to or circles, in local metres; for telemetry.
    target: Point | None

    @property
    def vehicle(self) -> ManeuverVehicle:
        """The vehicle of the autopilot."""


class Maneuvers:
    """What stops at its target: copter, sub, VTOL in hover."""

    #: Whether it needs a circle to stay somewhere.
    circles = False

    def __init__(self, autopilot: ManeuverHost) -> None:
        self.autopilot = autopilot
        self.body = autopilot.body
        #: The speed that a command or a mission item chose; None: the usual one.
        self.speed: float | None = None
        self.climb: float | None = None
        self.sink: float | None = None
        #: The yaw that a command or mission item chose; None: as the vehicle likes.
        self.yaw: float | None = None
        self._repeat: Callable[[], None] = lambda: None

    # Where it is

    @property
    def place(self) -> Point:
        """Where it believes to be."""
        here = self.body.estimate
        return here.north, here.east, here.down

    @property
    def height(self) -> float:
        """Above the ground or the water: by the rangefinder where it reaches, else as it believes."""
        measured = self.body.sensors.distance
        return measured if isfinite(measured) else -self.body.estimate.down

    @property
    def stopping_point(self) -> Point:
        """Where it comes to rest if it brakes now."""
        here = self.body.estimate
        speed = hypot(here.velocity_north, here.velocity_east)
        seconds = speed / (2 * _BRAKING * max(self.body.limits.acceleration, 0.1))
        return here.north + here.velocity_north * seconds, here.east + here.velocity_east * seconds, here.down

    def distance(self, point: Point) -> float:
        """To a point over the ground."""
        north, east, _ = self.place
        return hypot(point[0] - north, point[1] - east)

    def bearing(self, point: Point) -> float:
        """To a point, in radians from north."""
        north, east, _ = self.place
        return atan2(point[1] - east, point[0] - north)

    def ahead(self, distance: float, course: float | None = None) -> Point:
        """A point as high as it is, on a course or straight ahead."""
        north, east, down = self.place
        course = self.body.estimate.yaw if course is None else course
        return north + cos(course) * distance, east + sin(course) * distance, down

    # Going

    def forget_choices(self) -> None:
        """Fly by the usual flight parameters again."""
        self.speed = self.climb = self.sink = self.yaw = None

    def hold(self, point: Point | None = None, *, radius: float | None = None) -> Point:
        """Stay at a point, or where it comes to rest; `radius` of the circle of what circles."""
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
        """Go to a point, along the line from `start` if there is one, and stay there."""
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
        """Circle a point; radius > 0: clockwise seen from above."""
        self.autopilot.target = centre
        self._repeat = lambda: Maneuvers.circle(self, centre, radius, yaw=yaw)
        speed = speed or self.speed or self.autopilot.flight_parameters.cruise_speed
        self.body.circle(*centre, copysign(max(abs(radius), 1.0), radius), speed=speed, yaw=yaw)

    def again(self) -> None:
        """Have what was chosen meanwhile count for the way that it is on."""
        if self.autopilot.target is not None:
            self._repeat()

    def fly_on(self, course: float | None = None, *, down: float | None = None) -> None:
        """Go far on a course, or straight ahead; to another altitude at once."""
        north, east, here = self.place
        down = here if down is None else down
        far_north, far_east, _ = self.ahead(_AHEAD, course)
        self.go_to((far_north, far_east, down), start=(north, east, down))

    # Having arrived

    def has_reached(self, point: Point, radius: float | None = None) -> bool:
        """Whether it is at a point that it was sent to."""
        near = self.distance(point) <= (radius or self.autopilot.flight_parameters.acceptance_radius)
        return near and self.is_at_altitude(point[2])

    def is_at_altitude(self, down: float) -> bool:
        """Whether it is as high as it was sent."""
        return abs(self.place[2] - down) <= _ALTITUDE_REACHED

    def has_entered_circle(self, centre: Point, radius: float) -> bool:
        """Whether it is on the circle rather than on its way there."""
        return abs(self.distance(centre) - abs(radius)) <= max(0.3 * abs(radius), 1.0)


class SurfaceManeuvers(Maneuvers):
    """What only moves in the plane: rover and boat."""

    def is_at_altitude(self, down: float) -> bool:
        """Always: it cannot be elsewhere."""
        return True


class WingManeuvers(Maneuvers):
    """What flies on: a plane, a VTOL in forward flight."""

    circles = True

    def __init__(self, autopilot: ManeuverHost) -> None:
        super().__init__(autopilot)
        self._start: Point | None = None

    def hold(self, point: Point | None = None, *, radius: float | None = None) -> Point:
        """Circle a point, or where it is."""
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
        """Fly the line to a point and on; its course is its yaw."""
        self._start = start or self.place
        super().go_to(point, start=self._start, speed=speed, sink=sink)

    def has_reached(self, point: Point, radius: float | None = None) -> bool:
        """Near enough, or past the line through the point across the way to it."""
        if self.distance(point) <= (radius or self.autopilot.flight_parameters.acceptance_radius):
            return True
        if self._start is None:
            return False
        north, east, _ = self.place
        along = (point[0] - self._start[0], point[1] - self._start[1])
        return (north - point[0]) * along[0] + (east - point[1]) * along[1] > 0 and hypot(*along) > 1.0

    def is_at_altitude(self, down: float) -> bool:
        """As near as a wing holds it in turns."""
        return abs(self.place[2] - down) <= _WING_ALTITUDE_REACHED

    def spiral(self, centre: Point, down: float) -> None:
        """Circle up or down to an altitude."""
        self.circle((centre[0], centre[1], down), self.autopilot.flight_parameters.loiter_radius)


class VtolManeuvers(WingManeuvers):
    """Both, by how it flies now."""

    @property
    def hovers(self) -> bool:
        """Whether its lift motors carry it, or are to."""
        return not self.body.flies_forward

    @property
    def circles(self) -> bool:  # type: ignore[override]
        """Whether it flies on its wing."""
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
        """By how it flies."""
        if self.hovers:
            return Maneuvers.has_reached(self, point, radius)
        return super().has_reached(point, radius)

    def is_at_altitude(self, down: float) -> bool:
        """By how it flies."""
        return Maneuvers.is_at_altitude(self, down) if self.hovers else super().is_at_altitude(down)


_MANEUVERS: dict[VehicleType, type[Maneuvers]] = {
    VehicleType.PLANE: WingManeuvers,
    VehicleType.VTOL: VtolManeuvers,
    VehicleType.ROVER: SurfaceManeuvers,
    VehicleType.BOAT: SurfaceManeuvers,
}


def maneuvers_of(autopilot: ManeuverHost) -> Maneuvers:
    """How the autopilot's type of vehicle is handled."""
    return _MANEUVERS.get(autopilot.vehicle.type, Maneuvers)(autopilot)
