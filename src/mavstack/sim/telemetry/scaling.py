"""From SI units to the integers of the wire: rounded, kept within their type, marked if there is nothing.

Telemetry has to go out whatever state the vehicle is in. So nothing here raises: what is too large becomes
the largest number of its type, and what is no number becomes `unknown`.
"""

from __future__ import annotations

UINT8_MAX, INT16_MAX, UINT16_MAX, INT32_MAX, UINT32_MAX = 0xFF, 0x7FFF, 0xFFFF, 0x7FFFFFFF, 0xFFFFFFFF

_DEGREES = 57.29577951308232
_CIRCLE = 36_000


def uint8(value: float, unknown: int = 0) -> int:
    """The nearest uint8."""
    return round(value) if 0.0 <= value <= 255.0 else _limit(value, 0, UINT8_MAX, unknown)


def int16(value: float, unknown: int = 0) -> int:
    """The nearest int16."""
    return round(value) if -32768.0 <= value <= 32767.0 else _limit(value, -32768, INT16_MAX, unknown)


def uint16(value: float, unknown: int = UINT16_MAX) -> int:
    """The nearest uint16; the last one, which often stands for `unknown`, is not given as a value."""
    return round(value) if 0.0 <= value <= 65534.0 else _limit(value, 0, UINT16_MAX - 1, unknown)


def int32(value: float, unknown: int = 0) -> int:
    """The nearest int32."""
    fits = -2147483648.0 <= value <= 2147483647.0
    return round(value) if fits else _limit(value, -INT32_MAX - 1, INT32_MAX, unknown)


def uint32(value: float, unknown: int = 0) -> int:
    """The nearest uint32."""
    return round(value) if 0.0 <= value <= 4294967295.0 else _limit(value, 0, UINT32_MAX, unknown)


def percent(share: float, unknown: int = -1) -> int:
    """A share of 0 to 1 in percent."""
    return round(share * 100.0) if 0.0 <= share <= 1.0 else _limit(share, 0, 100, unknown)


def degrees_e7(value: float) -> int:
    """A latitude or longitude."""
    return int32(value * 1e7)


def centidegrees(radians: float, unknown: int = UINT16_MAX) -> int:
    """A direction as 0 to 35999 hundredths of a degree."""
    return round(radians * 5729.577951308232) % _CIRCLE if -1e6 < radians < 1e6 else unknown


def whole_degrees(radians: float) -> int:
    """A direction as 0 to 359 degrees."""
    return int(radians * _DEGREES) % 360 if 0.0 <= radians < 1e6 else centidegrees(radians, 0) // 100


def _limit(value: float, least: int, most: int, unknown: int) -> int:
    if value != value:  # no number
        return unknown
    return least if value < 0 else most
