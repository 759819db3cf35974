"""Fetching a log.

    look up the entry ──► ask for a window ──► chunks … ──► ask for what is missing, or for the next window
                                │                 └── all there ──► look up the entry again ──► the log
                                └── silence ──► ask again, later each time ──► LogTimeout

Autopilots serve one request at a time: ArduPilot drops one that comes while it still sends, PX4 drops the
old one. So there is one request on its way, for as much as seems wise, and the next follows when its last
chunk was heard or nothing came for a while. Windows grow while nearly all of them arrives, and shrink when
a radio's queue is overrun. Gaps are filled after the end was reached, in as many rounds as it takes; those
that lie closer together than what comes in one round trip are asked for in one.

PX4 sends a log only after it was listed, hence the look-up before. The one after shows whether the id still
means the same log: ids move when old logs are removed. Of the log that is being written comes what there was
when the fetching began, or more; `proof` sees to it that it is of one log. LOG_REQUEST_END ends all of it,
however it ends.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mavstack.dialects import common
from mavstack.errors import LogTimeout, RemoteDenied, RemoteProtocolError
from mavstack.services.log.collector import Collector
from mavstack.services.log.entry import CHUNK, LogEntry
from mavstack.services.log.listing import ListLogs, LogOperation, LookUpLog
from mavstack.services.log.proof import StillTheSame
from mavstack.services.operation import Operation, Procedure
from mavstack.services.timing import RoundTrip

if TYPE_CHECKING:
    from collections.abc import Generator

    from mavstack.wire import Packet

#: Windows, in chunks: the first, the least and the most.
FIRST_WINDOW, LEAST_WINDOW, MOST_WINDOW = 64, 16, 11_650
#: After a window was too large, so many good ones must come before a larger one is tried.
CAUTION = 16
#: What of a window arrived, in proportion to what of its first chunks arrived, for the next to be larger, and
#: to be not smaller: a queue that is overrun drops what comes last, a bad link anything. If nothing of
#: its end arrived, the next is as large as what did.
GOOD, FAIR = 0.95, 0.75
#: How often in a row nothing may come.
ATTEMPTS = 16
#: After so many silences the log is listed again, and from then on other transfers ended first.
LIST_AFTER, UNBLOCK_AFTER = 3, 5
#: So many silences at a size that fits say that nothing follows.
SILENT_END = 3


class DownloadLog(Procedure[bytes]):
    """A log's content."""

    timeout_error = LogTimeout

    def __init__(self, log: LogEntry | int, *, timeout: float | None = None) -> None:
        number = log if isinstance(log, int) else log.id
        super().__init__(f"downloading log {number} from", timeout=timeout, idle_timeout=3600.0)
        self._number = number
        self._listed = None if isinstance(log, int) else log

    def steps(self) -> Generator[Operation[Any], Any, bytes]:
        """Before, the log, and after."""
        try:
            if self._listed is None:
                logs: tuple[LogEntry, ...] = yield ListLogs()
                self._listed = next((log for log in logs if log.id == self._number), None)
            before: LogEntry | None = self._listed and (yield LookUpLog(self._number))
            if before is None or self._listed is None:
                raise RemoteDenied(self.description, str(self.target), answer="it has no such log")
            self._require(before.may_be(self._listed) or before.may_have_been(self._listed))
            transfer = _Transfer(before)
            content: bytes = yield transfer
            after: LogEntry | None = yield LookUpLog(self._number)
            if after is None or not after.may_be(before):
                self._require(after is not None and after.may_have_been(before))
                same: bool = yield StillTheSame(self._number, content, transfer.earliest)
                self._require(same)
            return content
        finally:
            _end(self)

    def _require(self, same: bool) -> None:
        if not same:
            raise RemoteProtocolError(
                self.description, str(self.target), answer="the id stands for another log than before"
            )


def _end(operation: Operation[Any]) -> None:
    to = operation.target
    operation.send(common.LogRequestEnd(target_system=to.system, target_component=to.component))


