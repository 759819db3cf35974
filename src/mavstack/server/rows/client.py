"""The subprotocol `mavstack.rows.1`: rows of sources that do not speak MAVLink, as JSON over a WebSocket.

The server sends the latest row of each message of each source, then every row that it receives:

    {"source": "cansat", "message": "ROW", "time": 1790000000.1, "fields": {"alt": 512.3, "mode": "DESCENT"}}

and `{"dropped": N}` (rows in total) when the client was too slow. What the client sends is ignored.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any, Final

from mavstack.http.immediate_writes import immediate_writer
from mavstack.server.client_queue import ClientQueue, stream_texts

if TYPE_CHECKING:
    from starlette.websockets import WebSocket

    from mavstack.server.rows.hub import RowHub

SUBPROTOCOL: Final = "mavstack.rows.1"
#: Maximum number of characters in the send queue of a client.
MAX_QUEUE: Final = 1 << 20


class RowClient:
    """One client."""

    def __init__(self, hub: RowHub, websocket: WebSocket) -> None:
        self.queue: ClientQueue[str] = ClientQueue(MAX_QUEUE, immediate_writer(websocket))
        self._websocket = websocket
        for latest in hub.latest.values():
            self.put_row(latest.value)

    def put_row(self, value: dict[str, Any]) -> None:
        """Send or queue a row."""
        self.queue.put(json.dumps(value, separators=(",", ":")))

    async def send(self) -> None:
        """Send what is queued, until the task is cancelled."""
        async for text in stream_texts(self.queue):
            await self._websocket.send_text(text)

    async def receive(self, _data: str | bytes) -> None:
        """Ignore what the client sends."""
