"""The listing of logs.

Ids start at 0 or at 1, so a list is complete when as many ids arrived as there are logs. Missing entries in
the middle are requested by id; if the first or the last is missing, its id is unknown, and since a request
for a missing log has sent autopilots into endless lists, the whole list is requested again.
"""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.errors import LogTimeout
from mavstack.services.log.entry import LAST_ID, LogEntry
from mavstack.services.operation import Operation, Result
from mavstack.services.timing import RoundTrip

if TYPE_CHECKING:
    from mavstack.wire import Packet

#: The number of consecutive timeouts after which an operation fails.
ATTEMPTS = 6
#: How often the number of logs may change during a listing.
MAX_CHANGES = 64
#: The number of timeouts after which LOG_REQUEST_END is sent first: another client's transfer may block the
#: vehicle.
UNBLOCK_AFTER = 3


class LogOperation(Operation[Result]):
    """The base of operations on logs: their clean-up is LOG_REQUEST_END."""

    timeout_error = LogTimeout

    def request_list(self, first: int, last: int) -> None:
        """Send LOG_REQUEST_LIST for a range of ids."""
        to = self.target
        self.send(
            common.LogRequestList(
                target_system=to.system, target_component=to.component, start=first, end=last
            )
        )

    def request_end(self) -> None:
        """Send LOG_REQUEST_END, so that the vehicle resumes logging."""
        to = self.target
        self.send(common.LogRequestEnd(target_system=to.system, target_component=to.component))

    def clean_up(self, now: float) -> None:
        self.request_end()


class ListLogs(LogOperation[tuple[LogEntry, ...]]):
    """The listing of all logs, by ascending id."""

    def __init__(self, *, timeout: float | None = None) -> None:
        super().__init__("listing the logs of", timeout=timeout, idle_timeout=40.0)
        self._total: int | None = None
        self._found: dict[int, LogEntry] = {}
        self._changes = 0
        self._requested_until = LAST_ID
        self._timeouts = 0
        self._round_trip = RoundTrip(initial=1.0, minimum=0.2, maximum=2.0)

    def start(self, now: float) -> None:
        self._request(0, LAST_ID, now)

    def receive(self, packet: Packet, now: float) -> None:
        match packet.message:
            case common.LogEntry(num_logs=0):
                self._end(())
            case common.LogEntry() as entry:
                self._entry(entry, now)

    def handle_timeout(self, now: float) -> None:
        self._timeouts += 1
        if self._timeouts >= ATTEMPTS:
            self.time_out(now)
            return
        if self._timeouts >= UNBLOCK_AFTER:
            self.request_end()
        self._request_missing(now)

    def _entry(self, message: common.LogEntry, now: float) -> None:
        if self._total != message.num_logs:
            self._total = message.num_logs
            self._found.clear()
            self._changes += 1
            if self._changes > MAX_CHANGES:
                self.time_out(now, "the list kept changing")
                return
        is_new = message.id not in self._found
        self._found[message.id] = LogEntry.read(message)
        if not is_new:
            return
        if self.attempts == 1 and len(self._found) == 1:
            self._round_trip.add_sample(now - self._requested_at)
        self._timeouts = 0
        self.report_progress(now, len(self._found), self._total)
        self.timer = now + self._round_trip.timeout(2)
        if len(self._found) >= self._total:
            self._end(tuple(self._found[number] for number in sorted(self._found)))
        elif message.id >= min(message.last_log_num, self._requested_until):
            self._request_missing(now)

    def _request_missing(self, now: float) -> None:
        ids = sorted(self._found)
        missing = [(one + 1, other - 1) for one, other in pairwise(ids) if other > one + 1]
        if missing and self._timeouts < UNBLOCK_AFTER:
            self._request(*missing[0], now)
        else:
            self._request(0, LAST_ID, now)

    def _request(self, first: int, last: int, now: float) -> None:
        self.attempts += 1
        self._requested_until, self._requested_at = last, now
        self.timer = now + self._round_trip.timeout(1 + self._timeouts)
        self.request_list(first, last)

    def _end(self, entries: tuple[LogEntry, ...]) -> None:
        if self.parent is None:
            self.request_end()
        self.finish(entries)


class ReadLogEntry(LogOperation[LogEntry | None]):
    """The entry of one log; None if there are no logs."""

    def __init__(self, number: int) -> None:
        super().__init__(f"reading the entry of log {number} of", idle_timeout=30.0)
        self._number = number
        self._round_trip = RoundTrip(initial=1.0, maximum=2.0)

    def start(self, now: float) -> None:
        self._request(now)

    def receive(self, packet: Packet, now: float) -> None:
        match packet.message:
            case common.LogEntry(num_logs=0):
                self.finish(None)
            case common.LogEntry(id=self._number) as entry:
                self.finish(LogEntry.read(entry))

    def handle_timeout(self, now: float) -> None:
        if self.attempts >= ATTEMPTS:
            self.time_out(now)
            return
        if self.attempts >= UNBLOCK_AFTER:
            self.request_end()
        self._request(now)

    def _request(self, now: float) -> None:
        self.attempts += 1
        self.timer = now + self._round_trip.timeout(self.attempts)
        self.request_list(self._number, self._number)