class _Transfer(LogOperation[bytes]):
    """The chunks of one log."""

    def __init__(self, log: LogEntry) -> None:
        super().__init__(f"downloading the data of log {log.id} from", idle_timeout=60.0)
        self._log = log
        self._collector = Collector(log.size)
        self._window = FIRST_WINDOW
        self._careful = False  # a window was too large
        self._good_windows = 0
        self._first = self._until = 0  # the range asked for, in chunks
        self._frontier = 0  # where the ranges asked for so far ended
        self._asked_at = self._heard_at = 0.0
        self._new_in_range = self._new_in_head = 0
        self._last_new = -1
        self._stopped = False  # the answer to the last request ended in a short chunk
        self._silences = 0
        self._spacing = 0.0  # between chunks, smoothed
        self._round_trip = RoundTrip(initial=1.0, least=0.15, most=4.0)

    @property
    def earliest(self) -> list[int]:
        """The chunks that came first."""
        return self._collector.earliest

    def start(self, now: float) -> None:
        self._ask(now)

    def receive(self, packet: Packet, now: float) -> None:
        match packet.message:
            case common.LogData(id=self._log.id, ofs=offset, count=count) as message:
                chunk = offset // CHUNK
                if offset % CHUNK == 0 and count <= CHUNK and chunk < self._frontier:
                    self._chunk(chunk, message.data[:count], now)

    def handle_timeout(self, now: float) -> None:
        self._silences += not self._stopped
        if self._collector.lacks_only_the_end and self._silences >= SILENT_END:
            self.finish(self._collector.data())
            return
        if self._silences >= ATTEMPTS:
            self.time_out(now, "it stopped sending")
            return
        if self._silences >= UNBLOCK_AFTER:
            self.request_end()
        if self._silences >= LIST_AFTER:
            self.request_list(self._log.id, self._log.id)
        self._ask(now)

    def _chunk(self, chunk: int, content: bytes, now: float) -> None:
        in_range = self._first <= chunk < self._until
        news = self._collector.add(chunk, content, asked=in_range and not self._stopped)
        if self._collector.contradicted:
            answer = "it contradicts itself, or ends before its end"
            self.fail(RemoteProtocolError(self.description, str(self.target), answer=answer))
            return
        if news:
            self._measure(now, in_range)
            self._new_in_head += in_range and chunk < self._first + LEAST_WINDOW
            self._last_new = max(self._last_new, chunk if in_range else 0)
            self._moved(now)
        if self._collector.complete:
            self.finish(self._collector.data())
        elif in_range and len(content) < CHUNK and not self._collector.end_known:
            # It stopped early, or so it seems. Copies of this chunk must not pass for new answers.
            self._stopped = True
            self.timer = now + self._round_trip.timeout()
        elif chunk == self._until - 1:
            self._ask(now)
        elif news:
            self.timer = now + self._round_trip.timeout() + 4 * self._spacing

    def _moved(self, now: float) -> None:
        self.report_progress(now)
        if self.parent is not None:
            size = self._collector.size
            self.parent.report_progress(now, min(self._collector.received, size), size)

    def _measure(self, now: float, in_range: bool) -> None:
        if self._new_in_range == 0 and self._silences == 0 and in_range:
            self._round_trip.measured(now - self._asked_at)
        elif self._new_in_range:
            self._spacing += (now - self._heard_at - self._spacing) / 8
        self._heard_at = now
        self._new_in_range += in_range
        self._silences = 0

    def _ask(self, now: float) -> None:
        self._resize()
        spacing = max(self._spacing, 1e-5)
        merge = min(int((self._round_trip.smoothed or 0.0) / spacing), self._window)
        self._first, self._until = self._collector.missing_range(self._until, self._window, merge)
        self._frontier = max(self._frontier, self._until)
        self._new_in_range = self._new_in_head = 0
        self._last_new = self._first - 1
        self._stopped = False
        self._asked_at = now
        self.attempts += 1
        self.timer = now + self._round_trip.timeout(1 + self._silences)
        self.send(
            common.LogRequestData(
                target_system=self.target.system,
                target_component=self.target.component,
                id=self._log.id,
                ofs=self._first * CHUNK,
                count=(self._until - self._first) * CHUNK,
            )
        )

    def _resize(self) -> None:
        asked = self._until - self._first
        if asked < LEAST_WINDOW or self._until < self._frontier or not self._new_in_range:
            return
        arrived, head = self._new_in_range / asked, self._new_in_head / LEAST_WINDOW
        reached = self._last_new + 1 - self._first
        if reached <= asked - 2:
            self._window, self._good_windows = max(reached, LEAST_WINDOW), 0
            self._careful = self._careful or reached < asked * 7 // 8
        elif arrived < FAIR and head >= GOOD:
            self._window, self._careful = max(self._window // 2, LEAST_WINDOW), True
        elif arrived >= GOOD * head and asked >= self._window:
            self._grow()

    def _grow(self) -> None:
        self._good_windows += 1
        if not self._careful:
            self._window = min(self._window * 2, MOST_WINDOW)
        elif self._good_windows % CAUTION == 0:
            self._window = min(self._window + self._window // 8, MOST_WINDOW)
