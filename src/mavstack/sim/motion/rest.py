"""Bodies at rest: standing on the ground in calm air with their motors stopped.

Nothing moves them until a demand, a wind or a new position does, so the world need not compute their motion;
noise, battery and estimate go on. Booting vehicles spend most of their time like this.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from mavstack.sim.motion.state import StateArray

#: Thresholds below which a body is still: m/s, radians, rad/s, and thrust (m/s2, or a share of full thrust).
STILL_SPEED, STILL_ANGLE, STILL_RATE, STILL_THRUST = 1e-3, 0.005, 0.05, 1e-3


def has_demand(state: StateArray) -> bool:
    """Return whether any body has a demand other than to stop, whose mode is 0."""
    return bool(state.mode.any() or state.forward_requested.any())


def come_to_rest(state: StateArray) -> bool:
    """Stop what is left of the motion if all bodies stand still, and return whether they do."""
    if has_demand(state) or state.transition.any() or not state.on_ground.all():
        return False
    roll, pitch = state.attitude[:2]
    level = (np.abs(roll) < STILL_ANGLE) & (pitch > -STILL_ANGLE) & (pitch < state.rest_pitch + STILL_ANGLE)
    moving, turning = np.abs(state.velocity).max(axis=0), np.abs(state.rates).max(axis=0)
    pushing = np.maximum(state.lift_thrust, np.abs(state.drive_thrust))
    still = (moving < STILL_SPEED) & (turning < STILL_RATE) & (pushing < STILL_THRUST)
    if not (level & still).all():
        return False
    for rows in (state.velocity, state.rates, state.lift_thrust, state.drive_thrust, state.thrust):
        rows.fill(0.0)
    state.acceleration.fill(0.0)
    return True
