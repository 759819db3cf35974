"""Aerodynamics of a wing: lift, drag and side force by the angle of attack, and moments of the airflow.

With u, v, w the airspeed along the body axes, the angle of attack is atan2(w, u). Up to the stall the lift
coefficient is linear in the angle of attack; beyond the stall it changes over to that of a flat plate, sin(2
alpha), and the drag gains 1.2 sin(alpha)^2. A sideslip is pushed back sideways and turns the body into the
wind. The authority of control surfaces is proportional to the dynamic pressure: below the stall speed the
nose falls into the airflow, regardless of the command.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mavstack.sim.motion.arrays import Array, clip
from mavstack.sim.motion.battery import GRAVITY, thrust_factor

if TYPE_CHECKING:
    from mavstack.sim.motion.state import StateArray

LIFT_AT_ZERO = 0.2
LIFT_SLOPE = 4.6
STALL_ANGLE = 0.24
#: The lift coefficient at the stall, and the increase of the angle of attack, in radians, until the wing is
#: fully stalled.
MAX_LIFT = LIFT_AT_ZERO + LIFT_SLOPE * STALL_ANGLE
STALL_WIDTH = 0.12
DRAG_AT_ZERO = 0.04
INDUCED_DRAG = 0.066
PLATE_LIFT, PLATE_DRAG = 1.0, 1.3
SIDE_SLOPE = 0.6
#: Rates in 1/s at which the airflow turns the nose, sideways and down in a stall, at full dynamic pressure.
WEATHERCOCK = 2.0
NOSE_DROP = 2.5


def apply_wing(state: StateArray) -> None:
    """Add the wing's forces, and set the control authority and the turning moments of the air."""
    relative = state.velocity - state.air
    u, v, w = (_component(relative, axis) for axis in (state.forward, state.right, state.below))
    speed = np.maximum(state.airspeed, 0.1)
    plane_speed = np.maximum(np.sqrt(u * u + w * w), 0.05)
    sine, cosine = w / plane_speed, u / plane_speed
    attack = np.arctan2(w, u)
    stalled = clip((np.abs(attack + 0.05) - STALL_ANGLE) * (1 / STALL_WIDTH), 0.0, 1.0)
    lift_coefficient = (LIFT_AT_ZERO + LIFT_SLOPE * attack) * (1.0 - stalled)
    lift_coefficient += (2.0 * PLATE_LIFT) * sine * cosine * stalled
    drag_coefficient = (
        DRAG_AT_ZERO + INDUCED_DRAG * lift_coefficient * lift_coefficient + PLATE_DRAG * stalled * sine * sine
    )
    pressure = state.wing * plane_speed * plane_speed
    lift, drag = pressure * lift_coefficient, pressure * drag_coefficient
    side = -state.wing * speed * SIDE_SLOPE * v
    along = lift * sine - drag * cosine
    down = -lift * cosine - drag * sine
    wing = state.forward * along + state.right * side + state.below * down
    state.wing_up[:] = -wing[2]
    state.force += wing
    _apply_air_moments(state, attack, stalled, v / speed)


def _component(vector: Array, axis: Array) -> Array:
    """Return the component of a vector along an axis."""
    return np.asarray(vector[0] * axis[0] + vector[1] * axis[1] + vector[2] * axis[2])


def _apply_air_moments(state: StateArray, attack: Array, stalled: Array, slip: Array) -> None:
    """Set the authority of the control surfaces and the turning moments of the airflow."""
    stall_pressure = GRAVITY / (state.wing * MAX_LIFT)
    flow = np.minimum(state.airspeed * state.airspeed / stall_pressure, 1.0)
    authority = flow * (1.0 - 0.8 * stalled)
    state.authority[:] = authority
    trim = (GRAVITY / np.maximum(state.wing * 324.0, 1e-3) - LIFT_AT_ZERO) * (1 / LIFT_SLOPE)
    state.rate_disturbance[0] = 0.0
    state.rate_disturbance[1] = (1.0 - authority) * NOSE_DROP * (trim - attack) * flow
    # no turn on the ground, where the wheels keep the heading
    state.rate_disturbance[2] = WEATHERCOCK * slip * flow * (state.on_ground == 0.0)


def apply_drive(state: StateArray, throttle: Array) -> None:
    """Bring the driving motor towards the demanded share of thrust, and add its force."""
    command = clip(throttle, 0.0, 1.0) * thrust_factor(state) * state.drive_left
    state.drive_thrust += (command - state.drive_thrust) * state.drive_response
    fade = clip(1.0 - state.airspeed / state.drive_speed, 0.0, 1.0)
    state.force += state.forward * (state.drive * fade * state.drive_thrust)
