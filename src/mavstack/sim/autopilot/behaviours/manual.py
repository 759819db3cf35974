"""Manual flight: the meaning of the pilot's sticks in each kind of mode, for each vehicle type.

                copter, VTOL in hover    wing                   sub                rover, boat
    Manual      lean, thrust             surfaces               thrusters          steering, throttle
    Stabilize   lean, thrust             bank, pitch, throttle  thrusters          as Manual
    Acro        turning rates, thrust    turning rates, throttle  turning rates    turning rate, speed
    Altitude    lean, climb              course, climb          thrusters, climb   as Acro
    Position    speed, climb             course, climb          speed, climb       as Acro

Centred sticks hold altitude, course and position, where the mode controls them.
"""

from __future__ import annotations

from math import atan2, cos, radians, sin
from typing import TYPE_CHECKING

from mavstack.sim.autopilot.behaviour import Behaviour
from mavstack.sim.autopilot.behaviours.steps import ClimbControl, transition
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
    from mavstack.sim.autopilot.radio import Sticks

#: Deflection within which a stick counts as centred.
_CENTRED = 0.08
#: Throttle below which the motors idle on the ground.
_IDLE = 0.08
#: Throttle above which the vehicle leaves the ground, in modes where the throttle controls the climb rate.
_LIFT_OFF = 0.6
_WING_PITCH = radians(20)
#: Climb rate in m/s for each metre of altitude error.
_ALTITUDE_GAIN = 1.0
#: Angle in radians between a wing's present course and the demanded course at full roll stick.
_COURSE_LEAD = radians(35)


def dead_zone(stick: float) -> float:
    """Apply the dead zone to a stick from -1 to 1."""
    if abs(stick) <= _CENTRED:
        return 0.0
    return (stick - _CENTRED if stick > 0 else stick + _CENTRED) / (1 - _CENTRED)


class StickControl(Behaviour):
    """Manual flight, tick by tick."""

    #: Throttle above which an aircraft leaves the ground.
    lifts_off_at = _IDLE

    def __init__(self, autopilot: SimulatedAutopilot, *, forward: bool | None = None) -> None:
        super().__init__(autopilot)
        self.body, self.flight_parameters = autopilot.body, autopilot.flight_parameters
        self._forward = forward
        self.climb = ClimbControl(autopilot)
        #: The altitude (metres down, local) that is held while the throttle is centred; None while it is not.
        self._held_down: float | None = None
        #: The course in radians that a wing holds while the roll stick is centred; None while it is not.
        self.held_course: float | None = None

    def fly(self) -> Iterator[None]:
        """Run until the mode is left."""
        autopilot = self.autopilot
        if not autopilot.landed:
            yield from transition(autopilot, self._forward)
        while True:
            sticks = autopilot.radio.sticks
            if self._rests(sticks):
                self.body.idle()
                self.rested()
            else:
                self.steer(sticks)
            yield

    def steer(self, sticks: Sticks) -> None:
        """Apply the sticks, by vehicle type and flight mode."""
        kind = self.autopilot.vehicle.vehicle_type
        if kind.on_surface:
            self.drive(sticks)
        elif kind is VehicleType.SUB:
            self.dive(sticks)
        elif self.autopilot.maneuvers.circles:
            self.glide(sticks)
        else:
            self.hover(sticks)

    def hover(self, sticks: Sticks) -> None:
        """Apply the sticks of a copter, or of a VTOL in hover."""
        self.body.sticks(*sticks)

    def glide(self, sticks: Sticks) -> None:
        """Apply the sticks of a wing."""
        self.body.sticks(*sticks)

    def dive(self, sticks: Sticks) -> None:
        """Apply the sticks of a sub; a pushed pitch stick means forward."""
        self.body.sticks(sticks.roll, -sticks.pitch, self.middle(sticks), sticks.yaw)

    def drive(self, sticks: Sticks) -> None:
        """Apply the sticks of a rover or boat."""
        self.body.sticks(sticks.roll, 0.0, self.middle(sticks), sticks.yaw)

    def rested(self) -> None:
        """Discard the held altitude and course; the vehicle is on the ground."""
        self._held_down = self.held_course = None

    @staticmethod
    def middle(sticks: Sticks) -> float:
        """Return the throttle of a vehicle that can reverse, -1 to 1."""
        return dead_zone(2 * sticks.throttle - 1)

    def _rests(self, sticks: Sticks) -> bool:
        flies = self.autopilot.vehicle.vehicle_type.flies
        return flies and self.autopilot.landed and sticks.throttle < self.lifts_off_at

    # Helpers of several modes

    def lean(self, sticks: Sticks, thrust: float) -> None:
        """Lean in proportion to the sticks, and turn at a rate."""
        limit = self.flight_parameters.lean_angle
        rate = dead_zone(sticks.yaw) * self.flight_parameters.pilot_yaw_rate
        if rate:
            self.body.hold_attitude(sticks.roll * limit, sticks.pitch * limit, None, thrust, yaw_rate=rate)
        else:
            self.body.hold_attitude(sticks.roll * limit, sticks.pitch * limit, None, thrust)

    def climb_wanted(self, stick: float) -> float:
        """Return the climb rate for a throttle stick from -1 to 1; a centred stick holds the altitude."""
        here = self.autopilot.maneuvers.place[2]
        if stick:
            self._held_down = None
            return stick * self.flight_parameters.pilot_climb_speed
        if self._held_down is None:
            # hold the altitude that the vehicle reaches while it brakes, not the present altitude
            self._held_down = here + self.body.estimate.velocity_down * 0.5
        limit = self.flight_parameters.pilot_climb_speed
        return min(max((here - self._held_down) * _ALTITUDE_GAIN, -limit), limit)


