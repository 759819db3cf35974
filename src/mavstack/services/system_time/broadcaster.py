"""The sender of SYSTEM_TIME."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.addressing import BROADCAST, Address
from mavstack.services.stream_sender import StreamSender

if TYPE_CHECKING:
    from collections.abc import Callable


class SystemTimeBroadcaster(StreamSender):
    """The sender of SYSTEM_TIME at `rate` hertz; `unix_time` returns None while the clock is not set."""

    def __init__(
        self,
        local: Address,
        started_at: float,
        *,
        rate: float = 1.0,
        unix_time: Callable[[float], float | None] = lambda now: now,
    ) -> None:
        super().__init__(local, BROADCAST, rate)
        self._started_at = started_at
        self._unix_time = unix_time
        self.start(started_at)

    def current_message(self, now: float) -> common.SystemTime:
        unix = self._unix_time(now)
        return common.SystemTime(
            time_unix_usec=0 if unix is None else max(round(unix * 1e6), 0),
            time_boot_ms=round((now - self._started_at) * 1000) % (1 << 32),
        )
