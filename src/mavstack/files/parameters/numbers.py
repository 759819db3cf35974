"""Parameter values in files: read, written, and compared with the values of a vehicle.

An integer is written exactly, a float with the fewest digits that read back to the same float32. MAVProxy
writes six decimals and Mission Planner seven digits, so a value in their files also agrees with every value
that they would have written in the same way; otherwise a file saved from a vehicle would differ from it.
"""

from __future__ import annotations

import re
from math import copysign, isfinite
from struct import pack, unpack
from typing import TYPE_CHECKING

from mavstack.services.frames import as_float32
from mavstack.services.parameters.value import is_integer, same, shortest

if TYPE_CHECKING:
    from mavstack.services.parameters import Value

#: A whole float32 value below this limit is written without an exponent.
_MAX_WHOLE = 1e15
#: Maximum number of characters of a value.
_MAX_LENGTH = 64
_NUMBER = re.compile(
    r"[+-]?(?:0[xX][0-9a-fA-F]+|(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?|(?i:nan|inf|infinity))", re.ASCII
)
_SIX_DECIMALS = re.compile(r"[+-]?\d+\.\d{6}", re.ASCII)
_EXPONENT = re.compile(r"[eE].*")
_SEVEN = 7


def read_number(text: str) -> Value | None:
    """Return the number in a text, an int if it is written as one; None if it is not a number."""
    if len(text) > _MAX_LENGTH or not _NUMBER.fullmatch(text):
        return None
    if text.lstrip("+-")[:2].lower() == "0x":
        return int(text, 16)
    if text.lstrip("+-").isdigit() and not _is_minus_zero(text):
        return int(text)
    return float(text)


def write_number(value: Value) -> str:
    """Return the shortest text that reads back to the value, for a float as a float32."""
    if isinstance(value, int):
        return str(int(value))
    if value == 0:
        return "-0.0" if copysign(1, value) < 0 else "0"
    single = as_single(value)
    if abs(single) < _MAX_WHOLE and single == int(single):
        return str(int(single))
    return shortest(single)


def as_single(value: Value) -> float:
    """Return the float32 nearest to a value; infinite if it is too large."""
    return float(unpack("<f", pack("<f", as_float32(value)))[0])


def agree(one: Value, other: Value, *, kind: int | None = None, exact: bool = True) -> bool:
    """Return whether two values are the same for a parameter of this type (None: not known).

    Two integers are compared as such, unless their type or an inexact encoding makes floats of them.
    """
    if same(one, other):
        return True
    if exact and kind is not None and is_integer(kind):
        return False
    both_whole = isinstance(one, int) and isinstance(other, int)
    if kind is None and exact and both_whole:
        return False
    return same(as_single(one), as_single(other))


def rounds_to(held: Value, text: str) -> bool:
    """Return whether a program that writes six decimals or seven digits writes `held` as `text`."""
    wanted = read_number(text)
    if not isinstance(wanted, float) or not isfinite(held) or not isfinite(wanted):
        return False
    digits = len(re.sub(r"\D", "", _EXPONENT.sub("", text)).strip("0"))
    if digits <= _SEVEN and float(f"{held:.7g}") == wanted:
        return True
    return bool(_SIX_DECIMALS.fullmatch(text)) and float(f"{held:.6f}") == wanted


def _is_minus_zero(text: str) -> bool:
    return text[0] == "-" and not text.strip("-0")
