"""Conversions from field values on the wire to units, with None for the value that means "not known".

The field's definition tells which value that is; where it does not, the firmwares' behaviour does.
"""

from __future__ import annotations

from math import degrees, isfinite
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mavstack.vehicle.telemetry.values import Vector

UINT8_MAX, INT16_MAX, UINT16_MAX, INT32_MAX = 0xFF, 0x7FFF, 0xFFFF, 0x7FFFFFFF

_DEGREES_E7 = 1e7
_POLE, _DATE_LINE = 90.0, 180.0


def known(value: int, unknown: int) -> int | None:
    """Return the value, or None if it is the one that means "not known"."""
    return None if value == unknown else value


def scaled(value: int, unknown: int, divisor: float) -> float | None:
    """Return the value over `divisor`, or None if it is the one that means "not known"."""
    return None if value == unknown else value / divisor


def finite(value: float) -> float | None:
    """Return the value, or None if it is not finite."""
    return value if isfinite(value) else None


def finite_degrees(radians: float) -> float | None:
    """Return radians as degrees, or None if they are not finite."""
    return degrees(radians) if isfinite(radians) else None


def vector(x: float, y: float, z: float) -> Vector | None:
    """Return three numbers, or None unless all of them are finite."""
    return (x, y, z) if isfinite(x) and isfinite(y) and isfinite(z) else None


def vector_in_degrees(x: float, y: float, z: float) -> Vector | None:
    """Return three angles or rates in degrees, or None unless all of them are finite."""
    return (degrees(x), degrees(y), degrees(z)) if vector(x, y, z) else None


def location(latitude: int, longitude: int) -> tuple[float, float] | None:
    """Return degrees, or None if they are invalid; 0, 0 is sent before the position is known."""
    north, east = latitude / _DEGREES_E7, longitude / _DEGREES_E7
    if (latitude == 0 and longitude == 0) or abs(north) > _POLE or abs(east) > _DATE_LINE:
        return None
    return north, east
