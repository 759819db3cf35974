"""The wall clock of a vehicle's times: Unix nanoseconds for the milliseconds since its boot.

With an estimate of TIMESYNC the vehicle's clock is known. Without it the shortest delay counts that a message
has had lately: a message arrives late, never early.
"""

from __future__ import annotations

from typing import Final

#: Microseconds from this value on (in the year 2001) are Unix time; smaller ones are time since boot.
MIN_UNIX_MICROSECONDS: Final = 10**15
#: Maximum difference in nanoseconds between the time in a message and its arrival; a larger difference means
#: another boot, or a wrong clock.
MAX_AGE: Final = 10_000_000_000
#: Maximum growth of the clock offset per second, because clocks drift.
DRIFT: Final = 0.0005


class BootClock:
    """The clock of one vehicle; times in nanoseconds."""

    def __init__(self) -> None:
        #: The vehicle's clock minus the local clock in nanoseconds, from TIMESYNC; None: not known.
        self.timesync_offset: int | None = None
        self._delay: int | None = None
        self._updated = 0

    def from_microseconds(self, time: int, arrival: int) -> int:
        """Return the Unix time of a message by its `time_usec`, which is Unix time or the time since boot."""
        if time >= MIN_UNIX_MICROSECONDS:
            return self._plausible(time * 1000, arrival)
        return self.from_boot(time * 1000, arrival)

    def from_boot(self, boot: int, arrival: int) -> int:
        """Return the Unix time of a time since boot.

        Args:
            boot: The time since boot; 0: the message has none.
            arrival: The Unix time of arrival.

        Returns:
            The time, never later than the arrival.
        """
        if not boot:
            return arrival
        if self.timesync_offset is not None:
            found = boot - self.timesync_offset
            if abs(found - arrival) < MAX_AGE:
                return min(found, arrival)
        # Each stamp of each message comes here: one function, without calls.
        delay = arrival - boot
        if self._delay is not None:
            known = self._delay + int((arrival - self._updated) * DRIFT)
            if 0 <= delay - known <= MAX_AGE:
                delay = known
        self._delay, self._updated = delay, arrival
        found = boot + delay
        return found if 0 <= arrival - found < MAX_AGE else arrival

    @staticmethod
    def _plausible(time: int, arrival: int) -> int:
        return time if 0 <= arrival - time < MAX_AGE else arrival
