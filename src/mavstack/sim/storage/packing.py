"""Several records of a log at once, by one precompiled struct; numbers that do not fit are made to.

The usual path knows nothing of numbers that a format cannot hold: packing fails, and only then a sample is
looked at value by value. Then what is no number is 0 in an integer, and what is too large is the largest.
"""

from __future__ import annotations

import math
import re
import struct
from itertools import count
from operator import itemgetter
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from mavstack.sim.storage.sample import FlightSample

#: What a field holds.
Scalar: TypeAlias = float | bytes
#: Makes a whole number of a field: `round`, or `tame_round` where that may fail.
Rounding: TypeAlias = "Callable[[float], int]"
#: Gives the values of a sample in a block.
Values: TypeAlias = "Callable[[FlightSample, Rounding], tuple[Scalar, ...]]"

_LARGEST = 1e30
_CODE = re.compile(r"(\d*)([a-zA-Z?])")
_FAILURES = (struct.error, OverflowError, ValueError)


class Block:
    """Records that are written together: `codes` is a struct format without byte order.

    `pieces` has an element a value: None, or the bytes that always stand there and need not be given.
    """

    def __init__(self, codes: str, pieces: Sequence[bytes | None] = ()) -> None:
        self._struct = struct.Struct("<" + codes)
        self._constants = tuple(piece for piece in pieces if piece is not None)
        self._in_order = _order(pieces) if self._constants else None
        self._ranges = [
            bounds for repeated, code in _CODE.findall(codes) for bounds in _bounds(repeated, code)
        ]
        self.size = self._struct.size

    def pack(
        self,
        values: Values,
        sample: FlightSample,
    ) -> bytes:
        """The bytes of a sample, whose values in this block `values` gives."""
        try:
            return self._struct.pack(*self._all(values(sample, round)))
        except _FAILURES:
            return self._pack_tamed(self._all(values(tamed(sample), tame_round)))

    def pack_values(self, *values: Scalar) -> bytes:
        """The bytes of these values."""
        try:
            return self._struct.pack(*self._all(values))
        except _FAILURES:
            return self._pack_tamed(self._all(values))

    def _all(self, values: tuple[Scalar, ...]) -> tuple[Scalar, ...]:
        """With what always stands between them."""
        return values if self._in_order is None else self._in_order(values + self._constants)

    def _pack_tamed(self, values: tuple[Scalar, ...]) -> bytes:
        fitted = [_fit(value, bounds) for value, bounds in zip(values, self._ranges, strict=True)]
        return self._struct.pack(*fitted)


def _order(pieces: Sequence[bytes | None]) -> Callable[[tuple[Scalar, ...]], tuple[Scalar, ...]]:
    """What brings values, followed by all constants, into the order of a record."""
    variables, constants = count(), count(sum(piece is None for piece in pieces))
    return itemgetter(*(next(variables if piece is None else constants) for piece in pieces))


def _bounds(repeated: str, code: str) -> list[tuple[float, float] | None]:
    """What each field of a code can hold; None where anything goes."""
    number = int(repeated or 1)
    if code in "s?":
        return [None] * (1 if code == "s" else number)
    if code in "fd":
        return [(-_LARGEST, _LARGEST)] * number
    bits = 8 * struct.calcsize("<" + code)
    signed = code.islower()
    return [(-(1 << bits - 1), (1 << bits - 1) - 1) if signed else (0, (1 << bits) - 1)] * number


def _fit(value: Scalar, bounds: tuple[float, float] | None) -> Scalar:
    if bounds is None or isinstance(value, bytes):
        return value
    if isinstance(bounds[0], int):
        value = tame_round(value)
    return min(max(value, bounds[0]), bounds[1]) if value == value else value


def tame_round(value: float) -> int:
    """The nearest whole number; 0 for what is no number."""
    if value != value:  # not a number
        return 0
    return round(min(max(value, -_LARGEST), _LARGEST))


class _Tamed:
    """An object whose floats are all of a size that can be computed with."""

    def __init__(self, of: object) -> None:
        self._of = of

    def __getattr__(self, name: str) -> object:
        return _tame(getattr(self._of, name))


def _tame(value: object) -> object:
    if isinstance(value, float) and value == value:
        return min(max(value, -_LARGEST), _LARGEST)
    return value


def tamed(sample: FlightSample) -> FlightSample:
    """The same sample without infinities."""
    plain = type(sample)(*map(_tame, sample))  # type: ignore[arg-type]
    return plain._replace(
        motion=_Tamed(sample.motion),  # type: ignore[arg-type]
        sensors=_Tamed(sample.sensors),  # type: ignore[arg-type]
        battery=_Tamed(sample.battery),  # type: ignore[arg-type]
        health=None if sample.health is None else _Tamed(sample.health),  # type: ignore[arg-type]
    )


def channels(values: Sequence[float], number: int, whole: Rounding) -> list[int]:
    """Exactly so many pulse widths; 0 where there is none."""
    widths = [*map(whole, values[:number])]
    return widths if len(widths) == number else widths + [0] * (number - len(widths))


def text_of(text: str, size: int) -> bytes:
    """A text as a log keeps it, whole characters only."""
    return text.replace("\0", "").encode("utf-8", "replace")[:size].decode("utf-8", "ignore").encode()


def pressure_altitude(pressure: float) -> float:
    """The height in metres in the standard atmosphere at so many hPa."""
    share = max(1e-3, pressure) / 1013.25
    return 44330.769 * (1.0 - math.pow(share, 0.190263))
