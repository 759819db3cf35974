"""The filter for reordered packets.

Parameter messages carry no number, so a late PARAM_VALUE looks like a change back, and a late PARAM_SET like
a new request. The packets' sequence numbers tell: one a little behind the newest, shortly after it, was
reordered or is a duplicate. Numbers wrap after 256, so that after a while every packet counts as new; a wrong
decision costs only a repetition.
"""

from __future__ import annotations

#: The number of packets by which a reordered packet may be late.
MAX_BEHIND = 32
#: The time in seconds by which a reordered packet may be late.
REORDER_WINDOW = 0.5


class ReorderFilter:
    """The newest packet of one source."""

    __slots__ = ("_at", "_sequence")

    def __init__(self) -> None:
        self._sequence = 0
        self._at: float | None = None

    def is_reordered(self, sequence: int, now: float) -> bool:
        """Record a packet; returns True if it is older than the newest, or a duplicate of it."""
        recent = self._at is not None and now - self._at < REORDER_WINDOW
        if recent and (self._sequence - sequence) % 256 < MAX_BEHIND:
            return True
        self._sequence, self._at = sequence, now
        return False
