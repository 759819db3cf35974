"""Landing: vertical, slower near the ground; or as a wing, by approach, glide, flare and roll-out.

A wing's landing, seen from the side:

    ●───────── descent to the approach altitude, in circles
              ╲  glide along a line of `glide_slope`
               ╲__ flare at `flare_altitude`: nose up, no power
                  ───── roll-out

A VTOL hovers first. A surface vehicle stops, a sub surfaces. The autopilot disarms a landed vehicle after
`land_disarm_delay`.
"""

from __future__ import annotations

from math import atan2, cos, hypot, pi, radians, remainder, sin, tau
from typing import TYPE_CHECKING

from mavstack.sim.autopilot.behaviour import Behaviour
from mavstack.sim.autopilot.behaviours.steps import ClimbControl, transition
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
    from mavstack.sim.autopilot.maneuvers import Point

#: The target of a descent is this many metres below the ground, so that the vehicle does not slow down before
#: it touches the ground.
_BELOW = 60.0
_WATER = 0.0
#: Minimum and maximum height at which a wing's approach begins, in metres.
_LOWEST, _HIGHEST = 15.0, 45.0
_FLARE_PITCH = radians(5)
#: Seconds for which a wing floats above the ground before it touches down.
_FLOATING = 4.0
#: A wing lands against the wind if the wind is stronger than this, in m/s.
_WIND = 1.5
#: Course error in radians below which a wing leaves its last circle for the approach.
_ALIGNED = radians(25)


class Land(Behaviour):
    """Land at `point`, or at the current position.

    `course` is the course of a wing's approach in radians; with `direct` the approach begins immediately at
    the current position.
    """

    landing = True

    def __init__(
        self,
        autopilot: SimulatedAutopilot,
        point: Point | None = None,
        *,
        course: float | None = None,
        yaw: float | None = None,
        direct: bool = False,
        forward: bool = False,
    ) -> None:
        super().__init__(autopilot)
        self._point, self._course, self._yaw, self._direct = point, course, yaw, direct
        #: True if a VTOL in forward flight lands as a plane does.
        self._forward = forward

    def fly(self) -> Iterator[None]:
        """Run until the mode is left: land, then wait for disarming."""
        kind = self.autopilot.vehicle.vehicle_type
        if kind.on_surface:
            yield from self._stop()
        elif kind is VehicleType.SUB:
            yield from self._surface()
        elif kind is VehicleType.PLANE or (self._forward and self.autopilot.body.flies_forward):
            yield from WingLanding(self.autopilot, self._point, self._course, direct=self._direct).fly()
        else:
            yield from self._descend()
        while True:
            yield

    def _stop(self) -> Iterator[None]:
        maneuvers = self.autopilot.maneuvers
        point = maneuvers.hold(self._point)
        while not maneuvers.has_reached(point):
            yield
        maneuvers.hold(point)

    def _surface(self) -> Iterator[None]:
        maneuvers = self.autopilot.maneuvers
        north, east, _ = self._point or maneuvers.stopping_point
        point = north, east, _WATER
        maneuvers.go_to(point, yaw=self._yaw)
        while not maneuvers.has_reached(point):
            yield

    def _descend(self) -> Iterator[None]:
        """Hover above the point, then descend."""
        autopilot = self.autopilot
        if not autopilot.landed:
            if self._point is not None:
                yield from self._go_over(self._point)
            yield from transition(autopilot, forward=False)
            if self._point is not None:
                yield from self._go_over(self._point)
        place = self._point or autopilot.maneuvers.stopping_point
        yaw = autopilot.body.estimate.yaw if self._yaw is None else self._yaw
        climb = ClimbControl(autopilot)
        while not autopilot.landed:
            if autopilot.has_position:
                place = self._sink_to_aim(place, yaw)
            else:
                autopilot.body.hold_attitude(0.0, 0.0, yaw, climb.thrust(-self._sink()))
                place = autopilot.maneuvers.place
            yield
        autopilot.body.idle()

    def _sink_to_aim(self, place: Point, yaw: float) -> Point:
        """Sink at the place, or at the target that the vehicle sees; return the place."""
        aim = self.autopilot.landing_aim()
        if aim is None:
            self.sink_at(place, yaw)
            return place
        if aim.descends:
            self.sink_at(aim.point, yaw)
        else:
            down = self.autopilot.maneuvers.place[2] if aim.keeps_height else aim.point[2]
            self.autopilot.maneuvers.go_to((*aim.point[:2], down), yaw=yaw)
        return aim.point

    def sink_at(self, place: Point, yaw: float) -> None:
        """Sink straight down at a place, with a heading in radians."""
        maneuvers = self.autopilot.maneuvers
        north, east, _ = place
        maneuvers.go_to(
            (north, east, maneuvers.place[2] + _BELOW),
            start=(north, east, maneuvers.place[2]),
            yaw=yaw,
            sink=self._sink(),
        )
        self.autopilot.target = north, east, _WATER

    def _go_over(self, point: Point) -> Iterator[None]:
        maneuvers = self.autopilot.maneuvers
        above = point[0], point[1], maneuvers.place[2]
        maneuvers.go_to(above)
        while not maneuvers.has_reached(above) and self.autopilot.has_position:
            yield

    def _sink(self) -> float:
        flight_parameters, maneuvers = self.autopilot.flight_parameters, self.autopilot.maneuvers
        if maneuvers.height > flight_parameters.land_slow_altitude:
            return maneuvers.sink or flight_parameters.sink_speed
        return flight_parameters.land_speed


