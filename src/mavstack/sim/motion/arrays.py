"""Named rows of one array, and the few vector operations the rest is written in.

All numbers of all bodies are one array (fields, bodies) of float64. A field of a body is an element of a
row, so that every line of physics is a numpy operation on whole rows. `Rows` gives the rows names: its
subclass annotates each as `Scalar` (one row) or `Vector` (three rows, north east down or roll pitch yaw),
and an instance holds them as views. Bodies of one type are neighbours, so those of a type are a slice:
`part` gives the same names over some of the columns, again as views, with nothing copied.
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

    #: For each name its first row, and how many it has.
    ROWS: ClassVar[dict[str, tuple[int, int]]] = {}
    #: How many rows there are.
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
        """Give the same rows of some bodies."""
        return type(self)(self.data[:, columns])

    @property
    def count(self) -> int:
        """How many bodies there are."""
        return int(self.data.shape[1])


def clip(values: Array, low: Array | float, high: Array | float) -> Array:
    """Keep `values` within bounds (as numpy's clip, several times faster on short rows)."""
    return np.minimum(np.maximum(values, low), high)


def wrap_angle(angle: Array) -> Array:
    """Bring an angle into -pi..pi."""
    return angle - np.rint(angle * (0.5 / np.pi)) * (2 * np.pi)


def dot(a: Array, b: Array) -> Array:
    """Multiply two rows of vectors."""
    product: Array = a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    return product


def sqrt(values: Array) -> Array:
    """Take square roots."""
    roots: Array = np.sqrt(values)
    return roots


def length(vector: Array) -> Array:
    """Measure vectors of three rows."""
    return sqrt(dot(vector, vector))


def horizontal_length(vector: Array) -> Array:
    """Measure the horizontal part of vectors."""
    return sqrt(vector[0] * vector[0] + vector[1] * vector[1])


def limit_length(vector: Array, limit: Array | float) -> Array:
    """Shorten horizontal vectors of two rows to at most `limit`."""
    size = horizontal_length(vector)
    short: Array = vector * np.minimum(1.0, limit / np.maximum(size, 1e-9))
    return short


def approach_speed(distance: Array, gain: Array, deceleration: Array) -> Array:
    """Say how fast to go at `distance` from where to stop.

    Near it is gain x distance; far off the square root of a constant deceleration; smooth in between.
    """
    return deceleration / gain * (sqrt(1.0 + 2.0 * gain * gain * distance / deceleration) - 1.0)
