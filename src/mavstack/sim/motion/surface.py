"""Rovers and boats: turned to where the velocity wanted points, and driven along their heading.

Both can turn on the spot, so that every point is reached: the more the heading is off, the slower they go.
A motor pulls drive x (throttle - speed / drive_speed), as an electric one does. Wheels hardly slip
sideways; a hull does, and the wind pushes it, so that a boat goes back to its place again and again.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mavstack.sim.motion.arrays import Array, clip, dot, wrap_angle
from mavstack.sim.motion.battery import GRAVITY, thrust_factor
from mavstack.sim.motion.demands import Mode, YawMode

if TYPE_CHECKING:
    from mavstack.sim.motion.state import StateArray

#: How near the end of a line is there, and how far it may drift before it goes back, in seconds of its
#: position gain: a hull is given more.
ARRIVAL_TIME, RETURN_TIME = 0.28, 0.8
STANDSTILL = 0.02
SPEED_GAIN = 1.5
#: Of the throttle.
SATURATED = 0.95
#: Sideways drag in 1/s: wheels and hull.
WHEEL_DRAG, HULL_DRAG = 12.0, 1.0


def control(state: StateArray, step: float) -> tuple[Array, Array]:
    """Give the yaw rate and the throttle (-1..1) wanted."""
    wanted, yaw = state.velocity_setpoint, state.attitude_estimate[2]
    size = np.sqrt(wanted[0] * wanted[0] + wanted[1] * wanted[1])
    off = state.target[:2] - state.position_estimate[:2]
    near = np.where(state.speed_command > STANDSTILL, ARRIVAL_TIME, RETURN_TIME) / state.position_gain
    there = (state.mode == Mode.LINE) & (off[0] * off[0] + off[1] * off[1] < near * near)
    size = np.where(there | (size < STANDSTILL), 0.0, size)
    moving = (size > 0.0) & (state.mode >= Mode.LINE) & (state.mode <= Mode.CIRCLE)
    heading = np.where(moving, np.arctan2(wanted[1], wanted[0]), state.yaw_demand)
    told = state.yaw_mode == YawMode.RATE
    ahead = (wrap_angle(heading - yaw)) * (moving | (state.yaw_mode == YawMode.HOLD))
    turn = np.where(told, state.yaw_demand, state.attitude_gain * ahead)
    speed = size * np.maximum(np.where(told, 1.0, np.cos(ahead)), 0.0) ** 2
    speed = np.where(np.abs(ahead) > 1.0, np.where(told, speed, 0.0), speed)
    throttle = _throttle(state, speed, step)
    return _apply_direct_demands(state, turn, throttle)


def _throttle(state: StateArray, speed: Array, step: float) -> Array:
    """Hold a speed along the heading, approached no faster than allowed."""
    most = state.acceleration_limit * step
    now = dot(state.velocity_estimate, state.forward)
    guided = (state.mode >= Mode.LINE) & (state.mode <= Mode.CIRCLE)
    command = state.speed_command
    change = clip(speed - command, -2.0 * most, most)
    command += change
    np.copyto(command, now, where=~guided)
    error = command - now
    moving = guided & (command > STANDSTILL)
    # a motor that gives all it has, or is still speeding up, tells nothing about drag and slope
    learnt = error * (0.4 * step) * ((np.abs(change) < most) & (np.abs(state.drive_thrust) < SATURATED))
    state.speed_integral[:] = clip(state.speed_integral + learnt, -0.5, 0.5) * moving
    ahead = (SPEED_GAIN * error + clip(change, -most, most) / step * guided) / state.drive
    return command / state.drive_speed + ahead + state.speed_integral


def _apply_direct_demands(state: StateArray, turn: Array, throttle: Array) -> tuple[Array, Array]:
    """Replace what the loops want where the demand says it directly."""
    mode, stick, limit = state.mode, state.stick, state.turn_rate
    sticks, rates = (mode == Mode.STICKS), (mode == Mode.RATES)
    off = (mode < Mode.LINE) | (mode == Mode.ROLL_OUT)
    turn = np.where(sticks, (stick[0] + stick[2]) * limit, np.where(rates, stick[2], turn))
    throttle = np.where(mode > Mode.CIRCLE, stick[3], throttle)
    still = np.where(off, 0.0, 1.0)
    return clip(turn * still, -limit, limit), clip(throttle * still, -1.0, 1.0)


def apply_forces(state: StateArray, turn: Array, throttle: Array, grip: float, step: float) -> None:
    """Turn, and add the forces of motor, ground or water."""
    state.rates[2] += clip(
        (turn * state.drive_left - state.rates[2]) * state.rate_response,
        -state.angular_acceleration * step,
        state.angular_acceleration * step,
    )
    aim = throttle * thrust_factor(state) * state.drive_left
    state.drive_thrust += (aim - state.drive_thrust) * state.drive_response
    ahead, aside = dot(state.velocity, state.forward), dot(state.velocity, state.right)
    state.force += state.forward * (state.drive * (state.drive_thrust - ahead / state.drive_speed))
    state.force -= state.right * (grip * aside)
    state.force[2] = -GRAVITY
