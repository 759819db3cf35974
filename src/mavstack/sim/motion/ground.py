"""Integration of forces, and contact with the ground.

Velocities are integrated from forces (positions by the trapezoidal rule), then bounded by the surface below
and above the body: the ground at down = 0 for aircraft; ground or water for rovers and boats, which stay at
0; the surface and the bottom for a sub. A body resting on legs or wheels has friction, more with the brakes
on, does not slip sideways, and its attitude settles to that of the undercarriage.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mavstack.sim.motion.arrays import Mask, clip, dot
from mavstack.sim.motion.battery import GRAVITY
from mavstack.sim.motion.demands import Mode

if TYPE_CHECKING:
    from mavstack.sim.motion.state import StateArray

#: The friction is multiplied by this factor while the brakes are on or the motors are stopped.
BRAKE_FACTOR = 8.0
#: Share of the roll and pitch error that the undercarriage removes in one step on the ground.
LEVELING_SHARE = 0.2


def integrate(state: StateArray, step: float) -> None:
    """Integrate the forces for one step, and stop bodies at the ground."""
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
    """Apply friction and the undercarriage to resting bodies."""
    braked = (state.mode == Mode.STOP) | (state.mode == Mode.ROLL_OUT)
    friction = state.friction * np.where(braked, BRAKE_FACTOR, 1.0) * step
    ahead, aside = dot(state.velocity, state.forward), dot(state.velocity, state.right)
    slowed = np.copysign(np.maximum(np.abs(ahead) - friction, 0.0), ahead)
    slipped = np.copysign(np.maximum(np.abs(aside) * 0.5 - friction, 0.0), aside)
    flat = state.forward * slowed + state.right * slipped
    np.copyto(state.velocity[:2], flat[:2], where=resting)
    roll, pitch = state.attitude[:2]
    attitude_error = np.zeros_like(state.attitude)
    attitude_error[0] = roll
    attitude_error[1] = pitch - clip(pitch, 0.0, state.rest_pitch)
    state.attitude -= attitude_error * (LEVELING_SHARE * resting)
    held = np.where(resting, 0.5, 1.0)
    state.rates[0] *= held
    state.rates[1] *= np.where(attitude_error[1] != 0.0, held, 1.0)
    rolling = np.minimum(0.3 * np.abs(ahead), 1.0)
    state.rates[2] *= np.where(resting, rolling, 1.0)
