"""What an autopilot may demand of a body, made safe.

`Mode` says which demand is flown; its numbers are in the rows `target`, `start`, `along`, `pace`, `radius`,
`stick` and the `yaw_` rows of `StateArray`, written once when demanded. Whatever the numbers were, those written
are finite and within what an airframe could mean: a loop never meets a NaN.
"""

from __future__ import annotations

import math
from typing import Final

#: Beyond this many metres from the origin nothing is a place to go to.
MAX_DISTANCE = 1e6
#: A line shorter than this has no direction; one horizontally shorter than this gives no heading.
MIN_LINE = 0.01
MIN_HEADING_LINE = 3.0


class Mode:
    """Which demand is flown; LINE to CIRCLE are those that guide a velocity (plain floats, as rows hold)."""

    STOP: Final = 0.0
    IDLE: Final = 1.0
    LINE: Final = 2.0
    VELOCITY: Final = 3.0
    CIRCLE: Final = 4.0
    ATTITUDE: Final = 5.0
    RATES: Final = 6.0
    STICKS: Final = 7.0
    ROLL_OUT: Final = 8.0


class YawMode:
    """What `yaw_demand` is: a heading to hold, a rate to turn at; or the heading to the circle's centre."""

    HOLD: Final = 0.0
    RATE: Final = 1.0
    CENTRE: Final = 2.0


def finite(value: float | None, default: float, low: float, high: float) -> float:
    """Give `value` within bounds; `default` for None and for what is no number."""
    if value is None or value != value:
        return default
    return min(max(value, low), high)


def angle(value: float | None, default: float) -> float:
    """Give an angle within a turn; `default` for None and for what is no finite number."""
    if value is None or not math.isfinite(value):
        return default
    return math.remainder(value, math.tau)


def line(
    start: tuple[float, float, float], target: tuple[float, float, float]
) -> tuple[tuple[float, float, float], float]:
    """Give the direction of the line from `start` to `target`, and its length."""
    north, east, down = (end - begin for begin, end in zip(start, target, strict=True))
    size = math.sqrt(north * north + east * east + down * down)
    if size < MIN_LINE:
        return (0.0, 0.0, 0.0), 0.0
    return (north / size, east / size, down / size), size
