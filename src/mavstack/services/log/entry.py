"""A log on a vehicle, as LOG_ENTRY lists it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from typing import Self

    from mavstack.dialects import common

#: What a LOG_DATA carries at most.
CHUNK = 90
LAST_ID = 0xFFFF
MOST = 0xFFFFFFFF


@dataclass(frozen=True, slots=True)
class LogEntry:
    """A log's id, its time (Unix seconds, 0 if not known), and its size, which may be approximate.

    `is_last` says that no log has a higher id: it may be the one being written.
    """

    id: int
    time_utc: int
    size: int
    is_last: bool = field(default=False, compare=False)

    def may_be(self, earlier: LogEntry) -> bool:
        """Whether this is what `earlier` was: a log may grow, but begins once."""
        if self.time_utc != earlier.time_utc:
            return False
        return self.size == earlier.size or (self.size > earlier.size and self.time_utc > 0)

    def may_have_been(self, earlier: LogEntry) -> bool:
        """Whether this may be `earlier`, written on: its time, being that of the last write, moved too."""
        both_last = self.is_last and earlier.is_last
        return both_last and self.size > earlier.size and self.time_utc >= earlier.time_utc

    @classmethod
    def read(cls, message: common.LogEntry) -> Self:
        """What a message says."""
        return cls(message.id, message.time_utc, message.size, message.id == message.last_log_num)
