"""A log on the timeline of a merged log."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from typing import Any

    from mavstack.logs.log import Log
    from mavstack.logs.message_table import MessageTable
    from mavstack.logs.records import LogText, ParameterChange
    from mavstack.logs.time_base import Clock


@dataclass(frozen=True, slots=True)
class LogOffset:
    """How a log was put on the timeline of a merged log.

    Attributes:
        label: Name of the log in the merged log: its format, with a number if several logs have it.
        offset_us: Microseconds that were added to its recorded times, as the median over the log.
        uncertainty_us: Standard deviation of the offset in microseconds, or None if it is not known.
        source: "reference", "GPS time", or "GPS positions".
        matches: Number of fixes in common with the reference, by which the offset was found or confirmed.
    """

    label: str
    offset_us: int
    uncertainty_us: int | None
    source: str
    matches: int

    def to_dict(self) -> dict[str, Any]:
        """Return the offset as values that JSON can hold."""
        return {
            "label": self.label,
            "offset_us": self.offset_us,
            "uncertainty_us": self.uncertainty_us,
            "source": self.source,
            "matches": self.matches,
        }

    def describe(self) -> str:
        """Return one line of text such as "tlog: +1.250 s ± 12 ms (GPS time, 300 common fixes)"."""
        if self.source == "reference":
            return f"{self.label}: reference"
        uncertainty = "" if self.uncertainty_us is None else f" ± {self.uncertainty_us / 1000:.0f} ms"
        matches = f", {self.matches} common fixes" if self.matches else ""
        return f"{self.label}: {self.offset_us / 1e6:+.3f} s{uncertainty} ({self.source}{matches})"


@dataclass(frozen=True, slots=True)
class MergedSource:
    """A log, and what puts its times on the timeline.

    Attributes:
        log: The log.
        clock: The clock of the log whose times are shifted.
        shift: Seconds that are added to the times of that clock.
        offset: The shift of the recorded times, for users.
    """

    log: Log
    clock: Clock
    shift: float
    offset: LogOffset

    def moved(self, entry: LogText | ParameterChange) -> np.datetime64:
        """Return the time of a text or of a change of a parameter on the timeline; NaT if it is not known.

        Args:
            entry: The text or change, of this log.
        """
        if not np.isnat(entry.time):
            return entry.time + np.timedelta64(self.offset.offset_us, "us")
        if self.clock != "boot" or entry.boot_us is None:
            return entry.time
        return np.datetime64(entry.boot_us + round(self.shift * 1e6), "us")

    def shifted(self, name: str, table: MessageTable) -> MessageTable:
        """Return rows of the log with their times on the timeline, as a copy.

        Args:
            name: Name of their table in the log.
            table: The rows.
        """
        times = self.log.times_of(name, table, self.clock) + self.shift
        known = ~np.isnan(times)
        stamps = np.full(len(times), np.datetime64("NaT", "us"))
        stamps[known] = np.rint(times[known] * 1e6).astype(np.int64).astype("M8[us]")
        copy = table.copy()
        copy["_time"] = stamps
        return copy

    def timeline_span(self) -> tuple[float, float] | None:
        """Return `span`, also of a log that only knows the time since boot, or None without times."""
        span = self.log.time_span
        if span is None or self.log.clock != "boot":
            return self.span()
        return span[0] + self.shift, span[1] + self.shift

    def span(self) -> tuple[float, float] | None:
        """Return the earliest and the latest time of the log on the timeline, in seconds."""
        span = self.log.time_span
        if span is None:
            return None
        shift = self.offset.offset_us / 1e6
        return span[0] + shift, span[1] + shift
