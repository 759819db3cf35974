"""A log on a vehicle, as LOG_ENTRY lists it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from typing import Self

    from mavstack.dialects import common

#: The number of bytes in a LOG_DATA.
CHUNK = 90
LAST_ID = 0xFFFF
MAX_UINT32 = 0xFFFFFFFF


@dataclass(frozen=True, slots=True)
class LogEntry:
    """An entry of the list of logs.

    Attributes:
        id: The log's id; it may move when old logs are removed.
        time_utc: The time of the last write, Unix seconds; 0 if unknown.
        size: The size in bytes, which may be approximate.
        is_last: True if no log has a higher id: it may be the one being written.
    """

    id: int
    time_utc: int
    size: int
    is_last: bool = field(default=False, compare=False)

    def may_be(self, earlier: LogEntry) -> bool:
        """Return whether this is the log of an earlier entry: a log may grow, but its time stays."""
        if self.time_utc != earlier.time_utc:
            return False
        return self.size == earlier.size or (self.size > earlier.size and self.time_utc > 0)

    def may_have_been(self, earlier: LogEntry) -> bool:
        """Return whether this may be the log of an earlier entry, written since: its time moves too."""
        return self.may_continue(earlier) and self.time_utc >= earlier.time_utc

    def may_continue(self, earlier: LogEntry) -> bool:
        """Return whether this may be a log that was written at an earlier entry; its content has to prove it.

        ArduPilot dates the log that it writes by its clock, and a closed one by its file: the time of a log
        that was closed in between may go back.
        """
        return earlier.is_last and self.size >= earlier.size

    @classmethod
    def read(cls, message: common.LogEntry) -> Self:
        """Return the entry in a message."""
        return cls(message.id, message.time_utc, message.size, message.id == message.last_log_num)
