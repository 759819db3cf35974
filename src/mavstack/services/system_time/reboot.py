"""The reboot detector, from the boot times in a component's messages.

After a reboot the time since boot is short: no longer than the time since the last message before it. The
boot time of a reordered message falls too, but only a little, and a message from before the reboot may arrive
after it. A uint32 of milliseconds wraps after 49.7 days, which is no reboot.
"""

from __future__ import annotations

#: Seconds by which messages may be reordered or delayed.
MAX_REORDERING = 3.0
#: Seconds after a reboot in which messages from before the reboot may arrive.
MAX_DELAY = 10.0
_WRAP = 4294967.296


class RebootDetector:
    """The detector of reboots of one component."""

    def __init__(self) -> None:
        self.reboots = 0
        self._last: float | None = None
        self._received_at = 0.0
        self._rebooted_at: float | None = None

    @property
    def booted_at(self) -> float | None:
        """The latest possible boot time, Unix seconds."""
        return None if self._last is None else self._received_at - self._last

    def observe(self, time_boot_ms: int, now: float) -> bool:
        """Add the boot time of a message; returns True if it shows a reboot."""
        since_boot = time_boot_ms / 1000
        if self._last is None:
            self._accept(since_boot, now)
            return False
        expected = self._last + (now - self._received_at)
        if since_boot >= self._last:
            if not self._is_late(since_boot, expected, now):
                self._accept(since_boot, now)
            return False
        if self._last - since_boot <= MAX_REORDERING and now - self._received_at <= MAX_REORDERING:
            return False
        wrapped = abs(since_boot + _WRAP - expected) <= MAX_DELAY
        self._accept(since_boot, now)
        if not wrapped:
            self.reboots += 1
            self._rebooted_at = now
        return not wrapped

    def _is_late(self, since_boot: float, expected: float, now: float) -> bool:
        recent = self._rebooted_at is not None and now - self._rebooted_at < MAX_DELAY
        return recent and since_boot > expected + MAX_REORDERING

    def _accept(self, since_boot: float, now: float) -> None:
        self._last, self._received_at = since_boot, now
