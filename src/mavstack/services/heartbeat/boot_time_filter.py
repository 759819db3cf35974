"""The fast path for messages with a boot time (see the package): most only continue the last one.

A message whose boot time does not fit (a reboot, another sender with that address) never passes the filter,
nor does the first one of each `INTERVAL`, so that the boot tracker sees every sender often enough.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from mavstack.services.addressing import Address

#: System id, component id and channel of a sender.
Key: TypeAlias = tuple[int, int, str]

INTERVAL = 0.1
#: Seconds by which a boot time may deviate from the expected one; far less than `boot_tracker.SAME_BOOT`.
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


class BootTimeFilters:
    """The filters of all senders that send boot times.

    Attributes:
        on_change: Called with a sender, and the boot time and time of its new filter, or None if it has no
            filter any more: another filter of the same packets follows this one.
        before_reading: Called before the times of the last messages are read.
        last_boot: Returns the boot time and the time of the last message of a sender that another filter let
            pass; None if there is no other filter.
    """

    def __init__(self) -> None:
        self._filters: dict[Key, BootTimeFilter] = {}
        self.on_change: Callable[[Key, tuple[int, float] | None], None] = lambda key, boot: None
        self.before_reading: Callable[[], None] = lambda: None
        self.last_boot: Callable[[Key], tuple[int, float] | None] = lambda key: None

    def is_expected(self, key: Key, time_boot_ms: int, now: float) -> bool:
        """Return whether a message of a sender only continues the last one."""
        known = self._filters.get(key)
        return known is not None and known.is_expected(time_boot_ms, now)

    def set(self, key: Key, time_boot_ms: int, now: float) -> None:
        """Expect the boot times that follow this one from a sender."""
        self._filters[key] = BootTimeFilter(time_boot_ms, now)
        self.on_change(key, (time_boot_ms, now))

    def remove(self, key: Key) -> None:
        """Expect no boot time from a sender. Idempotent."""
        if self._filters.pop(key, None) is not None:
            self.on_change(key, None)

    def remove_address(self, address: Address) -> None:
        """Expect no boot time from an address on any channel."""
        for key in [key for key in self._filters if key[:2] == address]:
            self.remove(key)

    def note_seen(self, key: Key, seen_at: float) -> None:
        """Record an expected message of a sender that another filter let pass."""
        known = self._filters.get(key)
        if known is not None:
            known.seen_at = max(known.seen_at, seen_at)

    def last_seen(self) -> Iterator[tuple[int, int, float]]:
        """Yield system id, component id, and the time of the last message, of each sender."""
        self.before_reading()
        for (system, component, _), known in self._filters.items():
            yield system, component, known.seen_at
