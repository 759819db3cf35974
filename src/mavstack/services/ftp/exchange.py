"""One FTP request and its reply.

A repeated request keeps its sequence number, so that the server can repeat its last reply and does not
execute the request twice. A server that compares only the number (PX4) may mistake the first request of a new
client for one that it has answered: a reply to another operation with the same number is met with a new
number.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

from mavstack.errors import FileDenied, FileTimeout
from mavstack.services.ftp.payload import SEQUENCES, FtpError, FtpPayload, Opcode, error_text
from mavstack.services.ftp.send_window import MAX_DOUBLINGS
from mavstack.services.operation import Operation
from mavstack.services.timing import RoundTrip

if TYPE_CHECKING:
    from mavstack.wire import Packet

ATTEMPTS = 12
#: The number of sequence numbers reserved for the packets of one burst; no server sends more packets.
BURST_SEQUENCES = 2500
#: Modifying requests, each with the error that a repeated request gets if the first one was executed.
_ALREADY_DONE = (
    (Opcode.REMOVEFILE, FtpError.FILENOTFOUND),
    (Opcode.REMOVEDIRECTORY, FtpError.FILENOTFOUND),
    (Opcode.CREATEDIRECTORY, FtpError.FILEEXISTS),
)
#: The error codes for the errnos ENOENT and EEXIST, which some servers send unconverted.
_CODES_OF_ERRNOS: Final = MappingProxyType({2: FtpError.FILENOTFOUND, 17: FtpError.FILEEXISTS})


class ServerState:
    """The known properties of one server, shared by all operations on it."""

    def __init__(self) -> None:
        self.round_trip = RoundTrip(initial=0.5, minimum=0.05, maximum=3.0)
        self.no_bursts = False
        self.no_crc = False
        self._sequence: int | None = None

    def next_sequence(self, now: float, step: int = 1) -> int:
        """Return an unused sequence number; the first one follows from the time, unlike an earlier run's."""
        if self._sequence is None:
            self._sequence = int(now * 1000)
        sequence, self._sequence = self._sequence % SEQUENCES, self._sequence + step
        return sequence


class Exchange(Operation[FtpPayload]):
    """A request, repeated until it is answered; the result is the ACK."""

    timeout_error = FileTimeout
    exclusive = False
    modifies = False

    def __init__(
        self, description: str, payload: FtpPayload, server: ServerState, *, timeout: float | None = None
    ) -> None:
        super().__init__(description, timeout=timeout, idle_timeout=11.0)
        self._payload = payload
        self._server = server
        self._sent_at = 0.0
        self._renumbered = False

    def start(self, now: float) -> None:
        self._payload = self._payload.numbered(self._server.next_sequence(now))
        self._transmit(now)

    def receive(self, packet: Packet, now: float) -> None:
        reply = FtpPayload.read(packet.message) if packet.message is not None else None
        if reply is None:
            return
        if reply.answers(self._payload):
            if self.attempts == 1:
                self._server.round_trip.add_sample(now - self._sent_at)
            self._answered(reply)
        elif self._is_reply_to_another_client(reply):
            self._renumbered = True
            self._payload = self._payload.numbered(self._server.next_sequence(now, BURST_SEQUENCES))
            self._transmit(now)

    def handle_timeout(self, now: float) -> None:
        if self.attempts >= ATTEMPTS:
            self.time_out(now)
        else:
            self._transmit(now)

    def _is_reply_to_another_client(self, reply: FtpPayload) -> bool:
        ours = reply.sequence == (self._payload.sequence + 1) % SEQUENCES
        is_reply = reply.opcode in (Opcode.ACK, Opcode.NAK)
        return ours and is_reply and reply.req_opcode != Opcode.BURSTREADFILE and not self._renumbered

    def _transmit(self, now: float) -> None:
        self.attempts += 1
        self._sent_at = now
        self.send(self._payload.to_message(*self.target))
        wait = self._server.round_trip.timeout(min(self.attempts, MAX_DOUBLINGS))
        if self.attempts > 2:  # the server may still execute a long operation, such as a checksum or a copy
            wait = max(wait, min(0.05 * 2.0**self.attempts, 2.0))
        self.timer = now + wait

    def _answered(self, reply: FtpPayload) -> None:
        code = reply.error
        done = code is None
        if code is not None and self.attempts > 1:
            done = (self._payload.opcode, error_kind(code, reply.errno)) in _ALREADY_DONE
        if done:
            self.finish(reply)
        else:
            self.fail(denied(self, reply))


def error_kind(code: int, errno: int | None) -> int:
    """Return the code of an error, also if it was sent as the errno of the file system."""
    return _CODES_OF_ERRNOS.get(errno or 0, code) if code == FtpError.FAILERRNO else code


def denied(operation: Operation[Any], reply: FtpPayload) -> FileDenied:
    """Return the error of a NAK."""
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
