"""Facts of parameters as files write them: numbers, named values, bits, flags, texts.

A fact that cannot be read is left out, since published files contain some; it says nothing about the others.
"""

from __future__ import annotations

from math import isfinite
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

from mavstack.dialects import common
from mavstack.files.parameters.numbers import read_number
from mavstack.services.parameters.metadata import BITS

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from mavstack.services.parameters import Value

#: Maximum number of characters of a text, and of named values of a parameter; larger ones are left out.
MAX_TEXT: Final = 10_000
MAX_VALUES: Final = 2_000
#: Maximum length of a parameter's name: 16 by the protocol, and room for placeholders in templates.
MAX_NAME: Final = 32
_MAX_DECIMALS: Final = 20

_TYPES: Final[Mapping[str, common.MavParamType]] = MappingProxyType(
    {
        **{kind.name.lower(): kind for kind in common.MavParamType},
        "float": common.MavParamType.REAL32,
        "double": common.MavParamType.REAL64,
    }
)


def name_of(value: object) -> str | None:
    """Return the name of a parameter, without the vehicle of "ArduCopter:RTL_ALT"; None if it is none."""
    name = value.rpartition(":")[2] if isinstance(value, str) else ""
    return name if 0 < len(name) <= MAX_NAME and name.isascii() and name.isprintable() else None


def text_of(value: object) -> str:
    """Return a text in one paragraph; empty if the value is none."""
    return " ".join(value[:MAX_TEXT].split()) if isinstance(value, str) else ""


def number_of(value: object) -> Value | None:
    """Return a finite number, also from a text; None if the value is none."""
    found = read_number(value.strip()) if isinstance(value, str) else value
    if isinstance(found, bool) or not isinstance(found, int | float):
        return None
    try:
        return found if isfinite(found) else None
    except OverflowError:  # the integer is too large for a float
        return None


def decimals_of(value: object) -> int | None:
    """Return a number of decimal places."""
    found = number_of(value)
    return int(found) if found is not None and 0 <= found <= _MAX_DECIMALS else None


def flag_of(value: object) -> bool:
    """Return a flag: true, "True", "1"."""
    return value is True or (isinstance(value, str) and value.strip().lower() in ("true", "1"))


def type_of(value: object) -> int | None:
    """Return the MAV_PARAM_TYPE of a type's name: "Float", "INT32"."""
    return _TYPES.get(value.lower()) if isinstance(value, str) else None


def range_of(value: object) -> tuple[float | None, float | None]:
    """Return the ends of a range: "0 100"."""
    match value.split() if isinstance(value, str) else []:
        case [low, high]:
            return ordered(number_of(low), number_of(high))
    return None, None


def ordered(low: float | None, high: float | None) -> tuple[float | None, float | None]:
    """Return the ends of a range; none at all if the lower one is above the higher one."""
    return (low, high) if low is None or high is None or low <= high else (None, None)


def values_of(pairs: Iterable[tuple[Any, Any]]) -> dict[Value, str]:
    """Return the names of values."""
    found = ((number_of(code), text_of(name)) for code, name in pairs)
    return dict([(code, name) for code, name in found if code is not None][:MAX_VALUES])


def bits_of(pairs: Iterable[tuple[Any, Any]]) -> dict[int, str]:
    """Return the names of bits."""
    found = values_of(pairs)
    return {int(bit): name for bit, name in found.items() if 0 <= bit < BITS and bit == int(bit)}
