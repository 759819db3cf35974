"""Telling a packet that was overtaken on its way from a new one.

Parameter messages carry no number, so an old PARAM_VALUE that comes late looks like a change back, and an
old PARAM_SET like a new wish. The sequence number of the packets tells: one that lies a little behind the
newest, shortly after it, was overtaken or is a copy. Numbers begin anew after 256, so that after a while
nothing is known and everything is taken as new; who is judged wrongly only asks again.
"""

from __future__ import annotations

#: How far behind, in packets and in seconds, an overtaken packet may come.
BEHIND = 32
WITHIN = 0.5


class ReorderFilter:
    """The newest packet of one source."""

    __slots__ = ("_at", "_sequence")

    def __init__(self) -> None:
        self._sequence = 0
        self._at: float | None = None

    def is_overtaken(self, sequence: int, now: float) -> bool:
        """Take in a packet; True if it is older than the newest, or a copy of it."""
        recent = self._at is not None and now - self._at < WITHIN
        if recent and (self._sequence - sequence) % 256 < BEHIND:
            return True
        self._sequence, self._at = sequence, now
        return False
