"""By hand: what the pilot's sticks mean in each kind of mode, for each type of vehicle.

                copter, VTOL in hover    wing                   sub                rover, boat
    Manual      lean, thrust             surfaces               thrusters          steering, throttle
    Stabilize   lean, thrust             bank, pitch, throttle  thrusters          as Manual
    Acro        turning rates, thrust    turning rates, throttle  turning rates    turning rate, speed
    Altitude    lean, climb              course, climb          thrusters, climb   as Acro
    Position    speed, climb             course, climb          speed, climb       as Acro

Sticks that are centred hold what there is to hold: altitude, course, place.
"""

from __future__ import annotations

from math import atan2, cos, radians, sin
from typing import TYPE_CHECKING

from mavstack.sim.autopilot.behaviour import Behaviour
from mavstack.sim.autopilot.behaviours.steps import ClimbControl, become
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.sim.autopilot.interfaces import Autopilot
    from mavstack.sim.autopilot.radio import Sticks

#: Sticks within this of their middle are centred.
_CENTRED = 0.08
#: On the ground the motors idle below this throttle.
_IDLE = 0.08
#: In the modes that climb by the stick, it leaves the ground above this.
_LIFT_OFF = 0.6
_WING_PITCH = radians(20)
#: m/s of climb for each metre that is missing.
_ALTITUDE_GAIN = 1.0
#: How far ahead of a wing's course its stick puts the course wanted.
_COURSE_LEAD = radians(35)


def dead(stick: float) -> float:
    """A stick from -1 to 1 with nothing around its middle."""
    if abs(stick) <= _CENTRED:
        return 0.0
    return (stick - _CENTRED if stick > 0 else stick + _CENTRED) / (1 - _CENTRED)


class ByHand(Behaviour):
    """Flown by sticks, tick by tick."""

    #: From this throttle on a vehicle that flies leaves the ground.
    lifts_off_at = _IDLE

    def __init__(self, autopilot: Autopilot, *, forward: bool | None = None) -> None:
        super().__init__(autopilot)
        self.body, self.flight_parameters = autopilot.body, autopilot.flight_parameters
        self._forward = forward
        self.climb = ClimbControl(autopilot)
        #: As high as it is to stay while the throttle is centred, in local metres.
        self._held_down: float | None = None
        #: The course of a wing while its stick is centred.
        self.held_course: float | None = None

    def fly(self) -> Iterator[None]:
        """For ever."""
        autopilot = self.autopilot
        if not autopilot.landed:
            yield from become(autopilot, self._forward)
        while True:
            sticks = autopilot.radio.sticks
            if self._rests(sticks):
                self.body.idle()
                self.rested()
            else:
                self.steer(sticks)
            yield

    def steer(self, sticks: Sticks) -> None:
        """Do what the sticks say: by how it flies."""
        kind = self.autopilot.vehicle.type
        if kind.on_surface:
            self.drive(sticks)
        elif kind is VehicleType.SUB:
            self.dive(sticks)
        elif self.autopilot.maneuvers.circles:
            self.glide(sticks)
        else:
            self.hover(sticks)

    def hover(self, sticks: Sticks) -> None:
        """A copter, a VTOL on its lifting motors."""
        self.body.sticks(*sticks)

    def glide(self, sticks: Sticks) -> None:
        """A wing."""
        self.body.sticks(*sticks)

    def dive(self, sticks: Sticks) -> None:
        """A sub: its pitch stick, pushed, is forward."""
        self.body.sticks(sticks.roll, -sticks.pitch, self.middle(sticks), sticks.yaw)

    def drive(self, sticks: Sticks) -> None:
        """A rover, a boat."""
        self.body.sticks(sticks.roll, 0.0, self.middle(sticks), sticks.yaw)

    def rested(self) -> None:
        """It stands on the ground: forget what was held."""
        self._held_down = self.held_course = None

    @staticmethod
    def middle(sticks: Sticks) -> float:
        """The throttle of what can go both ways, -1 to 1."""
        return dead(2 * sticks.throttle - 1)

    def _rests(self, sticks: Sticks) -> bool:
        flies = self.autopilot.vehicle.type.flies
        return flies and self.autopilot.landed and sticks.throttle < self.lifts_off_at

    # What several of them do

    def lean(self, sticks: Sticks, thrust: float) -> None:
        """Lean as far as the sticks say, and turn at a rate."""
        most = self.flight_parameters.lean_angle
        rate = dead(sticks.yaw) * self.flight_parameters.pilot_yaw_rate
        if rate:
            self.body.hold_attitude(sticks.roll * most, sticks.pitch * most, None, thrust, yaw_rate=rate)
        else:
            self.body.hold_attitude(sticks.roll * most, sticks.pitch * most, None, thrust)

    def climb_wanted(self, stick: float) -> float:
        """Up for a stick that is pushed, -1 to 1; what it takes to stay as high for one that is centred."""
        here = self.autopilot.maneuvers.place[2]
        if stick:
            self._held_down = None
            return stick * self.flight_parameters.pilot_climb_speed
        if self._held_down is None:
            # it comes to rest a little later than the stick
            self._held_down = here + self.body.estimate.velocity_down * 0.5
        most = self.flight_parameters.pilot_climb_speed
        return min(max((here - self._held_down) * _ALTITUDE_GAIN, -most), most)


