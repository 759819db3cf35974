"""Times of measurements."""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING

from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from mavstack.vehicle.vehicle import Vehicle


def microseconds(vehicle: Vehicle, time: float | None) -> int:
    """Return a time in Unix seconds, or now, in the clock with which the connection answers TIMESYNC."""
    if time is not None and not (isfinite(time) and time >= 0):
        raise InvalidArgumentError(f"a time must be finite Unix seconds, got {time}")
    return round((vehicle.component.now() if time is None else time) * 1e6)
