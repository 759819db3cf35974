"""How bodies turn: from a wanted attitude to rates, and from rates to the attitude.

An error of an angle asks for a rate in proportion, within the airframe's limit. Rates of the Euler angles
become body rates by the kinematics

    p = roll' - yaw' sin(pitch)
    q = pitch' cos(roll) + yaw' sin(roll) cos(pitch)
    r = -pitch' sin(roll) + yaw' cos(roll) cos(pitch)

which the body follows with a first-order lag and a limited angular acceleration, as far as its surfaces or
motors have authority; `push` is what air or a dead motor adds. The same kinematics turned round move the
Euler angles. Past the vertical the angles of the same attitude on the other side are taken, so that loops
and flips are flown through; very near it, where yaw and roll are the same thing, their rates are bounded.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mavstack.sim.motion.arrays import Array, bounded, wrapped
from mavstack.sim.motion.demands import Mode, YawMode

if TYPE_CHECKING:
    from mavstack.sim.motion.fleet import Fleet

LEAST_COSINE = 0.05
#: Nothing turns faster than this, in rad/s, whatever is broken.
FASTEST = 12.0


def wanted_turn(fleet: Fleet) -> Array:
    """Give the yaw rate that a demand's heading or rate asks for."""
    heading = fleet.yaw_demand
    centre = fleet.yaw_mode == YawMode.CENTRE
    if centre.any():
        north, east = fleet.target[:2] - fleet.position_estimate[:2]
        heading = np.where(centre, np.arctan2(east, north), heading)
    limit = fleet.turn_rate
    turn = 0.4 * fleet.attitude_gain * wrapped(heading - fleet.attitude_estimate[2])
    turn = np.where(fleet.yaw_mode == YawMode.RATE, fleet.yaw_demand, turn)
    return bounded(np.where(fleet.mode == Mode.STICKS, fleet.stick[2] * limit, turn), -limit, limit)


def pull(fleet: Fleet, step: float) -> None:
    """Let loops and air change the body rates."""
    gain, limit = fleet.attitude_gain, fleet.rate_limit
    roll_rate = bounded(gain * (fleet.roll_wanted - fleet.attitude_estimate[0]), -limit[0], limit[0])
    pitch_rate = bounded(gain * (fleet.pitch_wanted - fleet.attitude_estimate[1]), -limit[1], limit[1])
    sin_roll, sin_pitch = fleet.sines[:2]
    cos_roll, cos_pitch = fleet.cosines[:2]
    turning = fleet.turn_wanted * cos_pitch
    command = np.empty_like(fleet.rates)
    command[0] = roll_rate - fleet.turn_wanted * sin_pitch
    command[1] = pitch_rate * cos_roll + turning * sin_roll
    command[2] = turning * cos_roll - pitch_rate * sin_roll
    direct = fleet.mode == Mode.RATES
    if direct.any():
        np.copyto(command, bounded(fleet.stick[:3], -limit, limit), where=direct)
    command *= fleet.authority
    command += fleet.push
    most = fleet.angular_acceleration * step
    fleet.rates += bounded((command - fleet.rates) * fleet.rate_response, -most, most)
    np.minimum(np.maximum(fleet.rates, -FASTEST, out=fleet.rates), FASTEST, out=fleet.rates)


def turn(fleet: Fleet, step: float) -> None:
    """Move the Euler angles by a step of the body rates."""
    attitude = fleet.attitude
    sin_roll, cos_roll = fleet.sines[0], fleet.cosines[0]
    cos_pitch = np.maximum(fleet.cosines[1], LEAST_COSINE)
    p, q, r = fleet.rates
    yaw_rate = (q * sin_roll + r * cos_roll) / cos_pitch
    attitude[0] += (p + yaw_rate * fleet.sines[1]) * step
    attitude[1] += (q * cos_roll - r * sin_roll) * step
    attitude[2] += yaw_rate * step
    over = np.abs(attitude[1]) > 0.5 * np.pi
    if over.any():
        attitude[0] += np.where(over, np.pi, 0.0)
        attitude[2] += np.where(over, np.pi, 0.0)
        attitude[1] = np.where(over, np.copysign(np.pi, attitude[1]) - attitude[1], attitude[1])
    attitude[0] = wrapped(attitude[0])
    attitude[2] = wrapped(attitude[2])


def orient(fleet: Fleet) -> None:
    """Work out sines, cosines and the body's axes (forward, right, below) from the attitude."""
    np.sin(fleet.attitude, out=fleet.sines)
    np.cos(fleet.attitude, out=fleet.cosines)
    sin_roll, sin_pitch, sin_yaw = fleet.sines
    cos_roll, cos_pitch, cos_yaw = fleet.cosines
    forward, right, below = fleet.forward, fleet.right, fleet.below
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
