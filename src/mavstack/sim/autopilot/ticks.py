"""The ticks of an autopilot, and the checks that run on each of them."""

from __future__ import annotations

from typing import Protocol

#: Interval between two ticks of the autopilot, in seconds.
TICK = 0.1


class Watch(Protocol):
    """A check that runs on each tick, such as a failsafe or the fence."""

    def tick(self, now: float) -> None:
        """Check once at the time `now`, and act."""
