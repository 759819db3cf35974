"""The transfer of an upload: several concurrent writes, as many as the link carries (see `send_window`)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.errors import FileTimeout
from mavstack.services.ftp.exchange import denied
from mavstack.services.ftp.payload import MAX_DATA, SEQUENCES, FtpPayload, Opcode
from mavstack.services.ftp.send_window import SendWindow
from mavstack.services.operation import Operation
from mavstack.services.service import Outgoing, Priority

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.services.ftp.exchange import ServerState
    from mavstack.services.service import HasRoom
    from mavstack.wire import Packet


class UploadTransfer(Operation[None]):
    """The upload of data into an open session, from an offset on."""

    timeout_error = FileTimeout
    exclusive = False
    modifies = False

    def __init__(
        self,
        description: str,
        session: int,
        data: bytes,
        server: ServerState,
        *,
        offset: int = 0,
        timeout: float | None = None,
    ) -> None:
        super().__init__(description, timeout=timeout, idle_timeout=10.0)
        self._session, self._data, self._offset, self._server = session, data, offset, server
        self._window: SendWindow[FtpPayload] = SendWindow()
        self._next = 0
        self._written = 0
        self._repeats: list[FtpPayload] = []

    def start(self, now: float) -> None:
        self.attempts = 1
        if not self._data:
            self.finish(None)

    def bulk_messages(self, now: float, has_room: HasRoom) -> Iterator[Outgoing]:
        while not self.done and (self._repeats or self._may_write()) and has_room(self.target):
            request = self._repeats.pop(0) if self._repeats else self._next_piece(now)
            yield Outgoing(request.to_message(*self.target), self.target, Priority.BULK)
        self.timer = self._window.next_timeout()

    def receive(self, packet: Packet, now: float) -> None:
        reply = FtpPayload.read(packet.message) if packet.message is not None else None
        answered = None if reply is None else self._window.find((reply.sequence - 1) % SEQUENCES)
        if reply is not None and answered is None and reply.req_opcode == Opcode.WRITEFILE:
            self._window.answered_again((reply.sequence - 1) % SEQUENCES)
        if reply is None or answered is None or not reply.answers(answered):
            return
        if reply.error is not None:
            self.fail(denied(self, reply))
            return
        self._window.answered(answered.sequence, now)
        self._repeats = [request for request in self._repeats if request is not answered]
        self._written += answered.size
        self.report_progress(now)
        (self.parent or self).report_progress(now, self._written, len(self._data))
        self._repeat_lost(now)
        if self._written == len(self._data):
            self.finish(None)

    def handle_timeout(self, now: float) -> None:
        self._repeat_lost(now)
        self.timer = self._window.next_timeout()

    def _repeat_lost(self, now: float) -> None:
        self._repeats += [request for _, request in self._window.lost(now) if request not in self._repeats]
        self.attempts = max(self.attempts, self._window.attempts)

    def _may_write(self) -> bool:
        return self._next < len(self._data) and self._window.has_room

    def _next_piece(self, now: float) -> FtpPayload:
        piece = self._data[self._next : self._next + MAX_DATA]
        request = FtpPayload.request(
            Opcode.WRITEFILE, piece, session=self._session, offset=self._offset + self._next
        ).numbered(self._server.next_sequence(now))
        self._next += len(piece)
        self._window.add(request.sequence, request, now)
        return request
