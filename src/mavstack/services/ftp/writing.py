"""Writing a file: several pieces at once, as many as their answers show to be good, while there is room."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.errors import FileTimeout
from mavstack.services.ftp.exchange import denied
from mavstack.services.ftp.flight import Flight
from mavstack.services.ftp.payload import MOST_DATA, SEQUENCES, FtpPayload, Opcode
from mavstack.services.operation import Operation
from mavstack.services.service import Outgoing, Priority

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.services.ftp.exchange import Peer
    from mavstack.services.service import HasRoom
    from mavstack.wire import Packet


class WriteTransfer(Operation[None]):
    """Writes data into an open session, from an offset on."""

    timeout_error = FileTimeout
    exclusive = False
    modifies = False

    def __init__(
        self,
        description: str,
        session: int,
        data: bytes,
        peer: Peer,
        *,
        offset: int = 0,
        timeout: float | None = None,
    ) -> None:
        super().__init__(description, timeout=timeout, idle_timeout=10.0)
        self._session, self._data, self._offset, self._peer = session, data, offset, peer
        self._flight: Flight[FtpPayload] = Flight()
        self._next = 0
        self._written = 0
        self._again: list[FtpPayload] = []

    def start(self, now: float) -> None:
        self.attempts = 1
        if not self._data:
            self.finish(None)

    def bulk_messages(self, now: float, has_room: HasRoom) -> Iterator[Outgoing]:
        while not self.done and (self._again or self._may_go_on()) and has_room(self.target):
            request = self._again.pop(0) if self._again else self._next_piece(now)
            yield Outgoing(request.to_message(*self.target), self.target, Priority.BULK)
        self.timer = self._flight.next_timeout()

    def receive(self, packet: Packet, now: float) -> None:
        reply = FtpPayload.read(packet.message) if packet.message is not None else None
        asked = None if reply is None else self._flight.find((reply.sequence - 1) % SEQUENCES)
        if reply is not None and asked is None and reply.req_opcode == Opcode.WRITEFILE:
            self._flight.answered_again((reply.sequence - 1) % SEQUENCES)
        if reply is None or asked is None or not reply.answers(asked):
            return
        if reply.error is not None:
            self.fail(denied(self, reply))
            return
        self._flight.answered(asked.sequence, now)
        self._again = [request for request in self._again if request is not asked]
        self._written += asked.size
        self.report_progress(now)
        (self.parent or self).report_progress(now, self._written, len(self._data))
        self._repeat_lost(now)
        if self._written == len(self._data):
            self.finish(None)

    def handle_timeout(self, now: float) -> None:
        self._repeat_lost(now)
        self.timer = self._flight.next_timeout()

    def _repeat_lost(self, now: float) -> None:
        self._again += [request for _, request in self._flight.lost(now) if request not in self._again]
        self.attempts = max(self.attempts, self._flight.attempts)

    def _may_go_on(self) -> bool:
        return self._next < len(self._data) and self._flight.has_room

    def _next_piece(self, now: float) -> FtpPayload:
        piece = self._data[self._next : self._next + MOST_DATA]
        request = FtpPayload.request(
            Opcode.WRITEFILE, piece, session=self._session, offset=self._offset + self._next
        ).numbered(self._peer.next_sequence(now))
        self._next += len(piece)
        self._flight.add(request.sequence, request, now)
        return request
