"""A quadrotor from its motors: thrust by command, drag by airspeed, a lag for the motors.

Motors are numbered as PX4 and ArduPilot do: front right and rear left turn counterclockwise seen from above,
front left and rear right clockwise. A motor that turns counterclockwise pushes the frame clockwise.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.simulators.rigid_body import RigidBody

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.rotation import Vector
    from mavstack.sim.vehicle_types import Home
    from mavstack.simulators.state import State

#: Mass in kg, moments of inertia in kg m2, maximum thrust of one motor in newtons.
MASS: Final = 1.5
INERTIA: Final = (0.029, 0.029, 0.055)
FULL_THRUST: Final = 7.5
#: Torque of a motor per newton of thrust, in metres.
TORQUE: Final = 0.05
#: Time constant of a motor in seconds, after which 63 % of a change is reached.
LAG: Final = 0.03
#: Drag in newtons per m/s, and damping in newton metres per rad/s, by axis.
DRAG: Final = (0.25, 0.25, 0.4)
DAMPING: Final = (0.02, 0.02, 0.03)
_REACH: Final = 0.25 * 0.70710678
#: For each motor: its forward and right coordinates in lengths of the arm, and the direction of its torque.
MOTORS: Final = ((1.0, 1.0, 1.0), (-1.0, -1.0, 1.0), (1.0, -1.0, -1.0), (-1.0, 1.0, -1.0))
_VOLTAGE: Final = 16.2
#: Current of a motor at full throttle, in amperes.
_CURRENT: Final = 15.0


class Copter:
    """A quadrotor of 1.5 kg that hovers at half throttle.

    Args:
        wind: Metres per second north, east, down.
    """

    def __init__(self, wind: Vector = (0.0, 0.0, 0.0)) -> None:
        self.wind = wind
        self._body = RigidBody(MASS, INERTIA)
        self._thrusts = [0.0] * len(MOTORS)

    def reset(self, home: Home, heading: float) -> State:
        """Put it at home; see `Physics`."""
        self._body.place(heading)
        self._thrusts = [0.0] * len(MOTORS)
        return self._body.state()

    def step(self, actuators: Sequence[float], dt: float) -> State:
        """Move it by its motors, 0 to 1 each; see `Physics`."""
        body = self._body
        a, b, c, d = thrusts = self._spin(actuators, dt)
        u, v, w = body.body_velocity(self.wind)
        p, q, r = body.rates
        lift = a + b + c + d
        roll = _REACH * (b + c - a - d)
        pitch = _REACH * (a + c - b - d)
        yaw = TORQUE * (a + b - c - d)
        if not (body.is_on_ground and lift < MASS * 9.7 and body.rest(dt)):
            force = (-DRAG[0] * u, -DRAG[1] * v, -DRAG[2] * w - lift)
            torque = (roll - DAMPING[0] * p, pitch - DAMPING[1] * q, yaw - DAMPING[2] * r)
            body.advance(force, torque, dt)
            if body.position[2] > 0.0:
                body.rest(dt)
        self._thrusts = thrusts
        return body.state(battery=(_VOLTAGE, 0.3 + _CURRENT * lift / FULL_THRUST))

    def _spin(self, actuators: Sequence[float], dt: float) -> list[float]:
        """Return the thrusts of the motors after a step."""
        share = min(dt / LAG, 1.0)
        commands = [*actuators[: len(MOTORS)], *[0.0] * (len(MOTORS) - len(actuators))]
        return [
            old + (FULL_THRUST * (0.0 if new < 0.0 else min(new, 1.0)) - old) * share
            for old, new in zip(self._thrusts, commands, strict=True)
        ]
