"""One request and its reply.

A repetition keeps its sequence number, so that the server can say its last reply again instead of carrying
the request out twice. A server that remembers only the number (PX4) may take a new client's first request
for one it has answered: a reply to another operation under our number is answered with a new number.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mavstack.errors import FileDenied, FileTimeout
from mavstack.services.ftp.flight import MOST_DOUBLED
from mavstack.services.ftp.payload import SEQUENCES, FtpError, FtpPayload, Opcode, error_text
from mavstack.services.operation import Operation
from mavstack.services.timing import RoundTrip

if TYPE_CHECKING:
    from mavstack.wire import Packet

ATTEMPTS = 12
#: How far to go on after a burst, whose packets count on from its request: more than any server sends.
BURST_SEQUENCES = 2500
#: Modifying requests, and the error by which a repetition tells that the lost first one was carried out.
_DONE_ALREADY = (
    (Opcode.REMOVEFILE, FtpError.FILENOTFOUND),
    (Opcode.REMOVEDIRECTORY, FtpError.FILENOTFOUND),
    (Opcode.CREATEDIRECTORY, FtpError.FILEEXISTS),
)


class Peer:
    """What is known of the server, shared by all operations toward it."""

    def __init__(self) -> None:
        self.round_trip = RoundTrip(initial=0.5, least=0.05, most=3.0)
        self.no_bursts = False
        self.no_crc = False
        self._sequence: int | None = None

    def next_sequence(self, now: float, step: int = 1) -> int:
        """A sequence number not used lately; the first is drawn from the time, lest an older run used it."""
        if self._sequence is None:
            self._sequence = int(now * 1000)
        sequence, self._sequence = self._sequence % SEQUENCES, self._sequence + step
        return sequence


class Exchange(Operation[FtpPayload]):
    """A request, sent until it is answered; its result is the ACK."""

    timeout_error = FileTimeout
    exclusive = False
    modifies = False

    def __init__(
        self, description: str, payload: FtpPayload, peer: Peer, *, timeout: float | None = None
    ) -> None:
        super().__init__(description, timeout=timeout, idle_timeout=15.0)
        self._payload = payload
        self._peer = peer
        self._sent_at = 0.0
        self._numbered = False

    def start(self, now: float) -> None:
        self._payload = self._payload.numbered(self._peer.next_sequence(now))
        self._transmit(now)

    def receive(self, packet: Packet, now: float) -> None:
        reply = FtpPayload.read(packet.message) if packet.message is not None else None
        if reply is None:
            return
        if reply.answers(self._payload):
            if self.attempts == 1:
                self._peer.round_trip.measured(now - self._sent_at)
            self._answered(reply)
        elif self._is_someone_elses(reply):
            self._numbered = True
            self._payload = self._payload.numbered(self._peer.next_sequence(now, BURST_SEQUENCES))
            self._transmit(now)

    def handle_timeout(self, now: float) -> None:
        if self.attempts >= ATTEMPTS:
            self.time_out(now)
        else:
            self._transmit(now)

    def _is_someone_elses(self, reply: FtpPayload) -> bool:
        ours = reply.sequence == (self._payload.sequence + 1) % SEQUENCES
        is_reply = reply.opcode in (Opcode.ACK, Opcode.NAK)
        return ours and is_reply and reply.req_opcode != Opcode.BURSTREADFILE and not self._numbered

    def _transmit(self, now: float) -> None:
        self.attempts += 1
        self._sent_at = now
        self.send(self._payload.to_message(*self.target))
        wait = self._peer.round_trip.timeout(min(self.attempts, MOST_DOUBLED))
        if self.attempts > 2:  # the server may be busy with it: a checksum, a copy
            wait = max(wait, min(0.05 * 2.0**self.attempts, 2.0))
        self.timer = now + wait

    def _answered(self, reply: FtpPayload) -> None:
        code = reply.error
        if code is None or (self.attempts > 1 and (self._payload.opcode, code) in _DONE_ALREADY):
            self.finish(reply)
        else:
            self.fail(denied(self, reply))


def denied(operation: Operation[Any], reply: FtpPayload) -> FileDenied:
    """The error that a NAK stands for."""
    code = reply.error or 0
    error = FileDenied(
        operation.description,
        str(operation.target),
        attempts=max(operation.attempts, 1),
        answer=error_text(code, reply.errno),
        code=code,
    )
    error.errno = reply.errno
    return error
