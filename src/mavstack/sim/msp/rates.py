"""Turn rates of acro mode: from the position of a stick to degrees per second.

Betaflight's "actual" rates have the sensitivity around the middle and the rate at full stick, with an expo
between them; its older rates grow by a super factor. iNav has the rate at full stick and an expo.
"""

from __future__ import annotations

from typing import Final

#: Values of `rates_type` in MSP_RC_TUNING of Betaflight.
BETAFLIGHT_RATES, ACTUAL_RATES = 0, 3
#: Maximum rate of every curve, in degrees per second.
MAX_RATE: Final = 1998.0
_RC_RATE_KNEE: Final = 2.0
_RC_RATE_STEEP: Final = 14.54
_MAX_SUPER: Final = 0.99


def actual_rate(stick: float, rc_rate: int, rate: int, expo: int) -> float:
    """Return the rate of the actual curve.

    Args:
        stick: Position, -1 to 1.
        rc_rate: Sensitivity around the middle, in tens of degrees per second.
        rate: Rate at full stick, in tens of degrees per second.
        expo: Expo in percent.
    """
    size, share = abs(stick), expo / 100
    curve = size * (stick**4 * size * share + size * (1 - share))
    added = max(0.0, rate * 10.0 - rc_rate * 10.0) * curve
    return _clip(stick * rc_rate * 10.0 + (added if stick > 0 else -added))


def betaflight_rate(stick: float, rc_rate: int, rate: int, expo: int) -> float:
    """Return the rate of Betaflight's older curve; the arguments are in hundredths."""
    share = expo / 100
    curved = stick * (abs(stick) ** 3 * share + 1 - share)
    sensitivity = rc_rate / 100
    if sensitivity > _RC_RATE_KNEE:
        sensitivity += _RC_RATE_STEEP * (sensitivity - _RC_RATE_KNEE)
    factor = 1.0 / (1.0 - min(abs(stick) * rate / 100, _MAX_SUPER))
    return _clip(200.0 * sensitivity * curved * factor)


def inav_rate(stick: float, rate: int, expo: int) -> float:
    """Return iNav's rate.

    Args:
        stick: Position, -1 to 1.
        rate: Rate at full stick, in tens of degrees per second.
        expo: Expo in percent.
    """
    share = expo / 100
    return _clip(rate * 10.0 * stick * (1 - share + share * stick * stick))


def _clip(rate: float) -> float:
    return min(max(rate, -MAX_RATE), MAX_RATE)
