"""Random numbers of one body that do not depend on other bodies.

One table of normal numbers is made from the world's seed. Each row of each body walks through the table from
its own offset, drawn from the seed and the body's number, one entry per step. A step costs one look-up, a
body's noise is a function of seed, body and time, and adding or reading bodies does not change the noise of
others.

`slow_noise` holds slow noises of variance one, each white noise filtered by a first-order lag of its time
constant: w' = a w + sqrt(1 - a^2) n with a = exp(-dt / T).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from mavstack.sim.motion.arrays import Array

#: Number of entries of the noise table: 45 minutes at 50 Hz. A power of two, because indices wrap by a bit
#: mask.
TABLE = 1 << 17

#: Time constants in seconds of the slow noises, in the order of the rows of `StateArray.slow_noise`:
#: gusts, GPS position, estimated velocity, estimated attitude, barometer.
TIME_CONSTANTS = (3.0, 3.0, 2.0, 40.0, 40.0, 60.0, 3.0, 3.0, 3.0, 8.0, 8.0, 20.0, 60.0)
SLOW_NOISES = len(TIME_CONSTANTS)
#: Number of white noises for the sensors, in the order in which `sensors` uses them.
WHITES = 15


class Noise:
    """White and slow noise of all bodies."""

    def __init__(self, seed: int, step: float) -> None:
        self._seed = seed
        self._table = np.random.default_rng(seed).standard_normal(TABLE)
        self._offsets = np.zeros((SLOW_NOISES + WHITES, 0), np.int64)
        decay = np.exp(-step / np.array(TIME_CONSTANTS))
        self._decay = decay[:, None]
        self._gain = np.sqrt(1.0 - decay * decay)[:, None]

    def insert(self, column: int, number: int) -> Array:
        """Insert a body at `column`, and return the initial values of its slow noises."""
        own = np.random.default_rng([self._seed, number])
        offsets = own.integers(0, TABLE, SLOW_NOISES + WHITES)
        self._offsets = np.insert(self._offsets, column, offsets, axis=1)
        return own.standard_normal(SLOW_NOISES)

    def update_slow_noise(self, slow_noise: Array, tick: int) -> None:
        """Advance the slow noises by one step."""
        fresh = self._table.take((self._offsets[:SLOW_NOISES] + tick) & (TABLE - 1))
        slow_noise *= self._decay
        fresh *= self._gain
        slow_noise += fresh

    def white(self, tick: int) -> Array:
        """Return the white noises of a step, one row each."""
        return self._table.take((self._offsets[SLOW_NOISES:] + tick) & (TABLE - 1))
