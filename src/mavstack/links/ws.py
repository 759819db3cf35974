"""WebSocket links: `ws://` and `wss://host/path` connect, `wsin://` and `wssin://host:port` listen.

They need the extra `web`. Each binary message is a chunk; text messages are dropped and counted. The server
refuses connections from web pages, because any page open in the user's browser could connect, unless the
origin of the page is given by `origin=https://…`; `origin=*` accepts all origins.

A client sends the headers `header.NAME=VALUE`, the query `query.NAME=VALUE`, the subprotocols that it
offers (`subprotocol=a,b`) and a token (`token=…`, as `Authorization: Bearer …`). A server with a token
accepts only clients that show it; a web page, which cannot send headers, shows it as `?access_token=…`. The
request of each client is `channel.request`; a program that sets `accept` of the `WsServer` decides by it:

    link = WsServer.of("wsin://0.0.0.0:5770")
    link.accept = lambda request: None if request.query.get("vehicle") else "name your vehicle"

With `ticket_key=…` (a file or the name of a key) a server accepts tickets (see `ws_gate`), and a client
makes a new ticket for each attempt to connect.
"""

from __future__ import annotations

import asyncio
import re
from contextlib import suppress
from dataclasses import replace
from http import HTTPStatus
from secrets import token_bytes
from time import time
from typing import TYPE_CHECKING, Any, Final, cast
from urllib.parse import parse_qsl, quote, unquote, urlencode

from mavstack.errors import LinkError, LinkURLError, MissingExtraError
from mavstack.handshakes import HANDSHAKE_TIMEOUT, Handshakes, TlsHandshake
from mavstack.links.address import format_address
from mavstack.links.certificates import client_subject
from mavstack.links.channel import Request
from mavstack.links.connection import ClientLink, ConnectionChannel, ServerLink
from mavstack.links.os_errors import open_error
from mavstack.links.queued import QueuedChannel
from mavstack.links.role_gate import RoleGate
from mavstack.links.stream import stop_accepting
from mavstack.links.tls import client_context, server_context
from mavstack.links.ws_gate import WsGate, ticket_key
from mavstack.security.roles import Role
from mavstack.security.tickets import SUBPROTOCOL, make_ticket

try:
    from websockets.asyncio.client import connect
    from websockets.asyncio.server import ServerConnection, serve
    from websockets.exceptions import ConnectionClosed, InvalidHandshake, WebSocketException
    from websockets.protocol import Side
except ImportError as missing:
    raise MissingExtraError("a WebSocket link", "web") from missing

if TYPE_CHECKING:
    import ssl
    from collections.abc import Callable, Iterable, Sequence

    from websockets.asyncio.connection import Connection as WebSocket
    from websockets.asyncio.server import Server
    from websockets.http11 import Request as HttpRequest
    from websockets.http11 import Response
    from websockets.typing import Origin, Subprotocol

    from mavstack.links.channel import Channel
    from mavstack.links.inbox import Inbox
    from mavstack.links.options import Options
    from mavstack.links.url import LinkURL

MAX_MESSAGE = 1 << 20
_HEADER_NAME: Final = re.compile(r"[A-Za-z0-9!#$%&'*+.^_`|~-]+")


class WsChannel(QueuedChannel):
    """A channel over one WebSocket."""

    def __init__(
        self, scheme: str, on_closed: Callable[[Channel, str], None], send_queue: int, socket: WebSocket
    ) -> None:
        peer = format_address(socket.remote_address)
        super().__init__(f"{scheme} {peer}", peer, on_closed, send_queue)
        self._socket = socket
        self.request = _request(socket)
        if self.request is not None:
            self.identity = client_subject(socket.transport)

    def abort(self) -> None:
        """Drop the connection without a closing handshake."""
        self._socket.transport.abort()

    async def _receive_loop(self, inbox: Inbox) -> str:
        try:
            async for message in self._socket:
                if isinstance(message, str):
                    inbox.drop(self.counters)
                elif not self.closed and (allowed := self.allowed(message)):
                    self.last_received = now = time()
                    inbox.put(self, allowed, now)
                    await inbox.wait_for_room()
        except ConnectionClosed as error:
            return f"connection lost ({error})"
        return "closed by the peer"

    async def _transmit(self, data: bytes) -> None:
        await self._socket.send(data)

    async def _disconnect(self) -> None:
        with suppress(WebSocketException, OSError):
            await self._socket.close()


