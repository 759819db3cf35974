"""A fixed-wing trainer from its surfaces: lift, drag and moments by coefficients, a propeller, wheels.

Moments are linear in the angles of attack and sideslip, the turn rates and the surfaces. Lift falls off
beyond the stall. On its wheels the plane rolls forward, steers by its rudder and lifts its nose by its
elevator.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

from mavstack.simulators.rigid_body import RigidBody
from mavstack.simulators.rotation import from_euler, rotate_back, to_euler
from mavstack.simulators.state import GRAVITY

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.sim.vehicle_types import Home
    from mavstack.simulators.rotation import Vector
    from mavstack.simulators.state import State

MASS: Final = 1.8
INERTIA: Final = (0.08, 0.09, 0.16)
#: Wing area (m2), span and chord (m).
AREA, SPAN, CHORD = 0.4, 1.5, 0.27
#: Newtons of the propeller at rest, and the airspeed at which it pulls no more (m/s).
FULL_THRUST, TOP_SPEED = 15.0, 35.0
DENSITY: Final = 1.225
#: Lift: at zero, by radian; stall in radians, and what is left of the slope beyond it.
LIFT_ZERO, LIFT_SLOPE, STALL, STALLED_SLOPE = 0.25, 4.8, 0.26, 0.9
#: Drag: of the frame, by the square of the lift.
DRAG_ZERO, DRAG_INDUCED = 0.03, 0.05
SIDE_SLOPE: Final = -0.5
#: Pitching moment: at zero, by angle of attack, by rate, by elevator (positive: nose up).
PITCH_ZERO, PITCH_SLOPE, PITCH_DAMPING, PITCH_CONTROL = 0.009, -0.6, -12.0, 0.45
#: Rolling moment: by sideslip, rate, aileron (positive: right wing down).
ROLL_SLOPE, ROLL_DAMPING, ROLL_CONTROL = -0.05, -0.5, 0.15
#: Yawing moment: by sideslip, rate, rudder (positive: nose right).
YAW_SLOPE, YAW_DAMPING, YAW_CONTROL = 0.08, -0.12, 0.06
#: On wheels: rolling resistance and brakes in m/s2, turn rate at full rudder, greatest pitch in radians.
ROLLING, BRAKES, STEERING, GROUND_PITCH = 0.3, 3.0, 0.8, 0.21
#: Airspeed below which there is no air flow worth computing.
_MIN_SPEED: Final = 0.5
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
        force, torque = self._aerodynamics(flow, airspeed, (aileron, elevator, rudder))
        thrust = FULL_THRUST * self._throttle * max(1.0 - flow[0] / TOP_SPEED, 0.0)
        force = (force[0] + thrust, force[1], force[2])
        if body.is_on_ground and not self._lifts(force):
            self._roll(force, elevator, rudder, dt)
        else:
            body.advance(force, torque, dt)
            if body.position[2] > 0.0:
                self._touch_down(dt)
        return body.state(airspeed=airspeed)

    def _aerodynamics(
        self, flow: Vector, speed: float, surfaces: tuple[float, float, float]
    ) -> tuple[Vector, Vector]:
        """Return force and torque of the air in body axes."""
        if speed < _MIN_SPEED:
            return (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        u, v, w = flow
        alpha, beta = math.atan2(w, u), math.asin(max(-1.0, min(1.0, v / speed)))
        pressure = 0.5 * DENSITY * speed * speed * AREA
        lift = _lift(alpha)
        drag = DRAG_ZERO + DRAG_INDUCED * lift * lift + max(abs(alpha) - STALL, 0.0)
        ca, sa = math.cos(alpha), math.sin(alpha)
        force = (
            pressure * (lift * sa - drag * ca),
            pressure * SIDE_SLOPE * beta,
            pressure * (-lift * ca - drag * sa),
        )
        p, q, r = self._body.rates
        aileron, elevator, rudder = surfaces
        across, along = 0.5 * SPAN / speed, 0.5 * CHORD / speed
        bounded = max(-STALL, min(STALL, alpha))
        roll = ROLL_SLOPE * beta + ROLL_DAMPING * p * across + ROLL_CONTROL * aileron
        pitch = PITCH_ZERO + PITCH_SLOPE * bounded + PITCH_DAMPING * q * along + PITCH_CONTROL * elevator
        yaw = YAW_SLOPE * beta + YAW_DAMPING * r * across + YAW_CONTROL * rudder
        return force, (pressure * SPAN * roll, pressure * CHORD * pitch, pressure * SPAN * yaw)

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


def _lift(alpha: float) -> float:
    """Return the lift coefficient at an angle of attack in radians."""
    if alpha > STALL:
        return max(LIFT_ZERO + LIFT_SLOPE * STALL - STALLED_SLOPE * (alpha - STALL) * 3.0, 0.0)
    if alpha < -STALL:
        return min(LIFT_ZERO - LIFT_SLOPE * STALL - STALLED_SLOPE * (alpha + STALL) * 3.0, 0.0)
    return LIFT_ZERO + LIFT_SLOPE * alpha
