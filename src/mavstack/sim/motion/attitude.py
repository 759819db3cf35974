"""Attitude dynamics: from an attitude setpoint to body rates, and from body rates to the attitude.

An angle error demands a rate in proportion, within the airframe's limit. Rates of the Euler angles become
body rates by the kinematics

    p = roll' - yaw' sin(pitch)
    q = pitch' cos(roll) + yaw' sin(roll) cos(pitch)
    r = -pitch' sin(roll) + yaw' cos(roll) cos(pitch)

which the body follows with a first-order lag and a limited angular acceleration, as far as its surfaces or
motors have authority; `rate_disturbance` is added by the airflow or by a failed motor. The inverse kinematics
integrate the Euler angles. Past the vertical the equivalent angles on the other side are used, so that loops
and flips work; very near the vertical, where yaw and roll coincide, their rates are bounded.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mavstack.sim.motion.arrays import Array, clip, wrap_angle
from mavstack.sim.motion.demands import Mode, YawMode

if TYPE_CHECKING:
    from mavstack.sim.motion.state import StateArray

MIN_COSINE = 0.05
#: Gain of the heading loop, as a share of the gain of the roll and pitch loops.
YAW_SHARE = 0.4
#: Maximum body rate in rad/s, even with failed motors.
MAX_RATE = 12.0


def yaw_rate_command(state: StateArray) -> Array:
    """Return the yaw rate (rad/s) that the demanded heading or rate needs."""
    heading = state.yaw_demand
    centre = state.yaw_mode == YawMode.CENTRE
    if centre.any():
        north, east = state.target[:2] - state.position_estimate[:2]
        heading = np.where(centre, np.arctan2(east, north), heading)
    limit = state.turn_rate
    turn = YAW_SHARE * state.attitude_gain * wrap_angle(heading - state.attitude_estimate[2])
    turn = np.where(state.yaw_mode == YawMode.RATE, state.yaw_demand, turn)
    return clip(np.where(state.mode == Mode.STICKS, state.stick[2] * limit, turn), -limit, limit)


def update_rates(state: StateArray, step: float) -> None:
    """Change the body rates by control loops and airflow for one step."""
    gain, limit = state.attitude_gain, state.rate_limit
    roll_rate = clip(gain * (state.roll_setpoint - state.attitude_estimate[0]), -limit[0], limit[0])
    pitch_rate = clip(gain * (state.pitch_setpoint - state.attitude_estimate[1]), -limit[1], limit[1])
    sin_roll, sin_pitch = state.sines[:2]
    cos_roll, cos_pitch = state.cosines[:2]
    turning = state.yaw_rate_setpoint * cos_pitch
    command = state.rate_setpoint
    command[0] = roll_rate - state.yaw_rate_setpoint * sin_pitch
    command[1] = pitch_rate * cos_roll + turning * sin_roll
    command[2] = turning * cos_roll - pitch_rate * sin_roll
    direct = state.mode == Mode.RATES
    if direct.any():
        np.copyto(command, clip(state.stick[:3], -limit, limit), where=direct)
    reached = command * state.authority + state.rate_disturbance
    maximum = state.angular_acceleration * step
    state.rates += clip((reached - state.rates) * state.rate_response, -maximum, maximum)
    np.minimum(np.maximum(state.rates, -MAX_RATE, out=state.rates), MAX_RATE, out=state.rates)


def integrate_rates(state: StateArray, step: float) -> None:
    """Integrate the body rates into the Euler angles for one step."""
    attitude = state.attitude
    sin_roll, cos_roll = state.sines[0], state.cosines[0]
    cos_pitch = np.maximum(state.cosines[1], MIN_COSINE)
    p, q, r = state.rates
    yaw_rate = (q * sin_roll + r * cos_roll) / cos_pitch
    attitude[0] += (p + yaw_rate * state.sines[1]) * step
    attitude[1] += (q * cos_roll - r * sin_roll) * step
    attitude[2] += yaw_rate * step
    over = np.abs(attitude[1]) > 0.5 * np.pi
    if over.any():
        attitude[0] += np.where(over, np.pi, 0.0)
        attitude[2] += np.where(over, np.pi, 0.0)
        attitude[1] = np.where(over, np.copysign(np.pi, attitude[1]) - attitude[1], attitude[1])
    attitude[0] = wrap_angle(attitude[0])
    attitude[2] = wrap_angle(attitude[2])


def update_axes(state: StateArray) -> None:
    """Compute sines, cosines and the body axes (forward, right, below) from the attitude."""
    np.sin(state.attitude, out=state.sines)
    np.cos(state.attitude, out=state.cosines)
    sin_roll, sin_pitch, sin_yaw = state.sines
    cos_roll, cos_pitch, cos_yaw = state.cosines
    forward, right, below = state.forward, state.right, state.below
    np.multiply(cos_pitch, cos_yaw, out=forward[0])
    np.multiply(cos_pitch, sin_yaw, out=forward[1])
    np.negative(sin_pitch, out=forward[2])
    lean, dip = sin_roll * sin_pitch, cos_roll * sin_pitch
    np.subtract(lean * cos_yaw, cos_roll * sin_yaw, out=right[0])
    np.add(lean * sin_yaw, cos_roll * cos_yaw, out=right[1])
    np.multiply(sin_roll, cos_pitch, out=right[2])
    np.add(dip * cos_yaw, sin_roll * sin_yaw, out=below[0])
    np.subtract(dip * sin_yaw, sin_roll * cos_yaw, out=below[1])
    np.multiply(cos_roll, cos_pitch, out=below[2])
