"""The WebSocket of a server, which ends also while its client closes it, and writes at once if it can."""

from __future__ import annotations

from struct import pack
from typing import TYPE_CHECKING, Final

from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol
from websockets.frames import Opcode
from websockets.protocol import State

from mavstack.http.immediate_writes import EXTENSION, WRITE

if TYPE_CHECKING:
    from collections.abc import Sequence

    from websockets.http11 import Request

#: The first byte of the only frame of a message.
_TEXT: Final = 0x80 | int(Opcode.TEXT)
_BINARY: Final = 0x80 | int(Opcode.BINARY)


class WebSocket(WebSocketsSansIOProtocol):
    """A WebSocket that the end of the server does not close a second time."""

    def handle_connect(self, event: Request) -> None:
        """Answer the handshake, and offer the application to write at once."""
        super().handle_connect(event)
        if self.response.status_code == 101:
            self.scope["extensions"][EXTENSION] = {WRITE: self.write_now}

    def write_now(self, messages: Sequence[str | bytes]) -> bool:
        """Write complete messages; return False if they have to wait (see `immediate_writes.WriteNow`)."""
        transport = self.transport
        if self.conn.state is not State.OPEN or transport.is_closing() or transport.get_write_buffer_size():
            return False
        transport.write(b"".join([_frame(each) for each in messages]))
        return True

    def shutdown(self) -> None:
        """Close the connection; one whose client has closed it waits for its last bytes only."""
        if self.handshake_complete and self.conn.state is not State.OPEN:
            # A second closing frame would be an error, which kept the other connections open.
            self.stop_keepalive()
            self.transport.close()
        else:
            super().shutdown()


def _frame(message: str | bytes) -> bytes:
    """Return the one frame of a message (RFC 6455, 5.2); those of a server have no mask.

    The library takes longer for it than the rest of a message needs, and for each client again.
    """
    first, data = (_TEXT, message.encode()) if isinstance(message, str) else (_BINARY, message)
    size = len(data)
    if size < 126:
        return bytes((first, size)) + data
    if size < 1 << 16:
        return pack(">BBH", first, 126, size) + data
    return pack(">BBQ", first, 127, size) + data
