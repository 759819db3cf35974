"""The fast path for messages with a boot time (see the package): most only continue the last one.

A message whose boot time does not fit (a reboot, another sender with that address) never passes the filter,
nor does the first one of each `INTERVAL`, so that the boot tracker sees every sender often enough.
"""

from __future__ import annotations

INTERVAL = 0.1
#: Seconds by which a boot time may deviate; far less than `boot_tracker.SAME_BOOT`.
TOLERANCE = 1.0


class BootTimeFilter:
    """The boot time that the next messages of one sender will have if it does not reboot."""

    __slots__ = ("_expires_at", "_offset", "seen_at")

    def __init__(self, time_boot_ms: int, now: float) -> None:
        self.seen_at = now
        self._offset = time_boot_ms / 1000 - now
        self._expires_at = now + INTERVAL

    def is_expected(self, time_boot_ms: int, now: float) -> bool:
        """Return whether a message only continues the last one, and remember its arrival if so."""
        if now >= self._expires_at or not -TOLERANCE < time_boot_ms / 1000 - now - self._offset < TOLERANCE:
            return False
        self.seen_at = now
        return True
