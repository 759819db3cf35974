"""Named rows of one array, and vector operations on rows.

All numbers of all bodies are one float64 array of shape (fields, bodies), so that every line of physics is a
numpy operation on whole rows. `Rows` names the rows: a subclass annotates each name as `Scalar` (one row) or
`Vector` (three rows: north, east, down, or roll, pitch, yaw), and an instance holds the rows as views. Bodies
of one vehicle type are neighbouring columns, so a type is a slice: `select` returns the same names over some
of the columns, again as views, without copying.
"""

from __future__ import annotations

from typing import Annotated, ClassVar, Self, get_type_hints

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]
Scalar = Annotated[Array, 1]
Pair = Annotated[Array, 2]
Vector = Annotated[Array, 3]
Quad = Annotated[Array, 4]


class Rows:
    """Views of the rows of `data`, by name."""

    #: By name of a view: its first row, and its number of rows.
    ROWS: ClassVar[dict[str, tuple[int, int]]] = {}
    #: The total number of rows.
    ROW_COUNT: ClassVar[int] = 0

    def __init_subclass__(cls) -> None:
        hints = get_type_hints(cls, include_extras=True)
        counts = {name: hint.__metadata__[0] for name, hint in hints.items() if hasattr(hint, "__metadata__")}
        *firsts, cls.ROW_COUNT = np.cumsum([0, *counts.values()]).tolist()
        cls.ROWS = {name: (first, counts[name]) for name, first in zip(counts, firsts, strict=True)}

    def __init__(self, data: Array) -> None:
        self.data = data
        for name, (first, count) in self.ROWS.items():
            setattr(self, name, data[first] if count == 1 else data[first : first + count])

    def select(self, columns: slice) -> Self:
        """Return views of the same rows for some of the columns."""
        return type(self)(self.data[:, columns])

    @property
    def count(self) -> int:
        """Number of bodies (columns)."""
        return int(self.data.shape[1])


def clip(values: Array, low: Array | float, high: Array | float) -> Array:
    """Limit `values` to a range (like `numpy.clip`, several times faster on short rows)."""
    return np.minimum(np.maximum(values, low), high)


def wrap_angle(angle: Array) -> Array:
    """Return angles in radians wrapped to -pi..pi."""
    return angle - np.rint(angle * (0.5 / np.pi)) * (2 * np.pi)


def dot(a: Array, b: Array) -> Array:
    """Return the dot products of two rows of vectors."""
    product: Array = a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    return product


def sqrt(values: Array) -> Array:
    """Return square roots."""
    roots: Array = np.sqrt(values)
    return roots


def length(vector: Array) -> Array:
    """Return the lengths of vectors of three rows."""
    return sqrt(dot(vector, vector))


def horizontal_length(vector: Array) -> Array:
    """Return the lengths of the horizontal parts of vectors."""
    return sqrt(vector[0] * vector[0] + vector[1] * vector[1])


def limit_length(vector: Array, limit: Array | float) -> Array:
    """Shorten horizontal vectors of two rows to at most `limit`."""
    size = horizontal_length(vector)
    short: Array = vector * np.minimum(1.0, limit / np.maximum(size, 1e-9))
    return short


def approach_speed(distance: Array, gain: Array, deceleration: Array) -> Array:
    """Return the speed at `distance` metres before a stopping point.

    Near the point the speed is gain x distance; far from it, the square root of a constant deceleration; with
    a smooth transition.
    """
    return deceleration / gain * (sqrt(1.0 + 2.0 * gain * gain * distance / deceleration) - 1.0)
