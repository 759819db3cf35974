"""Reading a file: bursts, several reads at once, or one at a time, as what arrives shows to be best.

What is missing is kept as ranges; a piece goes where its offset says, whoever asked for it and when. The
long missing stretch at the end is asked for by bursts (see `bursts`), holes by reads whose window follows
from their answers (see `flight`); if bursts overrun a queue, the holes wait for the last one. Bursts are
given up for reads if the server does not know them, never answers them, or brings too much twice.
Reads go out before a burst's request: behind it their answers would find the queue full.

The announced size may be a guess (virtual files) or grow stale; the end of the file is where the server says
EOF. A file that gets shorter than what was read of it already is an error, not a mix.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from mavstack.errors import FileTimeout, RemoteProtocolError
from mavstack.services.ftp.bursts import LEAST_NOVELTY, Bursts
from mavstack.services.ftp.exchange import BURST_SEQUENCES, denied
from mavstack.services.ftp.flight import Flight
from mavstack.services.ftp.payload import MOST_DATA, SEQUENCES, FtpError, FtpPayload, Opcode
from mavstack.services.ftp.ranges import Ranges
from mavstack.services.operation import Operation
from mavstack.services.service import earliest

if TYPE_CHECKING:
    from mavstack.services.ftp.exchange import Peer
    from mavstack.wire import Packet

#: A hole of so many bytes is worth a burst; the rest of the file is worth one sooner.
WORTH_A_BURST = 16 * MOST_DATA
REST_WORTH_A_BURST = 3 * MOST_DATA
#: So often a burst is asked for before the server counts as one that has none.
BURST_ATTEMPTS = 3
#: PX4 tells the errno of an earlier failure in place of an end of file.
_END = frozenset({int(FtpError.EOF), int(FtpError.FILEEXISTS)})


@dataclass(slots=True)
class Counts:
    """What a transfer took: packets asked for, come, and come in vain."""

    reads: int = 0
    bursts: int = 0
    packets: int = 0
    duplicates: int = 0


class ReadTransfer(Operation[bytes]):
    """Reads a range of an open session; its result may be shorter if the file is."""

    timeout_error = FileTimeout
    exclusive = False
    modifies = False

    def __init__(
        self,
        description: str,
        session: int,
        start: int,
        end: int,
        peer: Peer,
        *,
        timeout: float | None = None,
    ) -> None:
        super().__init__(description, timeout=timeout, idle_timeout=10.0)
        self.counts = Counts()
        self.end = end
        self._start, self._session, self._peer = start, session, peer
        self._missing = Ranges(start, end)
        self._pieces: dict[int, bytes] = {}
        self._flight: Flight[FtpPayload] = Flight()
        self._bursts = Bursts()
        self._no_bursts = peer.no_bursts
        self._last_burst = False  # nothing more is worth one

    def start(self, now: float) -> None:
        self.attempts = 1
        self._go_on(now)

    def receive(self, packet: Packet, now: float) -> None:
        reply = FtpPayload.read(packet.message) if packet.message is not None else None
        if reply is None or reply.opcode not in (Opcode.ACK, Opcode.NAK):
            return
        if reply.req_opcode == Opcode.READFILE:
            self._read_answered(reply, now)
        elif reply.req_opcode == Opcode.BURSTREADFILE:
            self._burst_answered(reply, now)

    def handle_timeout(self, now: float) -> None:
        quiet = self._bursts.quiet_at()
        if quiet is not None and now >= quiet:
            self._burst_is_silent(now)
        self._go_on(now)

    # Answers

    def _read_answered(self, reply: FtpPayload, now: float) -> None:
        asked = self._flight.find((reply.sequence - 1) % SEQUENCES)
        if asked is None:
            self._flight.answered_again((reply.sequence - 1) % SEQUENCES)
            return
        if not reply.answers(asked):
            return
        if reply.error in _END or (reply.error is None and not reply.data):
            self._flight.answered(asked.sequence, now)
            self._ends_at(asked.offset)
        elif reply.error is not None:
            self.fail(denied(self, reply))
        elif reply.offset == asked.offset and reply.session == self._session:
            self._flight.answered(asked.sequence, now)
            self._store(reply, now)
        self._go_on(now)

    def _burst_answered(self, reply: FtpPayload, now: float) -> None:
        burst = self._bursts.of(reply)
        if burst is None or (reply.session != self._session and reply.error is None):
            return
        if reply.error in _END:
            if reply.offset >= burst.start:
                self._ends_at(reply.offset)
            if burst is self._bursts.active:
                self._bursts.active = None
        elif reply.error is not None:
            self._peer.no_bursts |= reply.error == FtpError.UNKNOWNCOMMAND
            self._give_up_bursts()
        elif reply.data:
            new = self._store(reply, now)
            self._bursts.arrived(burst, reply.offset, reply.offset + len(reply.data), new, now)
            self._flight.known_delay = self._bursts.delay
            if reply.burst_complete:
                self._bursts.completed(burst)
            if self._bursts.novelty < LEAST_NOVELTY or self._bursts.leave_link_idle:
                self._give_up_bursts()
        self._go_on(now)

    def _store(self, reply: FtpPayload, now: float) -> int:
        """Keep what was missing; gives how much that was."""
        new = 0
        for low, high in self._missing.take(reply.offset, reply.offset + len(reply.data)):
            self._pieces[low] = reply.data[low - reply.offset : high - reply.offset]
            new += high - low
        self.counts.packets += 1
        self.counts.duplicates += not new
        if new:
            total = self.end - self._start
            self.report_progress(now)
            (self.parent or self).report_progress(now, total - self._missing.total, total)
        return new

    def _ends_at(self, offset: int) -> None:
        if offset >= self.end:
            return
        if any(low + len(piece) > offset for low, piece in self._pieces.items()):
            self._changed()
            return
        self._missing.take(max(offset, self._start), self.end)
        self.end = max(offset, self._start)

    def _changed(self) -> None:
        self.fail(
            RemoteProtocolError(
                self.description, str(self.target), answer="the file became shorter while it was read"
            )
        )

    # Bursts that fail

    def _burst_is_silent(self, now: float) -> None:
        burst = self._bursts.active
        if burst is None or burst.packets:
            self._bursts.fell_silent()
        elif burst.attempts >= BURST_ATTEMPTS:
            self._bursts.active = None
            self._no_bursts = self.counts.packets == 0 or self._no_bursts
        else:
            burst.attempts += 1
            burst.sent_at = now
            self._transmit(burst.request)

    def _give_up_bursts(self) -> None:
        self._no_bursts = True
        self._bursts.active = None

    # Questions

    def _go_on(self, now: float) -> None:
        if self.done:
            return
        if not self._missing:
            self.finish(b"".join(self._pieces[low] for low in sorted(self._pieces)))
            return
        for _, request in self._flight.lost(now):
            self._transmit(request)
        self.attempts = max(self.attempts, self._flight.attempts)
        self._read_holes(now)
        self._ask_for_burst(now)
        self.timer = earliest(self._flight.next_timeout(), self._bursts.quiet_at())

    def _read_holes(self, now: float) -> None:
        if not self._flight.has_room:
            return
        asked = {request.offset for request in self._flight}
        for low, high in self._missing:
            end = self._readable(low, high)
            for offset in range(low, end, MOST_DATA):
                if not self._flight.has_room:
                    return
                if offset not in asked:
                    self._read(offset, min(end - offset, MOST_DATA), now)
            if end < high and not self._no_bursts:
                return

    def _readable(self, low: int, high: int) -> int:
        """Up to where a missing range is for reads: not what the active burst still brings."""
        if self._no_bursts:
            return high
        burst = self._bursts.active
        if burst is None:
            return low if self._worth_a_burst(low, high) else high
        if self._bursts.overrun:
            outside = high <= burst.start or low >= burst.start + (self._bursts.expected or 0)
            return high if self._last_burst and outside else low
        if low < burst.start:
            return low if self._worth_a_burst(low, high) else min(high, burst.start)
        return min(high, max(low, burst.furthest - 2 * MOST_DATA))

    def _worth_a_burst(self, low: int, high: int) -> bool:
        return high - low > (REST_WORTH_A_BURST if high == self.end else WORTH_A_BURST)

    def _ask_for_burst(self, now: float) -> None:
        if self._no_bursts:
            return
        start = 0
        if self._bursts.active is not None:
            follow = self._bursts.next_start()
            if follow is None:
                return
            start = follow
        for low, high in self._missing.after(start):
            if self._worth_a_burst(low, high):
                number = self._peer.next_sequence(now, BURST_SEQUENCES)
                request = FtpPayload.request(
                    Opcode.BURSTREADFILE, session=self._session, size=MOST_DATA, offset=low
                ).numbered(number)
                self._bursts.begin(request, now)
                self.counts.bursts += 1
                self._transmit(request)
                self._last_burst = False
                return
        self._last_burst = True

    def _read(self, offset: int, size: int, now: float) -> None:
        request = FtpPayload.request(Opcode.READFILE, session=self._session, size=size, offset=offset)
        request = request.numbered(self._peer.next_sequence(now))
        self._flight.add(request.sequence, request, now)
        self._transmit(request)
        self.counts.reads += 1

    def _transmit(self, request: FtpPayload) -> None:
        self.send(request.to_message(*self.target))
