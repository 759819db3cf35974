"""WebSocket links: `ws://` and `wss://host/path` connect, `wsin://` and `wssin://host:port` listen.

They need the extra `web`. Each binary message is a chunk; text messages are dropped and counted. The server
refuses connections from web pages, because any page open in the user's browser could connect, unless the
origin of the page is given by `origin=https://…`; `origin=*` accepts all origins.
"""

from __future__ import annotations

import asyncio
from contextlib import suppress
from time import time
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

from mavstack.errors import LinkError, MissingExtraError
from mavstack.links.address import format_address
from mavstack.links.connection import ClientLink, ConnectionChannel, ServerLink
from mavstack.links.os_errors import open_error
from mavstack.links.queued import QueuedChannel
from mavstack.links.stream import stop_accepting
from mavstack.links.tls import client_context, server_context

try:
    from websockets.asyncio.client import connect
    from websockets.asyncio.server import serve
    from websockets.exceptions import ConnectionClosed, InvalidHandshake, WebSocketException
except ImportError as missing:
    raise MissingExtraError("a WebSocket link", "web") from missing

if TYPE_CHECKING:
    import ssl
    from collections.abc import Callable, Sequence

    from websockets.asyncio.connection import Connection as WebSocket
    from websockets.asyncio.server import Server, ServerConnection
    from websockets.typing import Origin

    from mavstack.links.channel import Channel
    from mavstack.links.inbox import Inbox
    from mavstack.links.options import Options
    from mavstack.links.url import LinkURL

MAX_MESSAGE = 1 << 20


class WsChannel(QueuedChannel):
    """A channel over one WebSocket."""

    def __init__(
        self, scheme: str, on_closed: Callable[[Channel, str], None], send_queue: int, socket: WebSocket
    ) -> None:
        peer = format_address(socket.remote_address)
        super().__init__(f"{scheme} {peer}", peer, on_closed, send_queue)
        self._socket = socket

    def abort(self) -> None:
        """Drop the connection without a closing handshake."""
        self._socket.transport.abort()

    async def _receive_loop(self, inbox: Inbox) -> str:
        try:
            async for message in self._socket:
                if isinstance(message, str):
                    inbox.drop(self.counters)
                elif not self.closed:
                    self.last_received = now = time()
                    inbox.put(self, message, now)
                    await inbox.wait_for_room()
        except ConnectionClosed as error:
            return f"connection lost ({error})"
        return "closed by the peer"

    async def _transmit(self, data: bytes) -> None:
        await self._socket.send(data)

    async def _disconnect(self) -> None:
        with suppress(WebSocketException, OSError):
            await self._socket.close()


class WsServer(ServerLink):
    """A link that listens; every WebSocket is a channel."""

    def __init__(self, url: LinkURL, options: Options) -> None:
        super().__init__(url, options)
        self._ssl: ssl.SSLContext | None = server_context(url, options) if url.scheme == "wssin" else None
        self._origin = options.text("origin")
        self._server: Server | None = None

    @property
    def address(self) -> tuple[str, int] | None:
        """Host and port on which the link listens, or None before it is open."""
        sockets = list(self._server.sockets) if self._server else []
        return sockets[0].getsockname()[:2] if sockets else None

    async def _open(self) -> None:
        try:
            self._server = await serve(
                self._accept, self.url.host, self.url.port,
                origins=self._origins(), ssl=self._ssl,
                compression=None, max_size=MAX_MESSAGE, close_timeout=1,
            )  # fmt: skip
        except OSError as error:
            raise open_error(self.url, error) from error

    def _origins(self) -> Sequence[Origin | None] | None:
        if self._origin == "*":
            return None
        return [None, self._origin] if self._origin else [None]  # type: ignore[list-item]

    async def _accept(self, socket: ServerConnection) -> None:
        connection = WsChannel(self.url.scheme, self._inbox.remove_channel, self._send_queue, socket)
        if self._admit(connection):
            await asyncio.wait({self._spawn(self._serve_task(connection))})

    async def _stop(self) -> None:
        if self._server is not None:
            await stop_accepting(self._server.sockets)
            self._server.close(close_connections=False)

    async def _release(self) -> None:
        if self._server is not None:
            await self._server.wait_closed()


class WsClient(ClientLink):
    """A link that connects to a WebSocket server; the option `timeout` limits each attempt in seconds."""

    def __init__(self, url: LinkURL, options: Options) -> None:
        super().__init__(url, options)
        self._timeout = options.seconds("timeout", 5.0)
        self._settings: dict[str, Any] = {"compression": None, "max_size": MAX_MESSAGE, "close_timeout": 1}
        if url.scheme == "wss":
            self._settings["ssl"] = client_context(url, options)

    async def _connect(self) -> ConnectionChannel:
        host = f"[{self.url.host}]" if ":" in self.url.host else self.url.host
        address = f"{self.url.scheme}://{host}:{self.url.port}{quote(self.url.path)}"
        try:
            socket = await connect(address, open_timeout=self._timeout, **self._settings)
        except InvalidHandshake as error:
            raise LinkError(
                f"cannot open {self.url.redacted}: the server refused the WebSocket: {error}"
            ) from error
        except WebSocketException as error:
            raise LinkError(f"cannot open {self.url.redacted}: {error}") from error
        return WsChannel(self.url.scheme, self._inbox.remove_channel, self._send_queue, socket)
