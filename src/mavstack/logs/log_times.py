"""The times of a log: the time of each row by any of its clocks, and the span of all of them."""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING

import numpy as np

from mavstack.errors import InvalidArgumentError, LogError
from mavstack.logs.log_tables import LogTables
from mavstack.logs.time_base import CLOCKS, unix_seconds

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from mavstack.logs.message_table import MessageTable
    from mavstack.logs.time_base import Clock, ClockChoice, TimeBase


class LogTimes(LogTables):
    """A log with times; a format implements `time_span`, `boot_times` and `utc_times` where it has them."""

    @property
    @abstractmethod
    def time_base(self) -> TimeBase:
        """The best clock of the log, and its offset to the time since boot."""

    @property
    def time_span(self) -> tuple[float, float] | None:
        """Earliest and latest time in seconds on the log's own time base, or None without times."""
        return None

    @property
    def clock(self) -> Clock:
        """The kind of the time base: "utc", "received" or "boot"."""
        return self.time_base.kind

    def boot_times(self, name: str, table: MessageTable) -> NDArray[np.float64] | None:
        """Return the time since boot in seconds of each row of (a part of) a table.

        Args:
            name: Name of the table.
            table: The rows.

        Returns:
            The times, NaN where not known; None if the table has none.
        """
        return None

    def utc_times(self, name: str, table: MessageTable) -> NDArray[np.float64] | None:
        """Return the UTC in seconds since 1970 of each row of (a part of) a table; see `boot_times`."""
        return None if self.clock == "boot" else unix_seconds(table["_time"])

    @property
    def start(self) -> np.datetime64 | None:
        """Earliest time in UTC, or None if it is not known."""
        return self._utc(0)

    @property
    def end(self) -> np.datetime64 | None:
        """Latest time in UTC, or None if it is not known."""
        return self._utc(1)

    def _utc(self, index: int) -> np.datetime64 | None:
        span = self.time_span
        if span is None or self.clock == "boot":
            return None
        microseconds = round(span[index] * 1e6)
        # A damaged record may have any time.
        return np.datetime64(microseconds, "us") if abs(microseconds) < 1 << 63 else None

    @property
    def duration(self) -> float:
        """Seconds from the earliest to the latest recorded time; 0 without times."""
        first, last = self.time_span or (0.0, 0.0)
        return last - first

    def times(self, name: str, base: ClockChoice = "auto") -> NDArray[np.float64]:
        """Return the time of each row of a table in seconds.

        Args:
            name: Name of the table.
            base: "utc", "received": seconds since 1970; "boot": since boot; "auto": those of `time_base`.

        Returns:
            The times; NaN where the time is not known.

        Raises:
            UnknownMessageError: The log has no table of that name.
            InvalidArgumentError: `base` is none of these.
            LogError: The log does not hold that clock for the table.
        """
        return self.times_of(name, self[name], base)

    def times_of(self, name: str, table: MessageTable, base: ClockChoice = "auto") -> NDArray[np.float64]:
        """Return the time of each row of (a part of) a table in seconds; see `times`."""
        if base not in CLOCKS:
            raise InvalidArgumentError(f"base must be one of {', '.join(CLOCKS)}, got {base!r}")
        wanted = self.clock if base == "auto" else base
        times = None
        if wanted == "boot":
            times = self.boot_times(name, table)
        elif wanted == "utc":
            times = self.utc_times(name, table)
        elif self.clock == "received":
            times = unix_seconds(table["_time"])
        if times is None:
            raise LogError(f"{self.path}: the {wanted} time of {name} is not known")
        return times

    def seconds_from_start(self, name: str, table: MessageTable) -> NDArray[np.float64]:
        """Return the times of rows in seconds from the beginning of the log."""
        return self.times_of(name, table, "auto") - (self.time_span or (0.0,))[0]