class _Opening(ServerConnection):
    """A connection to a server that is counted until its handshakes are done."""

    handshakes: Handshakes
    #: The role that the client's credentials allow.
    role = Role.ADMINISTER

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        super().connection_made(transport)
        self.handshakes.begin(self.transport)

    def connection_lost(self, exc: Exception | None) -> None:
        self.handshakes.end(self.transport)
        super().connection_lost(exc)


class WsServer(ServerLink):
    """A link that listens; every WebSocket is a channel."""

    def __init__(self, url: LinkURL, options: Options) -> None:
        super().__init__(url, options)
        self._handshakes = Handshakes()
        self._origin = options.text("origin")
        self._subprotocols = _words(options, "subprotocol")
        #: Admits or refuses clients.
        self.gate = WsGate(url, options)
        self._roles = RoleGate(url, options)
        self._context: ssl.SSLContext | None = server_context(url, options) if url.scheme == "wssin" else None
        self._server: Server | None = None

    @property
    def accept(self) -> Callable[[Request], str | None] | None:
        """Decides on each client: returns None to accept it, or the reason to refuse it; None accepts all."""
        return self.gate.accept

    @accept.setter
    def accept(self, accept: Callable[[Request], str | None] | None) -> None:
        self.gate.accept = accept

    @classmethod
    def of(cls, url: str) -> WsServer:
        """Create the server of a URL.

        Args:
            url: A URL with the scheme `wsin` or `wssin`, without impairments.

        Returns:
            The link, not open yet.

        Raises:
            LinkURLError: The URL has another scheme, is malformed, or has an unknown option.
        """
        from mavstack.links.registry import open_link

        link = open_link(url)
        if not isinstance(link, cls):
            raise LinkURLError(f"{link.url.redacted} is not a WebSocket server without impairments")
        return link

    @property
    def address(self) -> tuple[str, int] | None:
        """Host and port on which the link listens, or None before it is open."""
        sockets = list(self._server.sockets) if self._server else []
        return sockets[0].getsockname()[:2] if sockets else None

    async def open_transport(self) -> None:
        """Open the transport of the link."""
        try:
            self._server = await serve(
                self._accept, self.url.host, self.url.port,
                origins=self._origins(),
                create_connection=self._new_connection,  # type: ignore[arg-type]
                process_request=self._check, subprotocols=self._subprotocols or None,
                select_subprotocol=self._select_subprotocol if self.gate.takes_tickets else None,
                compression=None, max_size=MAX_MESSAGE, close_timeout=1, open_timeout=HANDSHAKE_TIMEOUT,
            )  # fmt: skip
        except OSError as error:
            raise open_error(self.url, error) from error

    def _origins(self) -> Sequence[Origin | None] | None:
        if self._origin == "*":
            return None
        return [None, self._origin] if self._origin else [None]  # type: ignore[list-item]

    def _check(self, socket: ServerConnection, received: HttpRequest) -> Response | None:
        """Return the response that refuses a client; None to accept it."""
        request = _parse_request(received.path, received.headers.raw_items())
        subprotocols = ",".join(received.headers.get_all("Sec-WebSocket-Protocol"))
        decision = self.gate.check(request, subprotocols, time())
        if isinstance(decision, Role):
            cast("_Opening", socket).role = decision
            return None
        response = socket.respond(decision.status, f"{decision.reason}\n")
        if decision.status is HTTPStatus.UNAUTHORIZED:
            response.headers["WWW-Authenticate"] = "Bearer"
        return response

    def _select_subprotocol(
        self, _socket: ServerConnection, offered: Sequence[Subprotocol]
    ) -> Subprotocol | None:
        """Choose the subprotocol of tickets if it is offered, else one of the link."""
        accepted = cast("list[Subprotocol]", [SUBPROTOCOL]) + self._subprotocols
        return next((word for word in accepted if word in offered), None)

    def _new_connection(self, *arguments: Any, **settings: Any) -> Any:  # noqa: ANN401 (of websockets)
        """Return the protocol of a connection that is being accepted: WebSocket, for wssin inside TLS."""
        connection = _Opening(*arguments, **settings)
        connection.handshakes = self._handshakes
        if self._context is None:
            return connection
        return TlsHandshake(connection, self._context, self._handshakes)

    async def _accept(self, socket: ServerConnection) -> None:
        self._handshakes.end(socket.transport)
        connection = WsChannel(self.url.scheme, self.inbox.remove_channel, self._send_queue, socket)
        connection.role_filter = self._roles.filter_of(connection.identity, cast("_Opening", socket).role)
        if self._admit(connection):
            await asyncio.wait({self.spawn(self._serve_task(connection))})

    async def stop_transport(self) -> None:
        """Stop accepting peers and bytes."""
        if self._server is not None:
            await stop_accepting(self._server.sockets)
            self._server.close(close_connections=False)
            self._handshakes.close()

    async def release_transport(self) -> None:
        """Release the remaining resources."""
        if self._server is not None:
            await self._server.wait_closed()


