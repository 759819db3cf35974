"""The download of a log.

    read the entry ──► request a window ──► chunks … ──► request missing chunks, or the next window
                             │                 └── complete ──► read the entry again ──► content
                             └── timeout ──► request again, with longer timeouts ──► LogTimeout

Autopilots serve one request at a time: ArduPilot ignores a request that arrives while it still sends, PX4
drops the old one. So there is one outstanding request, for one window, and the next follows when its last
chunk was received or nothing arrived for a while. Windows grow while nearly all of their chunks arrive, and
shrink when a radio's queue overflows. Missing chunks are requested after the end was reached, in as many
rounds as necessary; those closer together than the chunks of one round trip are requested together.

PX4 sends a log only after it was listed, so the entry is read first. It is read again at the end to see
whether the id still means the same log: ids move when old logs are removed. Of a log that is being written,
the result is at least its content at the start of the download; `verify_unchanged` ensures that it belongs to
one log. LOG_REQUEST_END is sent in every case.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mavstack.dialects import common
from mavstack.errors import LogTimeout, RemoteDenied, RemoteProtocolError
from mavstack.services.log.collector import Collector
from mavstack.services.log.entry import CHUNK, LogEntry
from mavstack.services.log.listing import ListLogs, LogOperation, ReadLogEntry
from mavstack.services.log.verify_unchanged import VerifyUnchanged
from mavstack.services.procedure import Procedure
from mavstack.services.timing import RoundTrip

if TYPE_CHECKING:
    from collections.abc import Generator

    from mavstack.services.operation import Operation
    from mavstack.wire import Packet

#: Window sizes: the number of chunks in one request.
INITIAL_WINDOW, MIN_WINDOW, MAX_WINDOW = 64, 16, 11_650
#: After a window was too large: the number of good windows before a larger one is tried.
WINDOWS_BEFORE_GROWTH = 16
#: The share of a window that must arrive for the next window to be larger, and the share for a window of the
#: same size. Shares are relative to the share of the window's first chunks, because an overflowing queue
#: drops the last chunks, but a bad link any. If nothing of the window's end arrived, the next window is as
#: large as the part that arrived.
GOOD, FAIR = 0.95, 0.75
#: The number of consecutive timeouts after which the download fails.
ATTEMPTS = 16
#: The number of bytes by which a log that is being written may exceed twice its listed size.
MAX_GROWTH = 1 << 20
#: The number of timeouts after which the log is listed again, and after which other transfers are ended too.
LIST_AFTER, UNBLOCK_AFTER = 3, 5
#: The number of timeouts that mean the end of the log, if the received data ends with a full chunk.
TIMEOUTS_AT_END = 3


class DownloadLog(Procedure[bytes]):
    """The download of one log; the result is its content."""

    timeout_error = LogTimeout
    min_rate = 32.0

    def __init__(
        self, log: LogEntry | int, *, max_size: int | None = None, timeout: float | None = None
    ) -> None:
        number = log if isinstance(log, int) else log.id
        super().__init__(f"downloading log {number} from", timeout=timeout, idle_timeout=3600.0)
        self._number = number
        self._listed = None if isinstance(log, int) else log
        self._max_size = max_size

    def steps(self) -> Generator[Operation[Any], Any, bytes]:
        """Read the entry, download the content, and read the entry again."""
        try:
            if self._listed is None:
                logs: tuple[LogEntry, ...] = yield ListLogs()
                self._listed = next((log for log in logs if log.id == self._number), None)
            before: LogEntry | None = self._listed and (yield ReadLogEntry(self._number))
            if before is None or self._listed is None:
                raise RemoteDenied(self.description, str(self.target), answer="there is no such log")
            self._require(before.may_be(self._listed) or before.may_have_been(self._listed))
            transfer = _Transfer(before, self._max_size)
            content: bytes = yield transfer
            after: LogEntry | None = yield ReadLogEntry(self._number)
            if after is None or not after.may_be(before):
                self._require(after is not None and after.may_continue(before))
                same: bool = yield VerifyUnchanged(self._number, content, transfer.earliest)
                self._require(same)
            return content
        finally:
            _end(self)

    def _require(self, same: bool) -> None:
        if not same:
            raise RemoteProtocolError(
                self.description, str(self.target), answer="the id now belongs to another log"
            )


def _end(operation: Operation[Any]) -> None:
    to = operation.target
    operation.send(common.LogRequestEnd(target_system=to.system, target_component=to.component))


class _Transfer(LogOperation[bytes]):
    """The transfer of the chunks of one log."""

    def __init__(self, log: LogEntry, max_size: int | None) -> None:
        super().__init__(f"downloading the data of log {log.id} from", idle_timeout=60.0)
        self._max_size = 2 * log.size + MAX_GROWTH if max_size is None else max_size
        self._log = log
        self._collector = Collector(log.size)
        self._window = INITIAL_WINDOW
        self._slow_growth = False  # True after a window was too large
        self._good_windows = 0
        self._first = self._until = 0  # the requested range, in chunks
        self._frontier = 0  # the end of all requested ranges
        self._requested_at = self._received_at = 0.0
        self._new_in_range = self._new_in_head = 0
        self._last_new = -1
        self._stopped = False  # True if the answer to the last request ended with a short chunk
        self._timeouts = 0
        self._spacing = 0.0  # seconds between chunks, smoothed
        self._round_trip = RoundTrip(initial=1.0, minimum=0.15, maximum=4.0)

    @property
    def earliest(self) -> list[int]:
        """The chunks that arrived first."""
        return self._collector.earliest

    def start(self, now: float) -> None:
        self._request(now)

    def receive(self, packet: Packet, now: float) -> None:
        match packet.message:
            case common.LogData(id=self._log.id, ofs=offset, count=count) as message:
                chunk = offset // CHUNK
                if offset % CHUNK == 0 and count <= CHUNK and chunk < self._frontier:
                    self._chunk(chunk, message.data[:count], now)

    def handle_timeout(self, now: float) -> None:
        self._timeouts += not self._stopped
        if self._collector.lacks_only_the_end and self._timeouts >= TIMEOUTS_AT_END:
            self.finish(self._collector.data())
            return
        if self._timeouts >= ATTEMPTS:
            self.time_out(now, "the vehicle stopped sending")
            return
        if self._timeouts >= UNBLOCK_AFTER:
            self.request_end()
        if self._timeouts >= LIST_AFTER:
            self.request_list(self._log.id, self._log.id)
        self._request(now)

    def _chunk(self, chunk: int, content: bytes, now: float) -> None:
        in_range = self._first <= chunk < self._until
        is_new = self._collector.add(chunk, content, requested=in_range and not self._stopped)
        if self._collector.contradicted:
            answer = "the received chunks contradict each other or the size of the log"
            self.fail(RemoteProtocolError(self.description, str(self.target), answer=answer))
            return
        if self._collector.size > self._max_size:
            allowed = f"the log has more than the {self._max_size} bytes allowed"
            answer = f"{allowed}, its entry says {self._log.size}; max_size= allows more"
            target, limit = str(self.target), "max_size"
            self.fail(RemoteProtocolError(self.description, target, answer=answer, limit=limit))
            return
        if is_new:
            self._measure(now, in_range)
            self._new_in_head += in_range and chunk < self._first + MIN_WINDOW
            self._last_new = max(self._last_new, chunk if in_range else 0)
            self._report(now)
        if self._collector.complete:
            self.finish(self._collector.data())
        elif in_range and len(content) < CHUNK and not self._collector.end_known:
            # The vehicle seems to have stopped early. Copies of this chunk must not count as new answers.
            self._stopped = True
            self.timer = now + self._round_trip.timeout()
        elif chunk == self._until - 1:
            self._request(now)
        elif is_new:
            self.timer = now + self._round_trip.timeout() + 4 * self._spacing

    def _report(self, now: float) -> None:
        self.report_progress(now)
        if self.parent is not None:
            size = self._collector.size
            self.parent.report_progress(now, min(self._collector.received, size), size)

    def _measure(self, now: float, in_range: bool) -> None:
        if self._new_in_range == 0 and self._timeouts == 0 and in_range:
            self._round_trip.add_sample(now - self._requested_at)
        elif self._new_in_range:
            self._spacing += (now - self._received_at - self._spacing) / 8
        self._received_at = now
        self._new_in_range += in_range
        self._timeouts = 0

    def _request(self, now: float) -> None:
        self._resize()
        spacing = max(self._spacing, 1e-5)
        merge = min(int((self._round_trip.smoothed or 0.0) / spacing), self._window)
        self._first, self._until = self._collector.missing_range(self._until, self._window, merge)
        self._frontier = max(self._frontier, self._until)
        self._new_in_range = self._new_in_head = 0
        self._last_new = self._first - 1
        self._stopped = False
        self._requested_at = now
        self.attempts += 1
        self.timer = now + self._round_trip.timeout(1 + self._timeouts)
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
        requested = self._until - self._first
        if requested < MIN_WINDOW or self._until < self._frontier or not self._new_in_range:
            return
        arrived, head = self._new_in_range / requested, self._new_in_head / MIN_WINDOW
        reached = self._last_new + 1 - self._first
        if reached <= requested - 2:
            self._window, self._good_windows = max(reached, MIN_WINDOW), 0
            self._slow_growth = self._slow_growth or reached < requested * 7 // 8
        elif arrived < FAIR and head >= GOOD:
            self._window, self._slow_growth = max(self._window // 2, MIN_WINDOW), True
        elif arrived >= GOOD * head and requested >= self._window:
            self._grow()

    def _grow(self) -> None:
        self._good_windows += 1
        if not self._slow_growth:
            self._window = min(self._window * 2, MAX_WINDOW)
        elif self._good_windows % WINDOWS_BEFORE_GROWTH == 0:
            self._window = min(self._window + self._window // 8, MAX_WINDOW)
