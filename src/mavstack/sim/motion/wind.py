"""Wind: one mean for the world, gusts for each body.

The mean is lower near the ground: half at the surface, full from 10 m up. Gusts are first-order filtered
noise whose standard deviation is the turbulence's share of the mean speed, half as strong vertically, and
zero vertically at the ground.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from mavstack.sim.motion.state import StateArray

#: Maximum wind speed in m/s.
MAX_WIND = 60.0


class WindModel:
    """Mean wind and gusts."""

    def __init__(self) -> None:
        self.north = 0.0
        self.east = 0.0
        self.gusts = 0.0

    def set(self, speed: float, direction: float, turbulence: float) -> None:
        """Set the mean wind.

        Args:
            speed: m/s.
            direction: Where the wind comes from, in degrees.
            turbulence: Standard deviation of the gusts as a share of the speed.
        """
        speed = min(max(speed, 0.0), MAX_WIND) if math.isfinite(speed) else 0.0
        bearing = math.radians(direction) if math.isfinite(direction) else 0.0
        share = min(max(turbulence, 0.0), 1.0) if math.isfinite(turbulence) else 0.0
        self.north = -speed * math.cos(bearing)
        self.east = -speed * math.sin(bearing)
        self.gusts = speed * share

    @property
    def is_calm(self) -> bool:
        """True without any wind."""
        return not (self.north or self.east)

    def update(self, state: StateArray) -> None:
        """Compute the air velocity at each body."""
        if self.is_calm:
            state.air.fill(0.0)
            return
        share = 0.5 + 0.5 * np.minimum(np.maximum(state.position[2] * -0.1, 0.0), 1.0)
        gusts = state.slow_noise[:3]
        air = state.air
        np.multiply(self.gusts * gusts[0] + self.north, share, out=air[0])
        np.multiply(self.gusts * gusts[1] + self.east, share, out=air[1])
        np.multiply((0.5 * self.gusts) * gusts[2], 2.0 * share - 1.0, out=air[2])
