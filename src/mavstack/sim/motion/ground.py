"""Moving, and not moving through the ground.

Velocities are integrated from forces (trapezoidal for the place), then bounded by what a body rests on and
what it cannot rise above: the ground at down = 0 for what flies; ground or water for rovers and boats, which
stay at 0; the surface and the bottom for a sub. Resting on legs or wheels there is friction, more with the
brakes on, no slipping sideways, and the attitude settles to what the undercarriage allows.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mavstack.sim.motion.arrays import Mask, clip, dot
from mavstack.sim.motion.battery import GRAVITY
from mavstack.sim.motion.demands import Mode

if TYPE_CHECKING:
    from mavstack.sim.motion.state import StateArray

#: How many times stronger the friction is with brakes, or with motors stopped.
BRAKE_FACTOR = 8.0
#: Share of a misfit of attitude that goes in a step on the ground.
LEVELING_SHARE = 0.2


def integrate(state: StateArray, step: float) -> None:
    """Integrate a step of the forces, and stop what touches."""
    before = state.velocity.copy()
    state.velocity += state.force * step
    state.velocity[2] += GRAVITY * step
    state.position += (before + state.velocity) * (0.5 * step)
    down, sinking = state.position[2], state.velocity[2]
    low, high = down >= state.floor, down <= state.ceiling
    sinking[:] = np.where(low, np.minimum(sinking, 0.0), np.where(high, np.maximum(sinking, 0.0), sinking))
    state.position[2] = clip(down, state.ceiling, state.floor)
    state.on_ground[:] = low | high
    resting = low & (state.friction > 0.0)
    if resting.any():
        _apply_friction(state, resting, step)
    np.divide(state.velocity - before, step, out=state.acceleration)


def _apply_friction(state: StateArray, resting: Mask, step: float) -> None:
    """Let friction and the undercarriage hold what rests."""
    braked = (state.mode == Mode.STOP) | (state.mode == Mode.ROLL_OUT)
    friction = state.friction * np.where(braked, BRAKE_FACTOR, 1.0) * step
    ahead, aside = dot(state.velocity, state.forward), dot(state.velocity, state.right)
    slowed = np.copysign(np.maximum(np.abs(ahead) - friction, 0.0), ahead)
    slipped = np.copysign(np.maximum(np.abs(aside) * 0.5 - friction, 0.0), aside)
    flat = state.forward * slowed + state.right * slipped
    np.copyto(state.velocity[:2], flat[:2], where=resting)
    roll, pitch = state.attitude[:2]
    misfit = np.zeros_like(state.attitude)
    misfit[0] = roll
    misfit[1] = pitch - clip(pitch, 0.0, state.rest_pitch)
    state.attitude -= misfit * (LEVELING_SHARE * resting)
    held = np.where(resting, 0.5, 1.0)
    state.rates[0] *= held
    state.rates[1] *= np.where(misfit[1] != 0.0, held, 1.0)
    rolling = np.minimum(0.3 * np.abs(ahead), 1.0)
    state.rates[2] *= np.where(resting, rolling, 1.0)
