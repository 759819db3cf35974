"""Conversion from SI units to wire integers: rounded, clipped to their type, marked if unknown.

Telemetry has to be sent in every state of the vehicle, so no function here raises: a number that is too large
becomes the largest of its type, and NaN becomes `unknown`.
"""

from __future__ import annotations

UINT8_MAX, INT16_MAX, UINT16_MAX, INT32_MAX, UINT32_MAX = 0xFF, 0x7FFF, 0xFFFF, 0x7FFFFFFF, 0xFFFFFFFF

_DEGREES = 57.29577951308232
_FULL_CIRCLE = 36_000


def uint8(value: float, unknown: int = 0) -> int:
    """Return the nearest uint8."""
    return round(value) if 0.0 <= value <= 255.0 else _limit(value, 0, UINT8_MAX, unknown)


def int16(value: float, unknown: int = 0) -> int:
    """Return the nearest int16."""
    return round(value) if -32768.0 <= value <= 32767.0 else _limit(value, -32768, INT16_MAX, unknown)


def uint16(value: float, unknown: int = UINT16_MAX) -> int:
    """Return the nearest uint16 below 65535, which marks an unknown value in many fields."""
    return round(value) if 0.0 <= value <= 65534.0 else _limit(value, 0, UINT16_MAX - 1, unknown)


def int32(value: float, unknown: int = 0) -> int:
    """Return the nearest int32."""
    fits = -2147483648.0 <= value <= 2147483647.0
    return round(value) if fits else _limit(value, -INT32_MAX - 1, INT32_MAX, unknown)


def uint32(value: float, unknown: int = 0) -> int:
    """Return the nearest uint32."""
    return round(value) if 0.0 <= value <= 4294967295.0 else _limit(value, 0, UINT32_MAX, unknown)


def percent(share: float, unknown: int = -1) -> int:
    """Return a share of 0 to 1 in percent."""
    return round(share * 100.0) if 0.0 <= share <= 1.0 else _limit(share, 0, 100, unknown)


def degrees_e7(value: float) -> int:
    """Return a latitude or longitude in 1e-7 degrees."""
    return int32(value * 1e7)


def centidegrees(radians: float, unknown: int = UINT16_MAX) -> int:
    """Return a direction in radians as 0 to 35999 hundredths of a degree."""
    return round(radians * 5729.577951308232) % _FULL_CIRCLE if -1e6 < radians < 1e6 else unknown


def whole_degrees(radians: float) -> int:
    """Return a direction in radians as 0 to 359 degrees."""
    return int(radians * _DEGREES) % 360 if 0.0 <= radians < 1e6 else centidegrees(radians, 0) // 100


def _limit(value: float, low: int, high: int, unknown: int) -> int:
    """Return the bound that a value exceeds; `unknown` for NaN."""
    if value != value:  # NaN
        return unknown
    return low if value < 0 else high
