"""From the numbers of the wire to values: scaled, or None where the number stands for "not known".

What stands for that says the definition of each field; where it is silent, what firmwares send says it.
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
    """The number, unless it is the one that stands for "not known"."""
    return None if value == unknown else value


def scaled(value: int, unknown: int, divisor: float) -> float | None:
    """The number in other units, unless it is the one that stands for "not known"."""
    return None if value == unknown else value / divisor


def finite(value: float) -> float | None:
    """The number, unless it is none."""
    return value if isfinite(value) else None


def finite_degrees(radians: float) -> float | None:
    """An angle or a rate, unless it is no number."""
    return degrees(radians) if isfinite(radians) else None


def vector(x: float, y: float, z: float) -> Vector | None:
    """Three numbers, if all of them are numbers."""
    return (x, y, z) if isfinite(x) and isfinite(y) and isfinite(z) else None


def vector_in_degrees(x: float, y: float, z: float) -> Vector | None:
    """Three angles or rates, if all of them are numbers."""
    return (degrees(x), degrees(y), degrees(z)) if vector(x, y, z) else None


def place(latitude: int, longitude: int) -> tuple[float, float] | None:
    """A place in degrees; both zero is what ArduPilot sends before it knows one, and no place on earth."""
    north, east = latitude / _DEGREES_E7, longitude / _DEGREES_E7
    if (latitude == 0 and longitude == 0) or abs(north) > _POLE or abs(east) > _DATE_LINE:
        return None
    return north, east
