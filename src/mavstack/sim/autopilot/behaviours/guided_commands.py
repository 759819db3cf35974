"""Guided commands: scripts for the targets of guided flight.

    GoTo      a point; a wing circles it, a hovering VTOL may fly there in forward flight
    Motion    any mix of position, velocity and acceleration, per axis, while it is repeated
    Attitude  an attitude or rates, and a thrust, while they are repeated

Orbits and takeoffs are behaviours of their own. A repeated equal command only renews the active one.
"""

from __future__ import annotations

from abc import abstractmethod
from math import copysign, cos, hypot, sin
from typing import TYPE_CHECKING, TypeAlias

from mavstack.rotation import to_euler
from mavstack.sim.autopilot.behaviour import Behaviour
from mavstack.sim.autopilot.behaviours.steps import ClimbControl, transition
from mavstack.sim.autopilot.ticks import TICK
from mavstack.sim.vehicle_types import VehicleType

if TYPE_CHECKING:
    from collections.abc import Generator, Hashable, Iterator
    from typing import Self

    from mavstack.services.setpoints import AttitudeSetpoint
    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
    from mavstack.sim.autopilot.maneuvers import Point

Axes: TypeAlias = "tuple[float | None, float | None, float | None]"

#: Speed in m/s for each metre of position error.
_POSITION_GAIN = 0.8
#: Distance to the target, in metres, at which a VTOL in forward flight changes to hover.
_HOVER_WITHIN = 120.0
#: The thrust that holds the altitude, for firmware that reads the thrust of a setpoint as a climb rate.
_NO_CLIMB = 0.5


class GuidedCommand(Behaviour):
    """One guided command."""

    def __init__(self, autopilot: SimulatedAutopilot) -> None:
        super().__init__(autopilot)
        self._renewed_at = autopilot.now

    @abstractmethod
    def key(self) -> Hashable:
        """Return the value that is equal for equal commands."""

    @property
    def lifts_off(self) -> bool:
        """True if the command makes a vehicle leave the ground."""
        return False

    def renew(self, other: Self) -> bool:
        """Renew this command if `other` is equal to it; returns whether it was."""
        if type(other) is not type(self) or other.key() != self.key():
            return False
        self._renewed_at = self.autopilot.now
        return True

    @property
    def in_time(self) -> bool:
        """True until the command times out."""
        return self.autopilot.now - self._renewed_at < self.autopilot.flight_parameters.setpoint_timeout


class GoTo(GuidedCommand):
    """Go to a point and stay there; `radius` is the radius of a wing's circle."""

    def __init__(
        self,
        autopilot: SimulatedAutopilot,
        point: Point,
        *,
        speed: float | None = None,
        radius: float | None = None,
        yaw: float | None = None,
        yaw_rate: float | None = None,
    ) -> None:
        super().__init__(autopilot)
        self.point = point
        self._speed, self._radius, self._yaw, self._yaw_rate = speed, radius, yaw, yaw_rate

    def key(self) -> Hashable:
        """Return all values, positions rounded to a decimetre."""
        return (
            tuple(round(axis, 1) for axis in self.point),
            self._speed,
            self._radius,
            self._yaw,
            self._yaw_rate,
        )

    @property
    def lifts_off(self) -> bool:
        """True if the point is in the air."""
        return self.point[2] < self.autopilot.maneuvers.place[2] - 0.3

    def fly(self) -> Iterator[None]:
        """Run until the point is reached."""
        if self._is_far():
            yield from self._fly_forward()
        there = False
        while not there:
            there = yield from (self._loiter() if self.autopilot.maneuvers.circles else self._hover())

    def _hover(self) -> Generator[None, None, bool]:
        """Hover to the point; returns False if the vehicle went into forward flight before."""
        maneuvers = self.autopilot.maneuvers
        maneuvers.go_to(self.point, yaw=self._yaw, speed=self._speed)
        while not maneuvers.has_reached(self.point):
            if maneuvers.circles:
                return False
            yield
        return True

    def _loiter(self) -> Generator[None, None, bool]:
        """Circle the point; returns False if the vehicle went into hover before."""
        maneuvers = self.autopilot.maneuvers
        radius = self._radius or self.autopilot.flight_parameters.loiter_radius
        maneuvers.go_to(self.point, speed=self._speed)
        while maneuvers.distance(self.point) > 2 * abs(radius) and not maneuvers.has_reached(self.point):
            if not maneuvers.circles:
                return False
            yield
        maneuvers.circle(self.point, radius, speed=self._speed)
        while not maneuvers.has_entered_circle(self.point, radius):
            if not maneuvers.circles:
                return False
            yield
        return True

    def _is_far(self) -> bool:
        autopilot = self.autopilot
        if autopilot.vehicle.vehicle_type is not VehicleType.VTOL or autopilot.maneuvers.circles:
            return False
        return autopilot.maneuvers.distance(self.point) > max(
            autopilot.flight_parameters.forward_beyond, _HOVER_WITHIN
        )

    def _fly_forward(self) -> Iterator[None]:
        """Fly to the point in forward flight, then hover."""
        autopilot = self.autopilot
        autopilot.body.transition_to(True)
        autopilot.maneuvers.go_to(self.point, speed=self._speed)
        while autopilot.maneuvers.distance(self.point) > _HOVER_WITHIN:
            yield
        yield from transition(autopilot, forward=False)