class WingLanding:
    """The landing of a wing."""

    def __init__(
        self,
        autopilot: SimulatedAutopilot,
        point: Point | None,
        course: float | None,
        *,
        direct: bool = False,
    ) -> None:
        self._autopilot = autopilot
        self._handling, self._body = autopilot.maneuvers, autopilot.body
        self._direct = direct and point is not None
        north, east, _ = point or self._handling.place
        self._touchdown = north, east, _WATER
        self._course = self._choose_course() if course is None else course
        floated = _FLOATING * self._body.limits.airspeed_min
        self._touchdown = north - cos(self._course) * floated, east - sin(self._course) * floated, _WATER

    def fly(self) -> Iterator[None]:
        """Run until the wing stands."""
        if not self._autopilot.landed:
            start = self._handling.place
            if not self._direct:
                start = self._approach_start()
                yield from self._come_down_to(start)
            yield from self._glide(start)
            yield from self._flare()
        self._body.roll_out()
        while not self._autopilot.landed:
            yield
        self._body.idle()

    def _choose_course(self) -> float:
        """Return the course against the wind; in calm air the direct course."""
        wind = self._body.wind
        if hypot(wind.north, wind.east) > _WIND and not self._direct:
            return atan2(-wind.east, -wind.north)
        if self._handling.distance(self._touchdown) > 1.0:
            return self._handling.bearing(self._touchdown)
        return self._body.estimate.yaw

    def _approach_start(self) -> Point:
        """Return the point where the glide begins."""
        height = min(max(-self._handling.place[2], _LOWEST), _HIGHEST)
        back = height / max(self._autopilot.flight_parameters.glide_slope, 0.02)
        north, east, _ = self._touchdown
        return north - cos(self._course) * back, east - sin(self._course) * back, -height

    def _come_down_to(self, start: Point) -> Iterator[None]:
        """Fly to a circle beside the approach, circle down to its altitude, and leave along the approach."""
        radius = self._autopilot.flight_parameters.loiter_radius
        side = self._course + (pi / 2 if radius > 0 else -pi / 2)
        centre = start[0] + cos(side) * abs(radius), start[1] + sin(side) * abs(radius), start[2]
        self._handling.circle(centre, radius)
        while not (
            self._handling.has_entered_circle(centre, radius)
            and self._handling.is_at_altitude(start[2])
            and abs(remainder(self._track() - self._course, tau)) < _ALIGNED
        ):
            yield

    def _track(self) -> float:
        here = self._body.estimate
        return atan2(here.velocity_east, here.velocity_north)

    def _glide(self, start: Point) -> Iterator[None]:
        flight_parameters = self._autopilot.flight_parameters
        self._handling.go_to(self._touchdown, start=start, sink=max(flight_parameters.sink_speed, 3.0))
        while self._handling.height > flight_parameters.flare_altitude and not self._autopilot.landed:
            if self._handling.has_reached(self._touchdown, 1.0):
                # too high at the end of the approach: extend the line on the same slope
                far, down = 1000.0, 1000.0 * max(flight_parameters.glide_slope, 0.02)
                start = self._handling.place
                beyond = (
                    start[0] + cos(self._course) * far,
                    start[1] + sin(self._course) * far,
                    start[2] + down,
                )
                self._touchdown = beyond
                self._handling.go_to(beyond, start=start)
            yield

    def _flare(self) -> Iterator[None]:
        self._body.hold_attitude(0.0, _FLARE_PITCH, self._course, 0.0)
        while not (self._body.on_ground or self._autopilot.landed):
            yield
