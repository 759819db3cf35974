"""A fixed-wing trainer from its surfaces: lift, drag and moments by coefficients, a propeller, wheels.

On its wheels the plane rolls forward, steers by its rudder and lifts its nose by its elevator.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

from mavstack.rotation import from_euler, rotate_back, to_euler
from mavstack.simulators.bodies.wing import wing_forces
from mavstack.simulators.rigid_body import RigidBody
from mavstack.simulators.state import GRAVITY

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.rotation import Vector
    from mavstack.sim.vehicle_types import Home
    from mavstack.simulators.state import State

MASS: Final = 1.8
INERTIA: Final = (0.08, 0.09, 0.16)
#: Static thrust of the propeller in newtons, and the airspeed in m/s at which its thrust is zero.
FULL_THRUST, TOP_SPEED = 15.0, 35.0
#: On wheels: rolling resistance and brakes in m/s2, turn rate at full rudder, maximum pitch in radians.
ROLLING, BRAKES, STEERING, GROUND_PITCH = 0.3, 3.0, 0.8, 0.21
_LAG: Final = 0.15


class Plane:
    """A trainer of 1.8 kg that flies at 10 to 25 m/s.

    Args:
        wind: Metres per second north, east, down.
    """

    def __init__(self, wind: Vector = (0.0, 0.0, 0.0)) -> None:
        self.wind = wind
        self._body = RigidBody(MASS, INERTIA)
        self._throttle = 0.0

    def reset(self, home: Home, heading: float) -> State:
        """Put it on its wheels at home; see `Physics`."""
        self._body.place(heading)
        self._throttle = 0.0
        return self._body.state(airspeed=0.0)

    def step(self, actuators: Sequence[float], dt: float) -> State:
        """Move it by aileron, elevator, throttle and rudder; see `Physics`."""
        aileron, elevator, throttle, rudder = (
            min(max(value, low), 1.0) for value, low in zip(actuators, (-1.0, -1.0, 0.0, -1.0), strict=False)
        )
        self._throttle += (throttle - self._throttle) * min(dt / _LAG, 1.0)
        body = self._body
        flow = body.body_velocity(self.wind)
        airspeed = math.hypot(*flow)
        force, torque = wing_forces(flow, body.rates, (aileron, elevator, rudder))
        thrust = FULL_THRUST * self._throttle * max(1.0 - flow[0] / TOP_SPEED, 0.0)
        force = (force[0] + thrust, force[1], force[2])
        if body.is_on_ground and not self._lifts(force):
            self._roll(force, elevator, rudder, dt)
        else:
            body.advance(force, torque, dt)
            if body.position[2] > 0.0:
                self._touch_down(dt)
        return body.state(airspeed=airspeed)

    def _lifts(self, force: Vector) -> bool:
        """Return whether a force in body axes is more than the weight."""
        pitch = to_euler(self._body.attitude)[1]
        return -force[2] * math.cos(pitch) + force[0] * math.sin(pitch) > MASS * GRAVITY

    def _roll(self, force: Vector, elevator: float, rudder: float, dt: float) -> None:
        """Roll on the wheels."""
        body = self._body
        _, pitch, yaw = to_euler(body.attitude)
        north, east, _ = body.velocity
        speed = north * math.cos(yaw) + east * math.sin(yaw)
        hold = ROLLING if self._throttle > 0.05 else BRAKES
        push = force[0] / MASS
        after = max(speed + (push - math.copysign(hold, speed)) * dt, 0.0) if speed or push > hold else 0.0
        turn = STEERING * rudder * min(after / 3.0, 1.0)
        lifting = max(min(after / 12.0, 1.5), 0.0) * elevator
        raised = max(0.0, min(GROUND_PITCH, pitch + (0.6 * lifting - (0.3 if lifting <= 0.1 else 0.0)) * dt))
        yaw += turn * dt
        body.attitude = from_euler(0.0, raised, yaw)
        body.rates = (0.0, (raised - pitch) / dt, turn)
        velocity = (after * math.cos(yaw), after * math.sin(yaw), 0.0)
        change = tuple((new - old) / dt for new, old in zip(velocity, body.velocity, strict=True))
        body.velocity = velocity
        body.position = (body.position[0] + velocity[0] * dt, body.position[1] + velocity[1] * dt, 0.0)
        body.specific_force = rotate_back(body.attitude, (change[0], change[1], change[2] - GRAVITY))

    def _touch_down(self, dt: float) -> None:
        """Put it on its wheels."""
        body = self._body
        _, pitch, yaw = to_euler(body.attitude)
        body.attitude = from_euler(0.0, max(0.0, min(GROUND_PITCH, pitch)), yaw)
        stop = -body.velocity[2] / dt
        body.position = (body.position[0], body.position[1], 0.0)
        body.velocity = (body.velocity[0], body.velocity[1], 0.0)
        body.rates = (0.0, 0.0, 0.0)
        body.specific_force = rotate_back(body.attitude, (0.0, 0.0, max(stop, -8 * GRAVITY) - GRAVITY))
