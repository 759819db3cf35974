"""A VTOL plane: a wing with ailerons, elevator, rudder and a propeller, and four lifting motors.

The motors turn and lift it as those of a copter, the wing takes over with the airspeed. It stands on legs.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

from mavstack.simulators.bodies.copter import MOTORS
from mavstack.simulators.bodies.wing import wing_forces
from mavstack.simulators.rigid_body import RigidBody

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.rotation import Vector
    from mavstack.sim.vehicle_types import Home
    from mavstack.simulators.state import State

MASS: Final = 2.4
INERTIA: Final = (0.12, 0.13, 0.22)
#: Full thrust of a lifting motor in newtons, its torque per newton and its distance from each axis in metres.
LIFT_THRUST, LIFT_TORQUE, REACH = 12.0, 0.05, 0.3
#: Static thrust of the propeller in newtons, and the airspeed in m/s at which its thrust is zero.
FULL_THRUST, TOP_SPEED = 14.0, 32.0
#: Drag of motors and legs in newtons per m/s; damping in newton metres per rad/s.
DRAG: Final = (0.12, 0.3, 0.5)
DAMPING: Final = (0.06, 0.06, 0.08)
#: Time constants of lifting motors and propeller in seconds, after which 63 % of a change is reached.
LIFT_LAG, LAG = 0.04, 0.15
_SURFACES: Final = 4


class QuadPlane:
    """A VTOL plane of 2.4 kg that hovers at half throttle and flies at 13 to 25 m/s.

    Args:
        wind: Metres per second north, east, down.
    """

    def __init__(self, wind: Vector = (0.0, 0.0, 0.0)) -> None:
        self.wind = wind
        self._body = RigidBody(MASS, INERTIA)
        self._throttle = 0.0
        self._lifts = [0.0] * len(MOTORS)

    def reset(self, home: Home, heading: float) -> State:
        """Put it on its legs at home; see `Physics`."""
        self._body.place(heading)
        self._throttle, self._lifts = 0.0, [0.0] * len(MOTORS)
        return self._body.state(airspeed=0.0)

    def step(self, actuators: Sequence[float], dt: float) -> State:
        """Move it by aileron, elevator, throttle, rudder and four lifting motors; see `Physics`."""
        values = [max(-1.0, min(1.0, value)) for value in actuators[: _SURFACES + len(MOTORS)]]
        values += [0.0] * (_SURFACES + len(MOTORS) - len(values))
        aileron, elevator, throttle, rudder = values[:_SURFACES]
        self._throttle += (max(throttle, 0.0) - self._throttle) * min(dt / LAG, 1.0)
        body = self._body
        flow = body.body_velocity(self.wind)
        force, torque = wing_forces(flow, body.rates, (aileron, elevator, rudder))
        lift, turn = self._lift(values[_SURFACES:], dt)
        thrust = FULL_THRUST * self._throttle * max(1.0 - flow[0] / TOP_SPEED, 0.0)
        total = (
            force[0] + thrust - DRAG[0] * flow[0],
            force[1] - DRAG[1] * flow[1],
            force[2] - lift - DRAG[2] * flow[2],
        )
        p, q, r = body.rates
        moments = (
            torque[0] + turn[0] - DAMPING[0] * p,
            torque[1] + turn[1] - DAMPING[1] * q,
            torque[2] + turn[2] - DAMPING[2] * r,
        )
        if not (body.is_on_ground and -total[2] < MASS * 9.7 and body.rest(dt)):
            body.advance(total, moments, dt)
            if body.position[2] > 0.0:
                body.rest(dt)
        return body.state(airspeed=math.hypot(*flow))

    def _lift(self, commands: Sequence[float], dt: float) -> tuple[float, Vector]:
        """Return force and torque of the lifting motors."""
        share = min(dt / LIFT_LAG, 1.0)
        lift = roll = pitch = yaw = 0.0
        for index, (forward, right, turn) in enumerate(MOTORS):
            wanted = LIFT_THRUST * max(commands[index], 0.0)
            thrust = self._lifts[index] = self._lifts[index] + (wanted - self._lifts[index]) * share
            lift += thrust
            roll -= REACH * right * thrust
            pitch += REACH * forward * thrust
            yaw += LIFT_TORQUE * turn * thrust
        return lift, (roll, pitch, yaw)
