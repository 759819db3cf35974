"""The pace of a course: how fast its time passes, so that a swarm pauses on its way and flies on.

All members slow down by the same factor, so each stays on its way, and the distances between members are
those of the plan at another time. The factor changes steadily, within `RAMP` seconds: members that stopped at
once would leave their ways.
"""

from __future__ import annotations

from typing import Final

#: Seconds in which a course stops, and in which it reaches its speed again.
RAMP: Final = 3.0


class Pace:
    """The pace of a course, which begins at full speed."""

    def __init__(self) -> None:
        #: True: the course stops and waits.
        self.paused = False
        #: Seconds of the course in a second.
        self.rate = 1.0
        #: The change of the rate in 1/s.
        self.slope = 0.0

    def advance(self, step: float) -> float:
        """Return the seconds of the course that pass in a step.

        Args:
            step: Seconds.
        """
        before = self.rate
        change = (-step if self.paused else step) / RAMP
        self.rate = min(max(before + change, 0.0), 1.0)
        self.slope = (self.rate - before) / step if step > 0.0 else 0.0
        return 0.5 * (before + self.rate) * step
