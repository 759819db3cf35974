"""Rovers and boats: turned towards the velocity setpoint, and driven along their heading.

Both can turn on the spot, so that every point can be reached: the larger the heading error, the slower they
drive. A motor pulls drive x (throttle - speed / drive_speed), like an electric one. Wheels hardly slip
sideways; a hull does and is pushed by the wind, so that a boat returns to its position repeatedly.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mavstack.sim.motion.arrays import Array, clip, dot, wrap_angle
from mavstack.sim.motion.battery import GRAVITY, thrust_factor
from mavstack.sim.motion.demands import Mode, YawMode

if TYPE_CHECKING:
    from mavstack.sim.motion.state import StateArray

#: Two speeds in m/s; divided by the position gain (1/s) they give distances in metres. A vehicle closer than
#: the first distance to the end of its line has arrived; a vehicle that drifts farther than the second
#: distance returns.
ARRIVAL_SPEED, RETURN_SPEED = 0.28, 0.8
STANDSTILL = 0.02
SPEED_GAIN = 1.5
#: Throttle above which a motor counts as saturated.
SATURATED = 0.95
#: Sideways drag in 1/s of wheels and of a hull.
WHEEL_DRAG, HULL_DRAG = 12.0, 1.0


def control(state: StateArray, step: float) -> tuple[Array, Array]:
    """Return the demanded yaw rate (rad/s) and throttle (-1 to 1)."""
    setpoint, yaw = state.velocity_setpoint, state.attitude_estimate[2]
    size = np.sqrt(setpoint[0] * setpoint[0] + setpoint[1] * setpoint[1])
    off = state.target[:2] - state.position_estimate[:2]
    near = np.where(state.speed_command > STANDSTILL, ARRIVAL_SPEED, RETURN_SPEED) / state.position_gain
    arrived = (state.mode == Mode.LINE) & (off[0] * off[0] + off[1] * off[1] < near * near)
    size = np.where(arrived | (size < STANDSTILL), 0.0, size)
    moving = (size > 0.0) & (state.mode >= Mode.LINE) & (state.mode <= Mode.CIRCLE)
    heading = np.where(moving, np.arctan2(setpoint[1], setpoint[0]), state.yaw_demand)
    demanded = state.yaw_mode == YawMode.RATE
    ahead = (wrap_angle(heading - yaw)) * (moving | (state.yaw_mode == YawMode.HOLD))
    turn = np.where(demanded, state.yaw_demand, state.attitude_gain * ahead)
    speed = size * np.maximum(np.where(demanded, 1.0, np.cos(ahead)), 0.0) ** 2
    speed = np.where(np.abs(ahead) > 1.0, np.where(demanded, speed, 0.0), speed)
    throttle = _throttle(state, speed, step)
    return _apply_direct_demands(state, turn, throttle)


def _throttle(state: StateArray, speed: Array, step: float) -> Array:
    """Hold a speed along the heading, within the allowed acceleration."""
    maximum = state.acceleration_limit * step
    now = dot(state.velocity_estimate, state.forward)
    guided = (state.mode >= Mode.LINE) & (state.mode <= Mode.CIRCLE)
    command = state.speed_command
    change = clip(speed - command, -2.0 * maximum, maximum)
    command += change
    np.copyto(command, now, where=~guided)
    error = command - now
    moving = guided & (command > STANDSTILL)
    # do not integrate while the motor is saturated or accelerates: the error then does not show drag and
    # slope
    correction = (
        error * (0.4 * step) * ((np.abs(change) < maximum) & (np.abs(state.drive_thrust) < SATURATED))
    )
    state.speed_integral[:] = clip(state.speed_integral + correction, -0.5, 0.5) * moving
    ahead = (SPEED_GAIN * error + clip(change, -maximum, maximum) / step * guided) / state.drive
    return command / state.drive_speed + ahead + state.speed_integral


def _apply_direct_demands(state: StateArray, turn: Array, throttle: Array) -> tuple[Array, Array]:
    """Replace the loops' outputs where the demand sets them directly."""
    mode, stick, limit = state.mode, state.stick, state.turn_rate
    sticks, rates = (mode == Mode.STICKS), (mode == Mode.RATES)
    off = (mode < Mode.LINE) | (mode == Mode.ROLL_OUT)
    turn = np.where(sticks, (stick[0] + stick[2]) * limit, np.where(rates, stick[2], turn))
    throttle = np.where(mode > Mode.CIRCLE, stick[3], throttle)
    still = np.where(off, 0.0, 1.0)
    return clip(turn * still, -limit, limit), clip(throttle * still, -1.0, 1.0)


def apply_forces(state: StateArray, turn: Array, throttle: Array, grip: float, step: float) -> None:
    """Turn the body, and add the forces of motor, ground or water."""
    state.rate_setpoint[2] = turn
    state.rates[2] += clip(
        (turn * state.drive_left - state.rates[2]) * state.rate_response,
        -state.angular_acceleration * step,
        state.angular_acceleration * step,
    )
    command = throttle * thrust_factor(state) * state.drive_left
    state.drive_thrust += (command - state.drive_thrust) * state.drive_response
    ahead, aside = dot(state.velocity, state.forward), dot(state.velocity, state.right)
    state.force += state.forward * (state.drive * (state.drive_thrust - ahead / state.drive_speed))
    state.force -= state.right * (grip * aside)
    state.force[2] = -GRAVITY
