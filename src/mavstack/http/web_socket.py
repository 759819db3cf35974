"""The WebSocket of a server, which ends also while its client closes it."""

from __future__ import annotations

from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol
from websockets.protocol import State


class WebSocket(WebSocketsSansIOProtocol):
    """A WebSocket that the end of the server does not close a second time."""

    def shutdown(self) -> None:
        """Close the connection; one whose client has closed it waits for its last bytes only."""
        if self.handshake_complete and self.conn.state is not State.OPEN:
            # A second closing frame would be an error, which kept the other connections open.
            self.stop_keepalive()
            self.transport.close()
        else:
            super().shutdown()
