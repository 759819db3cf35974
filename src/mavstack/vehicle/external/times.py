"""Times of measurements."""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING

from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from mavstack.vehicle.vehicle import Vehicle


def microseconds(vehicle: Vehicle, time: float | None) -> int:
    """Return a time in Unix seconds, or now, in the clock with which the connection answers TIMESYNC."""
    return round((vehicle.component.now() if time is None else checked(time)) * 1e6)


def checked(time: float) -> float:
    """Return a time that is possible; raises InvalidArgumentError for others."""
    if not (isfinite(time) and time >= 0):
        raise InvalidArgumentError(f"a time must be finite Unix seconds, got {time}")
    return time
