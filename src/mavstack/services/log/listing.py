"""Asking which logs there are.

Ids start at 0 or at 1, so a list is whole when as many ids came as there are logs. What is missing in the
middle is asked for by its ids; if the first or the last is missing it is not known which, and asking for a
log that is not there has sent autopilots into endless lists: then all are asked for again.
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

#: How often in a row nothing may come.
ATTEMPTS = 8
#: So often the number of logs may change while they are listed.
MOST_CHANGES = 64
#: From this silence on, what another client left unfinished is ended first: it may be why nothing comes.
UNBLOCK_AFTER = 3


class LogOperation(Operation[Result]):
    """What all operations on logs share: they end what they began."""

    timeout_error = LogTimeout

    def request_list(self, first: int, last: int) -> None:
        """Ask for a part of the list."""
        to = self.target
        self.send(
            common.LogRequestList(
                target_system=to.system, target_component=to.component, start=first, end=last
            )
        )

    def request_end(self) -> None:
        """Tell the target that nothing more is wanted, so that it goes on logging."""
        to = self.target
        self.send(common.LogRequestEnd(target_system=to.system, target_component=to.component))

    def clean_up(self, now: float) -> None:
        self.request_end()


class ListLogs(LogOperation[tuple[LogEntry, ...]]):
    """The list of all logs, by their ids."""

    def __init__(self, *, timeout: float | None = None) -> None:
        super().__init__("listing the logs of", timeout=timeout, idle_timeout=40.0)
        self._total: int | None = None
        self._found: dict[int, LogEntry] = {}
        self._changes = 0
        self._asked_until = LAST_ID
        self._silences = 0
        self._round_trip = RoundTrip(initial=1.0, least=0.2, most=4.0)

    def start(self, now: float) -> None:
        self._ask(0, LAST_ID, now)

    def receive(self, packet: Packet, now: float) -> None:
        match packet.message:
            case common.LogEntry(num_logs=0):
                self._end(())
            case common.LogEntry() as entry:
                self._entry(entry, now)

    def handle_timeout(self, now: float) -> None:
        self._silences += 1
        if self._silences >= ATTEMPTS:
            self.time_out(now)
            return
        if self._silences >= UNBLOCK_AFTER:
            self.request_end()
        self._ask_missing(now)

    def _entry(self, message: common.LogEntry, now: float) -> None:
        if self._total != message.num_logs:
            self._total = message.num_logs
            self._found.clear()
            self._changes += 1
            if self._changes > MOST_CHANGES:
                self.time_out(now, "the list kept changing")
                return
        news = message.id not in self._found
        self._found[message.id] = LogEntry.read(message)
        if not news:
            return
        if self.attempts == 1 and len(self._found) == 1:
            self._round_trip.measured(now - self._asked_at)
        self._silences = 0
        self.report_progress(now, len(self._found), self._total)
        self.timer = now + self._round_trip.timeout(2)
        if len(self._found) >= self._total:
            self._end(tuple(self._found[number] for number in sorted(self._found)))
        elif message.id >= min(message.last_log_num, self._asked_until):
            self._ask_missing(now)

    def _ask_missing(self, now: float) -> None:
        ids = sorted(self._found)
        gaps = [(one + 1, other - 1) for one, other in pairwise(ids) if other > one + 1]
        if gaps and self._silences < UNBLOCK_AFTER:
            self._ask(*gaps[0], now)
        else:
            self._ask(0, LAST_ID, now)

    def _ask(self, first: int, last: int, now: float) -> None:
        self.attempts += 1
        self._asked_until, self._asked_at = last, now
        self.timer = now + self._round_trip.timeout(1 + self._silences)
        self.request_list(first, last)

    def _end(self, entries: tuple[LogEntry, ...]) -> None:
        if self.parent is None:
            self.request_end()
        self.finish(entries)


class LookUpLog(LogOperation[LogEntry | None]):
    """What the list says of one log; None if there are no logs."""

    def __init__(self, number: int) -> None:
        super().__init__(f"reading the entry of log {number} of", idle_timeout=30.0)
        self._number = number
        self._round_trip = RoundTrip(initial=1.0, most=4.0)

    def start(self, now: float) -> None:
        self._ask(now)

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
        self._ask(now)

    def _ask(self, now: float) -> None:
        self.attempts += 1
        self.timer = now + self._round_trip.timeout(self.attempts)
        self.request_list(self._number, self._number)
