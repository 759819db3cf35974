"""The check that a log which grew during its download is still the same log.

A log's time is that of its last write, so the log being written changes both size and time, and so does an id
that moved to another log. The content tells them apart. If the log was replaced during the download, the
chunks received before belong to the old log; so the chunks that arrived first are read again, and differ in
the new log. They are read from their second byte on, so that a late answer to the download is not mistaken
for a new one.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.log.entry import CHUNK
from mavstack.services.log.listing import LogOperation
from mavstack.services.timing import RoundTrip

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.wire import Packet

ATTEMPTS = 8
SIZE = CHUNK - 1


class VerifyUnchanged(LogOperation[bool]):
    """The second read of some chunks of a log; the result is True if they are unchanged."""

    def __init__(self, number: int, content: bytes, chunks: Sequence[int]) -> None:
        super().__init__(f"verifying log {number} of", idle_timeout=60.0)
        self._number = number
        self._content = content
        self._chunks = [*chunks] or [0]
        self._attempts = 0
        self._requested_at = 0.0
        self._round_trip = RoundTrip(initial=1.0, minimum=0.2, maximum=3.0)

    def start(self, now: float) -> None:
        self._request(now)

    def receive(self, packet: Packet, now: float) -> None:
        offset = self._offset
        match packet.message:
            case common.LogData(id=self._number, ofs=received, count=count, data=data) if received == offset:
                if not data[: min(count, CHUNK)].startswith(self._content[offset : offset + SIZE]):
                    self.finish(False)
                    return
                self._next(now)

    def handle_timeout(self, now: float) -> None:
        if self._attempts >= ATTEMPTS:
            self.time_out(now)
            return
        self.request_end()
        self.request_list(self._number, self._number)
        self._request(now)

    @property
    def _offset(self) -> int:
        return self._chunks[0] * CHUNK + 1

    def _next(self, now: float) -> None:
        if self._attempts == 1:
            self._round_trip.add_sample(now - self._requested_at)
        del self._chunks[0]
        self._attempts = 0
        self.report_progress(now)
        if self._chunks:
            self._request(now)
        else:
            self.finish(True)

    def _request(self, now: float) -> None:
        self._attempts += 1
        self.attempts += 1
        self._requested_at = now
        self.timer = now + self._round_trip.timeout(self._attempts)
        self.send(
            common.LogRequestData(
                target_system=self.target.system,
                target_component=self.target.component,
                id=self._number,
                ofs=self._offset,
                count=SIZE,
            )
        )