class WsClient(ClientLink):
    """A link that connects to a WebSocket server; the option `timeout` limits each attempt in seconds.

    Args:
        url: The URL.
        options: Its options.
        scheme: The scheme of the WebSocket, `ws` or `wss`; empty: that of the URL.
    """

    def __init__(self, url: LinkURL, options: Options, scheme: str = "") -> None:
        super().__init__(url, options)
        self._scheme = scheme or url.scheme
        self._timeout = options.seconds("timeout", 5.0)
        self._settings: dict[str, Any] = {
            "compression": None,
            "max_size": MAX_MESSAGE,
            "close_timeout": 1,
            "additional_headers": _headers(url, options),
            "origin": options.text("origin") or None,
        }
        self._subprotocols = _words(options, "subprotocol")
        self._ticket_key = ticket_key(url, options)
        query = urlencode(options.prefixed("query."))
        self._target = quote(url.path) + (f"?{query}" if query else "")
        if self._scheme == "wss":
            self._settings["ssl"] = client_context(url, options)

    async def _connect(self) -> ConnectionChannel:
        host = f"[{self.url.host}]" if ":" in self.url.host else self.url.host
        address = f"{self._scheme}://{host}:{self.url.port}{self._target}"
        try:
            socket = await connect(
                address, open_timeout=self._timeout, subprotocols=self.offer() or None, **self._settings
            )
        except InvalidHandshake as error:
            raise LinkError(
                f"cannot open {self.url.redacted}: the server refused the WebSocket: {error}"
            ) from error
        except WebSocketException as error:
            raise LinkError(f"cannot open {self.url.redacted}: {error}") from error
        return WsChannel(self.url.scheme, self.inbox.remove_channel, self._send_queue, socket)

    def offer(self) -> list[Subprotocol]:
        """Return the subprotocols of one attempt, with a new ticket if the URL names a key."""
        if not self._ticket_key:
            return self._subprotocols
        ticket = make_ticket(self._ticket_key, now=time(), nonce=token_bytes(16))
        return [*cast("list[Subprotocol]", [SUBPROTOCOL, ticket]), *self._subprotocols]


def _headers(url: LinkURL, options: Options) -> dict[str, str]:
    """Return the headers that a client sends; raises `LinkURLError` for one that HTTP does not allow."""
    headers = options.prefixed("header.")
    token = options.text("token")
    if token:
        headers["Authorization"] = f"Bearer {token}"
    for name, value in headers.items():
        if not _HEADER_NAME.fullmatch(name) or not (value.isascii() and value.isprintable()):
            raise LinkURLError(f"{url.redacted}: HTTP does not allow the header {name!r} or its value")
    return headers


def _words(options: Options, name: str) -> list[Subprotocol]:
    return [cast("Subprotocol", word.strip()) for word in options.text(name).split(",") if word.strip()]


def _request(socket: WebSocket) -> Request | None:
    """Return the request with which a client of a server came; None at the client itself."""
    if socket.protocol.side is not Side.SERVER or socket.request is None:
        return None
    request = _parse_request(socket.request.path, socket.request.headers.raw_items())
    return replace(request, subprotocol=socket.subprotocol or "")


def _parse_request(target: str, headers: Iterable[tuple[str, str]]) -> Request:
    path, _, text = target.partition("#")[0].partition("?")
    query = dict(parse_qsl(text, keep_blank_values=True))
    return Request(unquote(path), query, {name.lower(): value for name, value in headers})
