"""Whether a component started anew, from the times since its start that its messages carry.

After a start the time since it is short: no longer than the time since the last message before it. A
message that was merely overtaken on its way tells a time that fell too, but hardly, and one that counts on
from before the start can still come after it. A uint32 of milliseconds wraps after 49.7 days, which is no
start.
"""

from __future__ import annotations

#: How far messages may overtake each other or be held up, in seconds.
REORDERING = 3.0
#: For so long after a start a message from before it may still come.
LATE = 10.0
_WRAP = 4294967.296


class RebootDetector:
    """Follows `time_boot_ms` of one component."""

    def __init__(self) -> None:
        self.reboots = 0
        self._last: float | None = None
        self._heard_at = 0.0
        self._rebooted_at: float | None = None

    @property
    def booted_at(self) -> float | None:
        """When it started, as our clock tells it, at the latest."""
        return None if self._last is None else self._heard_at - self._last

    def observe(self, time_boot_ms: int, now: float) -> bool:
        """Take in the time of a message; True if it shows that the component started anew."""
        since_boot = time_boot_ms / 1000
        if self._last is None:
            self._accept(since_boot, now)
            return False
        expected = self._last + (now - self._heard_at)
        if since_boot >= self._last:
            if not self._is_late(since_boot, expected, now):
                self._accept(since_boot, now)
            return False
        if self._last - since_boot <= REORDERING and now - self._heard_at <= REORDERING:
            return False
        wrapped = abs(since_boot + _WRAP - expected) <= LATE
        self._accept(since_boot, now)
        if not wrapped:
            self.reboots += 1
            self._rebooted_at = now
        return not wrapped

    def _is_late(self, since_boot: float, expected: float, now: float) -> bool:
        recent = self._rebooted_at is not None and now - self._rebooted_at < LATE
        return recent and since_boot > expected + REORDERING

    def _accept(self, since_boot: float, now: float) -> None:
        self._last, self._heard_at = since_boot, now
