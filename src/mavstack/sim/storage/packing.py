"""Packing of several log records by one precompiled struct; numbers that do not fit are clipped.

The fast path packs without checks. Only if packing fails, the sample is clipped value by value: NaN becomes 0
in an integer field, and a number out of range the nearest bound.
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

#: The value of a field, or the bytes of a text field.
Scalar: TypeAlias = float | bytes
#: Rounds a number to an integer: `round`, or `safe_round` for values that may be infinite or NaN.
Rounding: TypeAlias = "Callable[[float], int]"
#: Reads the values of a block from a sample.
Values: TypeAlias = "Callable[[FlightSample, Rounding], tuple[Scalar, ...]]"

_MAX_MAGNITUDE = 1e30
_CODE = re.compile(r"(\d*)([a-zA-Z?])")
_FAILURES = (struct.error, OverflowError, ValueError)


class Block:
    """Records that are written together.

    Args:
        codes: A struct format without byte order.
        pieces: One element per value: None, or the constant bytes at that place.
    """

    def __init__(self, codes: str, pieces: Sequence[bytes | None] = ()) -> None:
        self._struct = struct.Struct("<" + codes)
        self._constants = tuple(piece for piece in pieces if piece is not None)
        self._in_order = _order(pieces) if self._constants else None
        self._ranges = [
            bounds for repeated, code in _CODE.findall(codes) for bounds in _bounds(repeated, code)
        ]
        self.size = self._struct.size

    def pack(self, values: Values, sample: FlightSample) -> bytes:
        """Return the bytes of a sample, with the values that `values` reads from it."""
        try:
            return self._struct.pack(*self._all(values(sample, round)))
        except _FAILURES:
            return self._pack_clipped(self._all(values(finite_copy(sample), safe_round)))

    def pack_values(self, *values: Scalar) -> bytes:
        """Return the bytes of these values."""
        try:
            return self._struct.pack(*self._all(values))
        except _FAILURES:
            return self._pack_clipped(self._all(values))

    def _all(self, values: tuple[Scalar, ...]) -> tuple[Scalar, ...]:
        """Return the values with the constants between them."""
        return values if self._in_order is None else self._in_order(values + self._constants)

    def _pack_clipped(self, values: tuple[Scalar, ...]) -> bytes:
        """Return the bytes of values that are clipped to their fields."""
        fitted = [_fit(value, bounds) for value, bounds in zip(values, self._ranges, strict=True)]
        return self._struct.pack(*fitted)


def _order(pieces: Sequence[bytes | None]) -> Callable[[tuple[Scalar, ...]], tuple[Scalar, ...]]:
    """Return a function that orders values, followed by all constants, as in the record."""
    variables, constants = count(), count(sum(piece is None for piece in pieces))
    return itemgetter(*(next(variables if piece is None else constants) for piece in pieces))


def _bounds(repeated: str, code: str) -> list[tuple[float, float] | None]:
    """Return the range of each field of a code; None for any value."""
    number = int(repeated or 1)
    if code in "s?":
        return [None] * (1 if code == "s" else number)
    if code in "fd":
        return [(-_MAX_MAGNITUDE, _MAX_MAGNITUDE)] * number
    bits = 8 * struct.calcsize("<" + code)
    signed = code.islower()
    return [(-(1 << bits - 1), (1 << bits - 1) - 1) if signed else (0, (1 << bits) - 1)] * number


def _fit(value: Scalar, bounds: tuple[float, float] | None) -> Scalar:
    """Clip a value to the range of its field."""
    if bounds is None or isinstance(value, bytes):
        return value
    if isinstance(bounds[0], int):
        value = safe_round(value)
    return min(max(value, bounds[0]), bounds[1]) if value == value else value


def safe_round(value: float) -> int:
    """Return the nearest integer; 0 for NaN."""
    if value != value:  # NaN
        return 0
    return round(min(max(value, -_MAX_MAGNITUDE), _MAX_MAGNITUDE))


class _FiniteView:
    """View of an object whose float attributes are limited to a finite range."""

    def __init__(self, of: object) -> None:
        self._of = of

    def __getattr__(self, name: str) -> object:
        return _limit(getattr(self._of, name))


def _limit(value: object) -> object:
    """Limit a float to a finite range."""
    if isinstance(value, float) and value == value:
        return min(max(value, -_MAX_MAGNITUDE), _MAX_MAGNITUDE)
    return value


def finite_copy(sample: FlightSample) -> FlightSample:
    """Return the sample without infinities."""
    plain = type(sample)(*map(_limit, sample))  # type: ignore[arg-type]
    return plain._replace(
        motion=_FiniteView(sample.motion),  # type: ignore[arg-type]
        sensors=_FiniteView(sample.sensors),  # type: ignore[arg-type]
        battery=_FiniteView(sample.battery),  # type: ignore[arg-type]
        health=None if sample.health is None else _FiniteView(sample.health),  # type: ignore[arg-type]
    )


def channels(values: Sequence[float], number: int, to_int: Rounding) -> list[int]:
    """Return exactly `number` pulse widths; 0 for missing channels."""
    widths = [*map(to_int, values[:number])]
    return widths if len(widths) == number else widths + [0] * (number - len(widths))


def text_of(text: str, size: int) -> bytes:
    """Return a text as UTF-8, cut at a whole character."""
    return text.replace("\0", "").encode("utf-8", "replace")[:size].decode("utf-8", "ignore").encode()


def pressure_altitude(pressure: float) -> float:
    """Return the altitude in metres in the standard atmosphere at a pressure in hPa."""
    share = max(1e-3, pressure) / 1013.25
    return 44330.769 * (1.0 - math.pow(share, 0.190263))