class Manual(StickControl):
    """The sticks move the actuators."""


class Stabilize(StickControl):
    """The sticks set the attitude; centred sticks level the vehicle."""

    def hover(self, sticks: Sticks) -> None:
        """Set attitude, and thrust by the throttle."""
        self.lean(sticks, sticks.throttle)

    def glide(self, sticks: Sticks) -> None:
        """Set bank and pitch."""
        bank = sticks.roll * self.flight_parameters.lean_angle
        self.body.hold_attitude(bank, sticks.pitch * _WING_PITCH, None, sticks.throttle)


class Acro(StickControl):
    """The sticks set turning rates; the vehicle keeps its attitude otherwise."""

    def hover(self, sticks: Sticks) -> None:
        """Set rates, and thrust by the throttle."""
        rate = self.flight_parameters.acro_rate
        turn = dead_zone(sticks.yaw) * self.flight_parameters.pilot_yaw_rate
        self.body.hold_rates(
            dead_zone(sticks.roll) * rate, dead_zone(sticks.pitch) * rate, turn, sticks.throttle
        )

    glide = hover

    def dive(self, sticks: Sticks) -> None:
        """Set rates, and vertical thrust."""
        self.hover(sticks)

    def drive(self, sticks: Sticks) -> None:
        """Set a turning rate and a speed."""
        steered(self, sticks)


class AltitudeHold(StickControl):
    """The sticks set the attitude, the throttle the climb rate."""

    lifts_off_at = _LIFT_OFF

    def hover(self, sticks: Sticks) -> None:
        """Hold the altitude while the throttle is centred."""
        self.lean(sticks, self.climb.thrust(self.climb_wanted(self.middle(sticks))))

    def glide(self, sticks: Sticks) -> None:
        """Set the course by bank and the climb rate by the pitch stick."""
        course_and_climb(self, sticks)

    def dive(self, sticks: Sticks) -> None:
        """Dive by the throttle; other axes are manual."""
        climb = self.climb_wanted(self.middle(sticks))
        error = climb + self.body.estimate.velocity_down
        up = min(max(error * 2.0, -1.0), 1.0)
        self.body.sticks(sticks.roll, -sticks.pitch, up, sticks.yaw)

    def drive(self, sticks: Sticks) -> None:
        """Set a turning rate and a speed."""
        steered(self, sticks)


class PositionHold(AltitudeHold):
    """The sticks set the ground speed; centred sticks hold the position."""

    def __init__(self, autopilot: SimulatedAutopilot, *, forward: bool | None = None) -> None:
        super().__init__(autopilot, forward=forward)
        self._holds = False

    def hover(self, sticks: Sticks) -> None:
        """Set forward and right speed by the sticks."""
        forward, right = -dead_zone(sticks.pitch), dead_zone(sticks.roll)
        turn, climb = dead_zone(sticks.yaw), self.middle(sticks)
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
        """Set forward and right speed, as a copter does."""
        self.hover(sticks)

    def rested(self) -> None:
        """Discard the held position; the vehicle is on the ground."""
        super().rested()
        self._holds = False


def course_and_climb(hand: StickControl, sticks: Sticks) -> None:
    """Hold course and altitude of a wing while the sticks are centred; the throttle sets the airspeed."""
    body, flight_parameters = hand.body, hand.flight_parameters
    here = body.estimate
    climb = hand.climb_wanted(dead_zone(sticks.pitch))
    course = atan2(here.velocity_east, here.velocity_north)
    roll = dead_zone(sticks.roll)
    if roll:
        hand.held_course = None
        course += roll * _COURSE_LEAD
    else:
        hand.held_course = course = course if hand.held_course is None else hand.held_course
    speed = flight_parameters.cruise_speed
    body.fly_velocity(cos(course) * speed, sin(course) * speed, -climb)


def steered(hand: StickControl, sticks: Sticks) -> None:
    """Set turning rate and speed of a rover or boat; only its motors reverse it."""
    throttle, turn = hand.middle(sticks), dead_zone(sticks.roll or sticks.yaw)
    if throttle < 0:
        hand.body.sticks(sticks.roll, 0.0, throttle, sticks.yaw)
        return
    yaw, speed = hand.body.estimate.yaw, throttle * hand.flight_parameters.cruise_speed
    rate = turn * hand.flight_parameters.pilot_yaw_rate
    hand.body.fly_velocity(cos(yaw) * speed, sin(yaw) * speed, 0.0, yaw_rate=rate)
