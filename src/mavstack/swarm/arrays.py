"""The types of arrays in this package."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
import numpy.typing as npt

#: An array of floats; positions and velocities have the shape (n, 3): metres north, east and up.
Points: TypeAlias = npt.NDArray[np.float64]
#: An array of integers, such as the slot of each vehicle.
Indices: TypeAlias = npt.NDArray[np.int64]
