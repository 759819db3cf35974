"""Submarines: thrusters along every axis, drag of the water, slight buoyancy.

The velocity loop of the multirotor yields an acceleration; thrusters produce it in any direction, after a
lag, within their strength. No tilt is needed. At the surface no buoyancy is left.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mavstack.sim.motion.arrays import Array, clip, length, limit_length
from mavstack.sim.motion.attitude import yaw_rate_command
from mavstack.sim.motion.battery import GRAVITY, thrust_factor
from mavstack.sim.motion.demands import Mode
from mavstack.sim.motion.multirotor import AttitudeCommand, acceleration_setpoint

if TYPE_CHECKING:
    from mavstack.sim.motion.state import StateArray

#: Drag of the hull divided by the mass: coefficients of the speed (1/s) and of its square (1/m).
DRAG, DRAG_SQUARED = 0.15, 0.42
#: Upward acceleration by buoyancy, in m/s2.
BUOYANCY = 0.06
#: Maximum roll and pitch of attitude demands, in radians.
MAX_LEAN = 0.8


def control(state: StateArray, step: float) -> tuple[AttitudeCommand, Array]:
    """Return the attitude command, and the acceleration that the thrusters should produce."""
    acceleration = acceleration_setpoint(state, step)
    acceleration[:2] = limit_length(acceleration[:2], state.lift)
    acceleration[2] += BUOYANCY
    mode, stick = state.mode, state.stick
    guided = (mode >= Mode.LINE) & (mode <= Mode.CIRCLE)
    leaned = mode == Mode.ATTITUDE
    roll = np.where(leaned, clip(stick[0], -MAX_LEAN, MAX_LEAN), 0.0)
    pitch = np.where(leaned, clip(stick[1], -MAX_LEAN, MAX_LEAN), 0.0)
    if not guided.all():
        acceleration = np.where(guided, acceleration, _apply_direct_demands(state))
    return AttitudeCommand(roll, pitch, yaw_rate_command(state), acceleration[2]), acceleration


def _apply_direct_demands(state: StateArray) -> Array:
    """Return the acceleration of stick positions or of a vertical thrust (0.5 is none)."""
    mode, stick = state.mode, state.stick
    sticks = mode == Mode.STICKS
    held = (mode == Mode.ATTITUDE) | (mode == Mode.RATES)
    ahead, aside = stick[1] * sticks, stick[0] * sticks
    up = np.where(sticks, stick[3], (2.0 * stick[3] - 1.0) * held)
    pull: Array = (state.forward * ahead + state.right * aside - state.below * up) * state.lift
    return pull


def apply_forces(state: StateArray, acceleration: Array) -> None:
    """Add the forces of thrusters, water and buoyancy."""
    maximum = state.lift
    command = np.minimum(np.maximum(acceleration, -maximum), maximum) * (
        thrust_factor(state) * state.lift_left
    )
    state.thrust += (command - state.thrust) * state.lift_response
    state.lift_thrust[:] = length(state.thrust)
    drag = DRAG + DRAG_SQUARED * length(state.velocity)
    state.force += state.thrust - state.velocity * drag
    sunk = np.minimum(np.maximum(state.position[2] * 5.0, 0.0), 1.0)
    state.force[2] -= GRAVITY + BUOYANCY * sunk
