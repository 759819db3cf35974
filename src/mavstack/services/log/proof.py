"""Whether a log that grew while it was fetched is still the one that was fetched.

A log's time is that of its last write, so the log being written changes both its size and its time, and so
does an id that came to mean another log. Its content tells them apart. If the log was replaced on the way,
what came before that moment is of the old one; so the chunks that came first are read again, and differ from
the new log's. They are read from their second byte on, so that a late answer to the fetching is not taken
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


class StillTheSame(LogOperation[bool]):
    """Reads chunks of a log again; the result is whether they hold what they held."""

    def __init__(self, number: int, content: bytes, chunks: Sequence[int]) -> None:
        super().__init__(f"verifying log {number} of", idle_timeout=60.0)
        self._number = number
        self._content = content
        self._places = [*chunks] or [0]
        self._tries = 0
        self._asked_at = 0.0
        self._round_trip = RoundTrip(initial=1.0, least=0.2, most=3.0)

    def start(self, now: float) -> None:
        self._ask(now)

    def receive(self, packet: Packet, now: float) -> None:
        offset = self._offset
        match packet.message:
            case common.LogData(id=self._number, ofs=told, count=count, data=data) if told == offset:
                if not data[: min(count, CHUNK)].startswith(self._content[offset : offset + SIZE]):
                    self.finish(False)
                    return
                self._next(now)

    def handle_timeout(self, now: float) -> None:
        if self._tries >= ATTEMPTS:
            self.time_out(now)
            return
        self.request_end()
        self.request_list(self._number, self._number)
        self._ask(now)

    @property
    def _offset(self) -> int:
        return self._places[0] * CHUNK + 1

    def _next(self, now: float) -> None:
        if self._tries == 1:
            self._round_trip.measured(now - self._asked_at)
        del self._places[0]
        self._tries = 0
        self.report_progress(now)
        if self._places:
            self._ask(now)
        else:
            self.finish(True)

    def _ask(self, now: float) -> None:
        self._tries += 1
        self.attempts += 1
        self._asked_at = now
        self.timer = now + self._round_trip.timeout(self._tries)
        self.send(
            common.LogRequestData(
                target_system=self.target.system,
                target_component=self.target.component,
                id=self._number,
                ofs=self._offset,
                count=SIZE,
            )
        )