class Manual(ByHand):
    """The sticks move the actuators."""


class Stabilize(ByHand):
    """The sticks lean the vehicle, which else stays level."""

    def hover(self, sticks: Sticks) -> None:
        """Thrust by the throttle."""
        self.lean(sticks, sticks.throttle)

    def glide(self, sticks: Sticks) -> None:
        """Bank and pitch."""
        bank = sticks.roll * self.flight_parameters.lean_angle
        self.body.hold_attitude(bank, sticks.pitch * _WING_PITCH, None, sticks.throttle)


class Acro(ByHand):
    """The sticks turn the vehicle, which stays as it is turned."""

    def hover(self, sticks: Sticks) -> None:
        """Rates, and thrust by the throttle."""
        rate = self.flight_parameters.acro_rate
        turn = dead(sticks.yaw) * self.flight_parameters.pilot_yaw_rate
        self.body.hold_rates(dead(sticks.roll) * rate, dead(sticks.pitch) * rate, turn, sticks.throttle)

    glide = hover

    def dive(self, sticks: Sticks) -> None:
        """Rates, and thrust up and down."""
        self.hover(sticks)

    def drive(self, sticks: Sticks) -> None:
        """A turning rate and a speed."""
        steered(self, sticks)


class AltitudeHold(ByHand):
    """The sticks lean the vehicle, the throttle climbs."""

    lifts_off_at = _LIFT_OFF

    def hover(self, sticks: Sticks) -> None:
        """As high as it is while the throttle is centred."""
        self.lean(sticks, self.climb.thrust(self.climb_wanted(self.middle(sticks))))

    def glide(self, sticks: Sticks) -> None:
        """Course by bank; the pitch stick climbs."""
        course_and_climb(self, sticks)

    def dive(self, sticks: Sticks) -> None:
        """The throttle dives; sideways as by hand."""
        climb = self.climb_wanted(self.middle(sticks))
        error = climb + self.body.estimate.velocity_down
        up = min(max(error * 2.0, -1.0), 1.0)
        self.body.sticks(sticks.roll, -sticks.pitch, up, sticks.yaw)

    def drive(self, sticks: Sticks) -> None:
        """A turning rate and a speed."""
        steered(self, sticks)


class PositionHold(AltitudeHold):
    """The sticks say how fast over the ground; centred, it stays where it is."""

    def __init__(self, autopilot: Autopilot, *, forward: bool | None = None) -> None:
        super().__init__(autopilot, forward=forward)
        self._holds = False

    def hover(self, sticks: Sticks) -> None:
        """Forward and right by the sticks."""
        forward, right = -dead(sticks.pitch), dead(sticks.roll)
        turn, climb = dead(sticks.yaw), self.middle(sticks)
        if not (forward or right or turn or climb):
            if not self._holds:
                self.autopilot.maneuvers.hold()
            self._holds = True
            return
        self._holds = False
        self.autopilot.target = None
        speed, yaw = self.flight_parameters.cruise_speed, self.body.estimate.yaw
        self.body.fly_velocity(
            (forward * cos(yaw) - right * sin(yaw)) * speed,
            (forward * sin(yaw) + right * cos(yaw)) * speed,
            -self.climb_wanted(climb),
            yaw_rate=turn * self.flight_parameters.pilot_yaw_rate if turn else None,
        )

    def dive(self, sticks: Sticks) -> None:
        """As a copter does."""
        self.hover(sticks)

    def rested(self) -> None:
        """It stands on the ground: forget what was held."""
        super().rested()
        self._holds = False


def course_and_climb(hand: ByHand, sticks: Sticks) -> None:
    """A wing keeps its course and altitude but for the sticks; its throttle chooses the airspeed."""
    body, flight_parameters = hand.body, hand.flight_parameters
    here = body.estimate
    climb = hand.climb_wanted(dead(sticks.pitch))
    course = atan2(here.velocity_east, here.velocity_north)
    roll = dead(sticks.roll)
    if roll:
        hand.held_course = None
        course += roll * _COURSE_LEAD
    else:
        hand.held_course = course = course if hand.held_course is None else hand.held_course
    speed = flight_parameters.cruise_speed
    body.fly_velocity(cos(course) * speed, sin(course) * speed, -climb)


def steered(hand: ByHand, sticks: Sticks) -> None:
    """A rover or boat turns at a rate and holds a speed, backwards by its motors alone."""
    throttle, turn = hand.middle(sticks), dead(sticks.roll or sticks.yaw)
    if throttle < 0:
        hand.body.sticks(sticks.roll, 0.0, throttle, sticks.yaw)
        return
    yaw, speed = hand.body.estimate.yaw, throttle * hand.flight_parameters.cruise_speed
    rate = turn * hand.flight_parameters.pilot_yaw_rate
    hand.body.fly_velocity(cos(yaw) * speed, sin(yaw) * speed, 0.0, yaw_rate=rate)