class Motion(GuidedCommand):
    """Position, velocity and acceleration per axis in local metres; None leaves an axis free.

    A position with a velocity moves with that velocity. With `turns_along` the velocity turns with the
    vehicle, as for a rover.
    """

    def __init__(
        self,
        autopilot: SimulatedAutopilot,
        position: Axes,
        velocity: Axes,
        acceleration: Axes,
        *,
        yaw: float | None = None,
        yaw_rate: float | None = None,
        turns_along: bool = False,
    ) -> None:
        super().__init__(autopilot)
        self._position, self._velocity, self._acceleration = position, velocity, acceleration
        self._yaw, self._yaw_rate = yaw, yaw_rate
        here = autopilot.body.estimate
        self._heading = here.yaw if turns_along else None
        self._speeds = [here.velocity_north, here.velocity_east, here.velocity_down]
        self._begun = autopilot.now

    def key(self) -> Hashable:
        """Return all values; a moving position differs with every message."""
        if self._position != (None, None, None) and self._velocity != (None, None, None):
            return id(self)
        return self._position, self._velocity, self._acceleration, self._yaw, self._yaw_rate, self._heading

    @property
    def lifts_off(self) -> bool:
        """True if the motion goes upwards."""
        return self._wanted()[2] < -0.1

    def fly(self) -> Iterator[None]:
        """Run until the command times out, then stop."""
        while self.in_time:
            self._steer()
            yield
        self.autopilot.maneuvers.hold()

    def _steer(self) -> None:
        north, east, down = self._wanted()
        if self._heading is not None:
            turned = self.autopilot.body.estimate.yaw - self._heading
            north, east = (north * cos(turned) - east * sin(turned), north * sin(turned) + east * cos(turned))
        self.autopilot.target = self._target()
        yaw = self.autopilot.maneuvers.yaw if self._yaw is None and self._yaw_rate is None else self._yaw
        self.autopilot.body.fly_velocity(north, east, down, yaw=yaw, yaw_rate=self._yaw_rate)

    def _target(self) -> Point | None:
        north, east, down = self._position
        return None if north is None or east is None or down is None else (north, east, down)

    def _wanted(self) -> Point:
        """Return the velocity that results from all inputs."""
        flight_parameters, maneuvers = self.autopilot.flight_parameters, self.autopilot.maneuvers
        passed = self.autopilot.now - self._begun
        closing, given = [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]
        for axis, here in enumerate(maneuvers.place):
            position, velocity = self._position[axis], self._velocity[axis]
            acceleration = self._acceleration[axis]
            if acceleration is not None and position is None:
                self._speeds[axis] += acceleration * TICK
                given[axis] = self._speeds[axis]
            elif velocity is not None:
                given[axis] = velocity
            if position is not None:
                closing[axis] = (position + (velocity or 0.0) * passed - here) * _POSITION_GAIN
        speed = maneuvers.speed or flight_parameters.cruise_speed
        size = hypot(closing[0], closing[1])
        share = min(1.0, speed / size) if size > 0 else 1.0
        climb = min(max(closing[2], -flight_parameters.climb_speed), flight_parameters.sink_speed)
        return given[0] + closing[0] * share, given[1] + closing[1] * share, given[2] + climb


class Attitude(GuidedCommand):
    """An attitude or rates with a thrust, from SET_ATTITUDE_TARGET."""

    def __init__(self, autopilot: SimulatedAutopilot, setpoint: AttitudeSetpoint) -> None:
        super().__init__(autopilot)
        self._setpoint = setpoint
        self._angles = None if setpoint.attitude is None else to_euler(setpoint.attitude)
        self._climb = ClimbControl(autopilot)

    def key(self) -> Hashable:
        """Return the setpoint."""
        return self._setpoint

    @property
    def lifts_off(self) -> bool:
        """True if the thrust exceeds the hover thrust."""
        return (self._setpoint.thrust or 0.0) > _NO_CLIMB + 0.02

    def fly(self) -> Iterator[None]:
        """Run until the command times out, then level out."""
        drives = self.autopilot.vehicle.vehicle_type.on_surface
        while self.in_time:
            if drives:
                self._drive()
            else:
                self._lean()
            yield
        self.autopilot.maneuvers.hold()

    def _lean(self) -> None:
        body, rates = self.autopilot.body, self._setpoint.rates
        thrust = self._thrust()
        if self._angles is None:
            body.hold_rates(rates[0] or 0.0, rates[1] or 0.0, rates[2] or 0.0, thrust)
            return
        roll, pitch, yaw = self._angles
        body.hold_attitude(roll, pitch, None if rates[2] else yaw, thrust, yaw_rate=rates[2] or None)

    def _thrust(self) -> float:
        autopilot = self.autopilot
        thrust = self._setpoint.thrust
        if autopilot.flight_parameters.thrust_is_climb and not autopilot.maneuvers.circles:
            share = 0.0 if thrust is None else (thrust - _NO_CLIMB) / _NO_CLIMB
            return self._climb.thrust(
                copysign(min(abs(share), 1.0), share) * autopilot.flight_parameters.climb_speed
            )
        return max(_NO_CLIMB if thrust is None else thrust, 0.0)

    def _drive(self) -> None:
        """Drive: the thrust is a share of the speed, the attitude's yaw the heading."""
        autopilot, rate = self.autopilot, self._setpoint.rates[2]
        heading = autopilot.body.estimate.yaw
        if self._angles is not None and not rate:
            heading = self._angles[2]
        speed = (self._setpoint.thrust or 0.0) * autopilot.flight_parameters.cruise_speed
        autopilot.body.fly_velocity(
            cos(heading) * speed,
            sin(heading) * speed,
            0.0,
            yaw=None if rate else heading,
            yaw_rate=rate or None,
        )
