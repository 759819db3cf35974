"""Wind: one mean for the world, gusts for each body.

The mean is less near the ground: half of it at the surface, all of it from 10 m up. Gusts are first-order
filtered noise whose deviation is the turbulence's share of the mean speed, half as strong vertically, none
into the ground.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from mavstack.sim.motion.state import StateArray

#: Wind stronger than this is no weather.
MAX_WIND = 60.0


class WindModel:
    """The mean wind, and how gusty it is."""

    def __init__(self) -> None:
        self.north = 0.0
        self.east = 0.0
        self.gusts = 0.0

    def set(self, speed: float, direction: float, turbulence: float) -> None:
        """Let it update at `speed` m/s from `direction` in degrees, its gusts a share of that speed."""
        speed = min(max(speed, 0.0), MAX_WIND) if math.isfinite(speed) else 0.0
        bearing = math.radians(direction) if math.isfinite(direction) else 0.0
        share = min(max(turbulence, 0.0), 1.0) if math.isfinite(turbulence) else 0.0
        self.north = -speed * math.cos(bearing)
        self.east = -speed * math.sin(bearing)
        self.gusts = speed * share

    def update(self, state: StateArray) -> None:
        """Move the air around each body."""
        if not (self.north or self.east):
            state.air.fill(0.0)
            return
        share = 0.5 + 0.5 * np.minimum(np.maximum(state.position[2] * -0.1, 0.0), 1.0)
        gusts = state.wander[:3]
        air = state.air
        np.multiply(self.gusts * gusts[0] + self.north, share, out=air[0])
        np.multiply(self.gusts * gusts[1] + self.east, share, out=air[1])
        np.multiply((0.5 * self.gusts) * gusts[2], 2.0 * share - 1.0, out=air[2])
