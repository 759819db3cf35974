"""A quadrotor from its motors: thrust by command, drag by airspeed, a lag for the motors.

Motors are numbered as PX4 and ArduPilot do: front right and rear left turn counterclockwise seen from above,
front left and rear right clockwise. A motor that turns counterclockwise pushes the frame clockwise.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.simulators.rigid_body import RigidBody

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.sim.vehicle_types import Home
    from mavstack.simulators.rotation import Vector
    from mavstack.simulators.state import State

#: Kilograms, moments of inertia (kg m2), newtons of a motor at full, metres of an arm.
MASS: Final = 1.5
INERTIA: Final = (0.029, 0.029, 0.055)
FULL_THRUST: Final = 7.5
#: Torque of a motor by its thrust, in metres.
TORQUE: Final = 0.05
#: Seconds in which a motor covers 63 % of a change.
LAG: Final = 0.03
#: Drag: newtons by m/s, and newton metres by rad/s.
DRAG: Final = (0.25, 0.25, 0.4)
DAMPING: Final = (0.02, 0.02, 0.03)
_REACH: Final = 0.25 * 0.70710678
#: Forward and right of the centre by _REACH, and the direction of the torque, of each motor.
_MOTORS: Final = ((1.0, 1.0, 1.0), (-1.0, -1.0, 1.0), (1.0, -1.0, -1.0), (-1.0, 1.0, -1.0))
_VOLTAGE: Final = 16.2
#: Amperes of a motor at full.
_CURRENT: Final = 15.0


class Copter:
    """A quadrotor of 1.5 kg that hovers at half throttle.

    Args:
        wind: Metres per second north, east, down.
    """

    def __init__(self, wind: Vector = (0.0, 0.0, 0.0)) -> None:
        self.wind = wind
        self._body = RigidBody(MASS, INERTIA)
        self._thrusts = [0.0] * len(_MOTORS)

    def reset(self, home: Home, heading: float) -> State:
        """Put it at home; see `Physics`."""
        self._body.place(heading)
        self._thrusts = [0.0] * len(_MOTORS)
        return self._body.state()

    def step(self, actuators: Sequence[float], dt: float) -> State:
        """Move it by its motors, 0 to 1 each; see `Physics`."""
        body, thrusts = self._body, self._thrusts
        share = min(dt / LAG, 1.0)
        for index in range(len(_MOTORS)):
            command = min(max(actuators[index], 0.0), 1.0) if index < len(actuators) else 0.0
            thrusts[index] += (FULL_THRUST * command - thrusts[index]) * share
        u, v, w = body.body_velocity(self.wind)
        p, q, r = body.rates
        lift = sum(thrusts)
        roll = -_REACH * sum(thrust * motor[1] for thrust, motor in zip(thrusts, _MOTORS, strict=True))
        pitch = _REACH * sum(thrust * motor[0] for thrust, motor in zip(thrusts, _MOTORS, strict=True))
        yaw = TORQUE * sum(thrust * motor[2] for thrust, motor in zip(thrusts, _MOTORS, strict=True))
        if not (body.is_on_ground and lift < MASS * 9.7 and body.rest(dt)):
            force = (-DRAG[0] * u, -DRAG[1] * v, -DRAG[2] * w - lift)
            torque = (roll - DAMPING[0] * p, pitch - DAMPING[1] * q, yaw - DAMPING[2] * r)
            body.advance(force, torque, dt)
            if body.position[2] > 0.0:
                body.rest(dt)
        return body.state(battery=(_VOLTAGE, 0.3 + _CURRENT * lift / FULL_THRUST))
