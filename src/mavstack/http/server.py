"""A server of an ASGI application, in the event loop of the program; needs the extra `web`."""

from __future__ import annotations

import asyncio
import logging
import os
import socket
import ssl
from contextlib import asynccontextmanager
from typing import TYPE_CHECKING, Final, NamedTuple

from mavstack.errors import LinkError, MissingExtraError
from mavstack.handshakes import Handshakes, TlsHandshake
from mavstack.http.connections import Connections, connection_factory

try:
    import uvicorn
except ImportError as error:
    raise MissingExtraError("an HTTP server", "web") from error

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Callable

    from starlette.applications import Starlette
    from starlette.types import ASGIApp, Receive, Scope, Send

    from mavstack.http.early_answers import EarlyAnswer
    from mavstack.http.request_lane import ComesFirst

logger = logging.getLogger("mavstack.http")


#: The largest message of a WebSocket client, in bytes.
MAX_WEBSOCKET_MESSAGE: Final = 1 << 20
#: Seconds between two pings of a WebSocket, and to wait for an answer; then the connection is closed.
PING_INTERVAL: Final = 20.0
_NEVER: Final = 1_000_000_000


class Certificate(NamedTuple):
    """The PEM files of a server's certificate and of its private key; the key may be in the first file."""

    certificate: str
    key: str | None = None


@asynccontextmanager
async def serving(
    app: Starlette,
    address: str,
    *,
    name: str,
    tls: Certificate | None = None,
    websockets: bool = False,
    proxy: str = "",
    comes_first: ComesFirst | None = None,
    answer_early: EarlyAnswer | None = None,
) -> AsyncIterator[tuple[str, int]]:
    """Serve an application while the block runs.

    Args:
        app: The application.
        address: Host and port on which it listens, such as `127.0.0.1:7272`.
        name: The name of the service in errors, such as "the control API".
        tls: The certificate of an HTTPS server; None: HTTP.
        websockets: Serve WebSockets too.
        proxy: The address of a proxy in front, whose headers X-Forwarded-For and X-Forwarded-Proto name the
            client; empty: none, and these headers are not believed.
        comes_first: Decides by their heads which requests wait for no others; None: all wait for their turn.
        answer_early: Answers requests by their heads alone; None: the application answers all.

    Yields:
        Host and port on which it listens.

    Raises:
        LinkError: The address cannot be listened on.
    """
    sock = await _listen(address, name)
    handshakes = Handshakes()
    try:
        context = None if tls is None else _tls_context(tls)
    except OSError as error:
        sock.close()
        files = " or ".join(filter(None, tls or ()))
        raise LinkError(
            f"cannot serve {name} with TLS: {files} is not a certificate with its key ({_reason(error)})"
        ) from None
    connections = Connections(comes_first, answer_early)
    config = _config(connections.tracking(app), websockets=websockets, proxy=proxy)
    connect = connection_factory(config.http_protocol_class, connections)
    config.http_protocol_class = _with_tls(connect, context, handshakes)  # type: ignore[assignment]
    server = uvicorn.Server(config)
    server.lifespan = server.config.lifespan_class(server.config)
    await server.startup([sock])
    task = asyncio.create_task(server.main_loop())
    try:
        yield sock.getsockname()[:2]
    finally:
        server.should_exit = True
        handshakes.close()
        await task
        await server.shutdown([sock])


def _reason(error: OSError) -> str:
    return str(getattr(error, "reason", None) or error.strerror or error)


def _tls_context(tls: Certificate) -> ssl.SSLContext:
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(tls.certificate, tls.key)
    return context


def _config(app: ASGIApp, *, websockets: bool, proxy: str) -> uvicorn.Config:
    config = uvicorn.Config(
        _logged(app),
        log_config=None,
        # faulty clients could fill the log; `_logged` reports errors of this program
        log_level=logging.CRITICAL,
        access_log=False,
        lifespan="off",
        server_header=False,
        # `Connection` closes idle connections, because the server does not see all requests
        timeout_keep_alive=_NEVER,
        http="h11",
        ws=_web_socket() if websockets else "none",
        ws_max_size=MAX_WEBSOCKET_MESSAGE,
        ws_ping_interval=PING_INTERVAL,
        ws_ping_timeout=PING_INTERVAL,
        ws_per_message_deflate=False,  # each message would be compressed again for each client
        # By default the server trusts proxy headers of all clients on this machine, which could then guess
        # passwords without limit.
        proxy_headers=bool(proxy),
        forwarded_allow_ips=proxy,
        timeout_graceful_shutdown=1,
    )
    config.load()
    return config


def _web_socket() -> type[asyncio.Protocol]:
    from mavstack.http.web_socket import WebSocket  # servers without WebSockets do without the package

    return WebSocket


def _with_tls(
    connect: Callable[..., asyncio.Protocol], context: ssl.SSLContext | None, handshakes: Handshakes
) -> Callable[..., asyncio.Protocol]:
    """Return the function that makes connections; with TLS each begins with a handshake.

    The server of uvicorn sees a connection only after its handshake, of which it would take any number.
    """
    if context is None:
        return connect
    return lambda *arguments, **settings: TlsHandshake(connect(*arguments, **settings), context, handshakes)


def _logged(app: ASGIApp) -> ASGIApp:
    """Return an application whose unexpected exceptions are logged."""

    async def logged(scope: Scope, receive: Receive, send: Send) -> None:
        try:
            await app(scope, receive, send)
        except Exception:
            logger.exception("the request for %s failed", scope.get("path", ""))
            raise

    return logged


async def _listen(address: str, name: str) -> socket.socket:
    host, _, port = address.rpartition(":")
    sock: socket.socket | None = None
    try:
        found = await asyncio.get_running_loop().getaddrinfo(
            host.strip("[]"), int(port), type=socket.SOCK_STREAM
        )
        family, kind, protocol, _, target = found[0]
        # asyncio sends small packets of a connection at once only if the protocol of the socket is given.
        sock = socket.socket(family, kind, protocol)
        if os.name == "posix":  # on Windows, SO_REUSEADDR would let another program listen on the same port
            sock.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        sock.bind(target)
    except OSError as error:
        if sock is not None:
            sock.close()
        raise LinkError(f"cannot serve {name} on {address}: {error.strerror or error}") from None
    return sock
