"""Moving, and not moving through the ground.

Velocities are integrated from forces (trapezoidal for the place), then bounded by what a body rests on and
what it cannot rise above: the ground at down = 0 for what flies; ground or water for rovers and boats, which
stay at 0; the surface and the bottom for a sub. Resting on legs or wheels there is friction, more with the
brakes on, no slipping sideways, and the attitude settles to what the undercarriage allows.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mavstack.sim.motion.arrays import Mask, bounded, dot
from mavstack.sim.motion.battery import GRAVITY
from mavstack.sim.motion.demands import Mode

if TYPE_CHECKING:
    from mavstack.sim.motion.fleet import Fleet

#: How many times stronger the friction is with brakes, or with motors stopped.
BRAKES = 8.0
#: Share of a misfit of attitude that goes in a step on the ground.
SETTLING = 0.2


def move(fleet: Fleet, step: float) -> None:
    """Integrate a step of the forces, and stop what touches."""
    before = fleet.velocity.copy()
    fleet.velocity += fleet.force * step
    fleet.velocity[2] += GRAVITY * step
    fleet.position += (before + fleet.velocity) * (0.5 * step)
    down, sinking = fleet.position[2], fleet.velocity[2]
    low, high = down >= fleet.floor, down <= fleet.ceiling
    sinking[:] = np.where(low, np.minimum(sinking, 0.0), np.where(high, np.maximum(sinking, 0.0), sinking))
    fleet.position[2] = bounded(down, fleet.ceiling, fleet.floor)
    fleet.on_ground[:] = low | high
    resting = low & (fleet.friction > 0.0)
    if resting.any():
        _rest(fleet, resting, step)
    np.divide(fleet.velocity - before, step, out=fleet.acceleration)


def _rest(fleet: Fleet, resting: Mask, step: float) -> None:
    """Let friction and the undercarriage hold what rests."""
    braked = (fleet.mode == Mode.STOP) | (fleet.mode == Mode.ROLL_OUT)
    friction = fleet.friction * np.where(braked, BRAKES, 1.0) * step
    ahead, aside = dot(fleet.velocity, fleet.forward), dot(fleet.velocity, fleet.right)
    slowed = np.copysign(np.maximum(np.abs(ahead) - friction, 0.0), ahead)
    slipped = np.copysign(np.maximum(np.abs(aside) * 0.5 - friction, 0.0), aside)
    flat = fleet.forward * slowed + fleet.right * slipped
    np.copyto(fleet.velocity[:2], flat[:2], where=resting)
    roll, pitch = fleet.attitude[:2]
    misfit = np.zeros_like(fleet.attitude)
    misfit[0] = roll
    misfit[1] = pitch - bounded(pitch, 0.0, fleet.rest_pitch)
    fleet.attitude -= misfit * (SETTLING * resting)
    held = np.where(resting, 0.5, 1.0)
    fleet.rates[0] *= held
    fleet.rates[1] *= np.where(misfit[1] != 0.0, held, 1.0)
    rolling = np.minimum(0.3 * np.abs(ahead), 1.0)
    fleet.rates[2] *= np.where(resting, rolling, 1.0)
