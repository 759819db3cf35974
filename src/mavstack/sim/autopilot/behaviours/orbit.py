"""Circling a point: as a mode, and for MAV_CMD_DO_ORBIT."""

from __future__ import annotations

from math import atan2, copysign, pi, remainder, tau
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.sim.autopilot.behaviour import Behaviour
from mavstack.sim.autopilot.behaviours.manual import StickControl
from mavstack.sim.autopilot.behaviours.steps import idle_on_ground, transition

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
    from mavstack.sim.autopilot.maneuvers import Point

_YAW = common.OrbitYawBehaviour
#: The pilot's climb rate is applied by a target altitude this many seconds ahead.
_AHEAD = 1.0


class Orbit(Behaviour):
    """Circle `centre`; a positive radius means clockwise. `turns` None circles without end."""

    def __init__(
        self,
        autopilot: SimulatedAutopilot,
        centre: Point,
        radius: float,
        *,
        speed: float | None = None,
        yaw_behaviour: int = _YAW.HOLD_FRONT_TO_CIRCLE_CENTER,
        turns: float | None = None,
    ) -> None:
        super().__init__(autopilot)
        self.centre = centre
        self.radius = copysign(max(abs(radius), 1.0), radius)
        self.speed = speed
        self.yaw_behaviour = yaw_behaviour
        self.turns = turns
        #: Number of turns since the vehicle reached the circle.
        self.turned = 0.0

    def fly(self) -> Iterator[None]:
        """Run until the last turn is complete."""
        yield from idle_on_ground(self.autopilot)
        maneuvers = self.autopilot.maneuvers
        initial = self.autopilot.body.estimate.yaw
        while not maneuvers.has_entered_circle(self.centre, self.radius):
            self._circle(initial)
            yield
        bearing = self._bearing()
        while self.turns is None or abs(self.turned) < self.turns:
            self._circle(initial)
            yield
            before, bearing = bearing, self._bearing()
            self.turned += remainder(bearing - before, tau) / tau
        maneuvers.hold(None if not maneuvers.circles else self.centre, radius=self.radius)

    def _circle(self, initial: float) -> None:
        self.autopilot.maneuvers.circle(
            self.centre, self.radius, speed=self.speed, yaw=self._yaw_on_circle(initial)
        )

    def _yaw_on_circle(self, initial: float) -> float | None:
        """Return the yaw on the circle in radians; None turns towards the centre."""
        if self.yaw_behaviour == _YAW.HOLD_FRONT_TANGENT_TO_CIRCLE:
            return self._bearing() + copysign(pi / 2, self.radius)
        if self.yaw_behaviour == _YAW.HOLD_FRONT_TO_CIRCLE_CENTER:
            return None
        return initial

    def _bearing(self) -> float:
        """Return the bearing of the vehicle from the centre."""
        north, east, _ = self.autopilot.maneuvers.place
        return atan2(east - self.centre[1], north - self.centre[0])


class Circle(Behaviour):
    """Circle a point one radius ahead, or the current position, as a wing always does."""

    def __init__(self, autopilot: SimulatedAutopilot, *, forward: bool | None = None) -> None:
        super().__init__(autopilot)
        self._forward = forward

    def fly(self) -> Iterator[None]:
        """Run until the mode is left."""
        autopilot = self.autopilot
        yield from idle_on_ground(autopilot)
        yield from transition(autopilot, self._forward)
        maneuvers, flight_parameters = autopilot.maneuvers, autopilot.flight_parameters
        if maneuvers.circles:
            maneuvers.hold()
        else:
            ahead = 0.0 if flight_parameters.circles_where_it_is else abs(flight_parameters.circle_radius)
            centre = maneuvers.ahead(ahead)
            orbit = Orbit(
                autopilot, centre, flight_parameters.circle_radius, speed=flight_parameters.circle_speed
            )
            for _ in orbit.fly():
                self._climb_by_throttle(orbit)
                yield
        while True:
            yield

    def _climb_by_throttle(self, orbit: Orbit) -> None:
        """Climb and descend by the pilot's throttle, if there is a pilot."""
        autopilot = self.autopilot
        radio = autopilot.radio
        if not (autopilot.vehicle.vehicle_type.flies and radio.present):
            return
        climb = StickControl.middle(radio.sticks) * autopilot.flight_parameters.pilot_climb_speed
        if climb:
            north, east, _ = orbit.centre
            orbit.centre = north, east, autopilot.maneuvers.place[2] - climb * _AHEAD
