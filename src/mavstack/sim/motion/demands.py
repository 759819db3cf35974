"""Demands that an autopilot may make of a body, made safe.

`Mode` selects which demand is flown; its numbers are the rows `target` to `stick` of `StateArray`, written
once per demand. Numbers from outside are made finite and clipped to the range that an airframe could mean, so
that no control loop ever meets a NaN.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

#: Positions further than this many metres from the origin are clipped.
MAX_DISTANCE = 1e6
#: Minimum length of a line in metres, so that its direction can be computed; and its minimum horizontal
#: length, so that its heading can be used.
MIN_LINE = 0.01
MIN_HEADING_LINE = 3.0


class Mode:
    """The demand that is flown; LINE to CIRCLE guide a velocity (plain floats, as rows hold)."""

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
    """The meaning of `yaw_demand`: a heading, a turn rate, or looking at the circle's centre."""

    HOLD: Final = 0.0
    RATE: Final = 1.0
    CENTRE: Final = 2.0


class Demand(NamedTuple):
    """One demand: its mode, and the numbers that the mode uses (metres, m/s, radians; see `StateArray`)."""

    mode: float
    target: tuple[float, float, float] = (0.0, 0.0, 0.0)
    start: tuple[float, float, float] = (0.0, 0.0, 0.0)
    direction: tuple[float, float, float] = (0.0, 0.0, 0.0)
    length: float = 0.0
    #: Horizontal speed, climb rate, sink rate and airspeed in m/s; None to use the body's limits.
    speeds: tuple[float, float, float, float] | None = None
    radius: float = 0.0
    yaw: tuple[float, float] = (YawMode.RATE, 0.0)
    stick: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)

    def rows(self, speeds: tuple[float, float, float, float]) -> tuple[float, ...]:
        """Return the values of the demand's rows, in the order of `StateArray`."""
        return (
            self.mode,
            *self.target,
            *self.start,
            *self.direction,
            self.length,
            *speeds,
            self.radius,
            *self.yaw,
            *self.stick,
        )


def finite(value: float | None, default: float, low: float, high: float) -> float:
    """Return `value` clipped to a range; `default` for None and NaN."""
    if value is None or value != value:
        return default
    return min(max(value, low), high)


def angle(value: float | None, default: float) -> float:
    """Return an angle within one turn; `default` for None and for a number that is not finite."""
    if value is None or not math.isfinite(value):
        return default
    return math.remainder(value, math.tau)


def line(
    start: tuple[float, float, float], target: tuple[float, float, float]
) -> tuple[tuple[float, float, float], float]:
    """Return the direction of the line from `start` to `target`, and its length in metres."""
    north, east, down = (end - begin for begin, end in zip(start, target, strict=True))
    size = math.sqrt(north * north + east * east + down * down)
    if size < MIN_LINE:
        return (0.0, 0.0, 0.0), 0.0
    return (north / size, east / size, down / size), size
