"""Quantities of the configuration: durations, rates and sizes, as numbers or as texts with a unit.

Each function raises `ValueError` whose text says which form is valid.
"""

from __future__ import annotations

import re
from math import isfinite
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Mapping

_TIMES: Final[Mapping[str, float]] = MappingProxyType(
    {"": 1.0, "us": 1e-6, "ms": 1e-3, "s": 1.0, "min": 60.0, "h": 3600.0, "d": 86400.0}
)
_SIZES: Final[Mapping[str, float]] = MappingProxyType(
    {"": 1, "b": 1, "kb": 1e3, "mb": 1e6, "gb": 1e9, "kib": 2**10, "mib": 2**20, "gib": 2**30}
)
_BYTE_RATES: Final[Mapping[str, float]] = MappingProxyType(
    {
        "": 1,
        "b/s": 1,
        "kb/s": 1e3,
        "mb/s": 1e6,
        "kib/s": 2**10,
        "mib/s": 2**20,
        "bit/s": 1 / 8,
        "kbit/s": 1e3 / 8,
        "mbit/s": 1e6 / 8,
    }
)
_HERTZ: Final[Mapping[str, float]] = MappingProxyType({"": 1.0, "hz": 1.0, "/s": 1.0, "/min": 1 / 60})
_QUANTITY: Final = re.compile(r"(\d{1,18}(?:\.\d{0,9})?|\.\d{1,9})\s*([A-Za-z/]*)")
#: Largest quantity: larger values are mistakes, and would overflow timers.
_MAX_QUANTITY: Final = 1e15


def duration(value: object) -> float:
    """Return a time in seconds, from a number or a text such as `500 ms`, `1.5 s`, `10 min` or `1 h`."""
    return _quantity(value, _TIMES, "a time such as 0.5, '500 ms', '10 min' or '1 h'")


def byte_size(value: object) -> int:
    """Return a number of bytes, from a number or a text such as `64 KiB` or `100 MB`."""
    return int(_quantity(value, _SIZES, "a number of bytes such as 4096, '64 KiB' or '100 MB'"))


def byte_rate(value: object) -> float:
    """Return bytes per second, from a number or a text such as `20 kB/s` or `57.6 kbit/s`."""
    return _quantity(value, _BYTE_RATES, "bytes per second such as 20000, '20 kB/s' or '57.6 kbit/s'")


def hertz(value: object) -> float:
    """Return a rate in hertz, from a number or a text such as `4 Hz` or `6/min`."""
    return _quantity(value, _HERTZ, "a rate in hertz such as 4, '0.2 Hz' or '6/min'")


def _quantity(value: object, units: Mapping[str, float], expected: str) -> float:
    if isinstance(value, int | float) and not isinstance(value, bool):
        number = float(value) if abs(value) <= _MAX_QUANTITY else float("inf")
    else:
        match = _QUANTITY.fullmatch(value.strip()) if isinstance(value, str) else None
        if match is None or match[2].lower() not in units:
            raise ValueError(expected)
        number = float(match[1]) * units[match[2].lower()]
    if not isfinite(number) or not 0 <= number <= _MAX_QUANTITY:
        raise ValueError(expected)
    return number
