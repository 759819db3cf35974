"""Copters, and VTOLs in hover: thrust along the body's vertical axis, tilted for horizontal acceleration.

The velocity loop (proportional and integral, with the command's change fed forward) yields an acceleration
setpoint. Together with gravity it is the thrust vector, whose direction gives roll and pitch and whose length
the lift. Vertical control comes first: the horizontal part is limited to what the allowed tilt gives.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from mavstack.sim.motion.arrays import Array, clip, limit_length
from mavstack.sim.motion.attitude import yaw_rate_command
from mavstack.sim.motion.battery import GRAVITY, thrust_factor
from mavstack.sim.motion.demands import Mode

if TYPE_CHECKING:
    from mavstack.sim.motion.state import StateArray

#: Share of the full thrust that the velocity loop may use; the rest is kept for attitude control.
MAX_LIFT_SHARE = 0.95
#: Minimum upward acceleration in m/s2 that the velocity loop demands; it limits how fast the body falls.
MIN_UPWARD = 2.0
#: Maximum of the velocity loop's integral term, in m/s2.
MAX_INTEGRAL = 4.0


class AttitudeCommand(NamedTuple):
    """Roll, pitch (rad), yaw rate (rad/s) and thrust (lift in m/s2, or a share of the drive)."""

    roll: Array
    pitch: Array
    turn: Array
    thrust: Array


def acceleration_setpoint(state: StateArray, step: float) -> Array:
    """Run the velocity loop and return its acceleration (m/s2)."""
    error = state.velocity_command - state.velocity_estimate
    grounded = state.on_ground > 0.0
    state.integral += error * (state.integral_gain * step)
    np.minimum(
        np.maximum(state.integral, -MAX_INTEGRAL, out=state.integral), MAX_INTEGRAL, out=state.integral
    )
    np.copyto(state.integral, 0.0, where=grounded)
    error[:2] *= state.velocity_gain
    error[2] *= state.heave_gain
    error += state.integral
    error += state.acceleration_feedforward
    return error


def control(state: StateArray, step: float) -> AttitudeCommand:
    """Return the attitude and lift that the demand needs."""
    acceleration = acceleration_setpoint(state, step)
    upward = np.maximum(GRAVITY - acceleration[2], MIN_UPWARD)
    tilt = state.tilt * (1.0 - 0.8 * state.transition)
    acceleration[:2] = limit_length(acceleration[:2], np.minimum(upward, GRAVITY) * np.tan(tilt))
    yaw = state.attitude_estimate[2]
    cosine, sine = np.cos(yaw), np.sin(yaw)
    ahead = acceleration[0] * cosine + acceleration[1] * sine
    aside = acceleration[1] * cosine - acceleration[0] * sine
    slant = np.sqrt(upward * upward + ahead * ahead)
    roll, pitch = np.arctan2(aside, slant), -np.arctan2(ahead, upward)
    lift = np.minimum(np.sqrt(slant * slant + aside * aside), state.lift * MAX_LIFT_SHARE)
    return _apply_direct_demands(state, AttitudeCommand(roll, pitch, yaw_rate_command(state), lift))


def _apply_direct_demands(state: StateArray, command: AttitudeCommand) -> AttitudeCommand:
    """Replace the loops' outputs where the demand sets them directly."""
    direct = (state.mode < Mode.LINE) | (state.mode > Mode.CIRCLE)
    if not direct.any():
        return command
    spun = state.mode > Mode.CIRCLE
    share = np.where(state.mode == Mode.STICKS, state.tilt, 1.0) * spun
    thrust = state.stick[3] * state.lift * (spun & (state.mode < Mode.ROLL_OUT))
    return AttitudeCommand(
        np.where(direct, state.stick[0] * share, command.roll),
        np.where(direct, state.stick[1] * share, command.pitch),
        command.turn,
        np.where(direct, thrust, command.thrust),
    )


def apply_motor_failures(state: StateArray) -> None:
    """Reduce the authority, spin and lean by failed motors."""
    whole = state.lift_left
    state.authority[:] = 0.3 + 0.7 * whole
    state.rate_disturbance[:] = state.lean
    flying = (state.lift_thrust > 1.0) & (state.on_ground == 0.0)
    state.rate_disturbance *= flying
    state.rate_disturbance[2] += state.spin * flying


def apply_lift(state: StateArray, acceleration: Array) -> None:
    """Bring the lifting motors towards the demanded lift, and add their force."""
    maximum = state.lift * state.lift_left * thrust_factor(state)
    command = np.minimum(clip(acceleration, 0.0, state.lift) * thrust_factor(state), maximum)
    state.lift_thrust += (command - state.lift_thrust) * state.lift_response
    state.force -= state.below * state.lift_thrust
