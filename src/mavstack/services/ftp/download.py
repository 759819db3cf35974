"""The transfer of a download: bursts, several concurrent reads, or single reads, whichever works best.

Missing data is kept as ranges; a received piece is stored by its offset, whichever request it answers. The
long missing range at the end is requested by bursts (see `bursts`), gaps by reads whose number follows from
their answers (see `send_window`); if bursts overflow a queue, the gaps wait for the last burst. Bursts are
replaced by reads if the server does not support them, never answers them, or sends too much data twice. Reads
are sent before a burst request: behind it their answers would find the queue full.

The announced size may be an estimate (virtual files) or outdated; the file ends where the server says EOF. A
file that becomes shorter than the part already read is an error.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from mavstack.errors import FileTimeout, RemoteProtocolError
from mavstack.services.ftp.bursts import MIN_NOVELTY, BurstTracker
from mavstack.services.ftp.exchange import BURST_SEQUENCES, denied
from mavstack.services.ftp.payload import MAX_DATA, SEQUENCES, FtpError, FtpPayload, Opcode
from mavstack.services.ftp.send_window import SendWindow
from mavstack.services.operation import Operation
from mavstack.services.service import earliest

if TYPE_CHECKING:
    from mavstack.services.ftp.exchange import ServerState
    from mavstack.services.ftp.partial_file import PartialFile
    from mavstack.wire import Packet

#: The smallest number of missing bytes inside the file for which a burst is requested.
MIN_BURST_GAP = 16 * MAX_DATA
#: The smallest number of missing bytes at the end of the file for which a burst is requested.
MIN_BURST_GAP_AT_END = 3 * MAX_DATA
#: The number of unanswered burst requests after which the server is taken to support no bursts.
BURST_ATTEMPTS = 3
#: PX4 may send the errno of an earlier failure in place of EOF.
_END_OF_FILE = frozenset({int(FtpError.EOF), int(FtpError.FILEEXISTS)})


@dataclass(slots=True)
class TransferCounts:
    """The number of requests and packets of a download."""

    reads: int = 0
    bursts: int = 0
    packets: int = 0
    duplicates: int = 0


class DownloadTransfer(Operation[bytes]):
    """The download of the missing part of a file in an open session; the result is its whole content."""

    timeout_error = FileTimeout
    exclusive = False
    modifies = False

    def __init__(
        self,
        description: str,
        session: int,
        file: PartialFile,
        server: ServerState,
        *,
        timeout: float | None = None,
    ) -> None:
        super().__init__(description, timeout=timeout, idle_timeout=10.0)
        self.counts = TransferCounts()
        self._file, self._session, self._server = file, session, server
        self._missing = file.missing
        self._window: SendWindow[FtpPayload] = SendWindow()
        self._bursts = BurstTracker()
        self._no_bursts = server.no_bursts
        self._last_burst = False  # True if no further burst is worthwhile
        self._unanswered_bursts = 0  # consecutive burst requests without an answer; each has a longer timeout

    def start(self, now: float) -> None:
        self.attempts = 1
        self._continue(now)

    def receive(self, packet: Packet, now: float) -> None:
        reply = FtpPayload.read(packet.message) if packet.message is not None else None
        if reply is None or reply.opcode not in (Opcode.ACK, Opcode.NAK):
            return
        if reply.req_opcode == Opcode.READFILE:
            self._read_answered(reply, now)
        elif reply.req_opcode == Opcode.BURSTREADFILE:
            self._burst_answered(reply, now)

    def handle_timeout(self, now: float) -> None:
        timeout_at = self._bursts.timeout_at()
        if timeout_at is not None and now >= timeout_at:
            self._burst_timed_out(now)
        self._continue(now)

    # Answers

    def _read_answered(self, reply: FtpPayload, now: float) -> None:
        request = self._window.find((reply.sequence - 1) % SEQUENCES)
        if request is None:
            self._window.answered_again((reply.sequence - 1) % SEQUENCES)
            return
        if not reply.answers(request):
            return
        if reply.error in _END_OF_FILE or (reply.error is None and not reply.data):
            self._window.answered(request.sequence, now)
            self._end_of_file_at(request.offset)
        elif reply.error is not None:
            self.fail(denied(self, reply))
        elif reply.offset == request.offset and reply.session == self._session:
            self._window.answered(request.sequence, now)
            self._store(reply, now)
        self._continue(now)

    def _burst_answered(self, reply: FtpPayload, now: float) -> None:
        burst = self._bursts.of(reply)
        if burst is None or (reply.session != self._session and reply.error is None):
            return
        if reply.error in _END_OF_FILE:
            if reply.offset >= burst.start:
                self._end_of_file_at(reply.offset)
            if burst is self._bursts.active:
                self._bursts.active = None
        elif reply.error is not None:
            self._server.no_bursts |= reply.error == FtpError.UNKNOWNCOMMAND
            self._disable_bursts()
        elif reply.data:
            new = self._store(reply, now)
            self._unanswered_bursts = 0
            self._bursts.arrived(burst, reply.offset, reply.offset + len(reply.data), new, now)
            self._window.known_delay = self._bursts.delay
            if reply.burst_complete:
                self._bursts.completed(burst)
            if self._bursts.novelty < MIN_NOVELTY or self._bursts.leave_link_idle:
                self._disable_bursts()
        self._continue(now)

    def _store(self, reply: FtpPayload, now: float) -> int:
        """Store the missing part of a packet; returns its number of bytes."""
        new = self._file.store(reply.offset, reply.data)
        self.counts.packets += 1
        self.counts.duplicates += not new
        if new:
            self.report_progress(now)
            (self.parent or self).report_progress(now, self._file.received, self._file.total)
        return new

    def _end_of_file_at(self, offset: int) -> None:
        if not self._file.end_at(offset):
            answer = "the file became shorter during the download"
            self.fail(RemoteProtocolError(self.description, str(self.target), answer=answer))

    # Failed bursts

    def _burst_timed_out(self, now: float) -> None:
        burst = self._bursts.active
        if burst is None or burst.packets:
            self._bursts.timed_out()
        elif burst.attempts % BURST_ATTEMPTS == 0:
            self._bursts.active = None
            self._no_bursts = self.counts.packets == 0 or self._no_bursts
            self._unanswered_bursts = burst.attempts
        else:
            burst.attempts += 1
            burst.sent_at = now
            self._transmit(burst.request)

    def _disable_bursts(self) -> None:
        self._no_bursts = True
        self._bursts.active = None

    # Requests

    def _continue(self, now: float) -> None:
        if self.done:
            return
        if not self._missing:
            self.finish(self._file.content())
            return
        for _, request in self._window.lost(now):
            self._transmit(request)
        self.attempts = max(self.attempts, self._window.attempts)
        self._read_gaps(now)
        self._request_burst(now)
        self.timer = earliest(self._window.next_timeout(), self._bursts.timeout_at())

    def _read_gaps(self, now: float) -> None:
        if not self._window.has_room:
            return
        requested = {request.offset for request in self._window}
        for low, high in self._missing:
            end = self._readable(low, high)
            for offset in range(low, end, MAX_DATA):
                if not self._window.has_room:
                    return
                if offset not in requested:
                    self._read(offset, min(end - offset, MAX_DATA), now)
            if end < high and not self._no_bursts:
                return

    def _readable(self, low: int, high: int) -> int:
        """Return the end of the part of a missing range that reads may request: the rest comes by burst."""
        if self._no_bursts:
            return high
        burst = self._bursts.active
        if burst is None:
            return low if self._is_worth_a_burst(low, high) else high
        if self._bursts.overrun:
            outside = high <= burst.start or low >= burst.start + (self._bursts.expected or 0)
            return high if self._last_burst and outside else low
        if low < burst.start:
            return low if self._is_worth_a_burst(low, high) else min(high, burst.start)
        return min(high, max(low, burst.furthest - 2 * MAX_DATA))

    def _is_worth_a_burst(self, low: int, high: int) -> bool:
        return high - low > (MIN_BURST_GAP_AT_END if high == self._file.end else MIN_BURST_GAP)

    def _request_burst(self, now: float) -> None:
        if self._no_bursts:
            return
        start = 0
        if self._bursts.active is not None:
            follow = self._bursts.next_start()
            if follow is None:
                return
            start = follow
        for low, high in self._missing.after(start):
            if self._is_worth_a_burst(low, high):
                number = self._server.next_sequence(now, BURST_SEQUENCES)
                request = FtpPayload.request(
                    Opcode.BURSTREADFILE, session=self._session, size=MAX_DATA, offset=low
                ).numbered(number)
                self._bursts.begin(request, now, attempts=self._unanswered_bursts + 1)
                self.counts.bursts += 1
                self._transmit(request)
                self._last_burst = False
                return
        self._last_burst = True

    def _read(self, offset: int, size: int, now: float) -> None:
        request = FtpPayload.request(Opcode.READFILE, session=self._session, size=size, offset=offset)
        request = request.numbered(self._server.next_sequence(now))
        self._window.add(request.sequence, request, now)
        self._transmit(request)
        self.counts.reads += 1

    def _transmit(self, request: FtpPayload) -> None:
        self.send(request.to_message(*self.target))
