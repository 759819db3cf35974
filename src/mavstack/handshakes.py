"""Connections to a server whose TLS or WebSocket handshake is under way: bounded in number and in time.

They are no channels yet, so that the admission of peers does not count them; but each takes a descriptor and
memory (a TLS connection 0.3 MB). If there are too many, the oldest of the host with the most makes room.
"""

from __future__ import annotations

import asyncio
from collections import Counter
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    import ssl
    from collections.abc import Callable

#: Maximum number of simultaneous handshakes of one link.
MAX_HANDSHAKES: Final = 64
#: Seconds that each handshake may take.
HANDSHAKE_TIMEOUT: Final = 10.0


class Handshakes:
    """The connections of one link whose handshake is under way."""

    def __init__(self) -> None:
        self._hosts: dict[asyncio.Transport, str] = {}
        self._closed = False

    def begin(self, transport: asyncio.Transport) -> None:
        """Add a connection that was accepted; another one may be closed for it."""
        if self._closed:
            transport.abort()
            return
        if len(self._hosts) >= MAX_HANDSHAKES:
            self._make_room()
        self._hosts[transport] = (transport.get_extra_info("peername") or ("",))[0]

    def end(self, transport: asyncio.Transport) -> None:
        """Remove a connection whose handshake has ended. Idempotent."""
        self._hosts.pop(transport, None)

    def close(self) -> None:
        """Drop all connections, and those that are still accepted."""
        self._closed = True
        for transport in tuple(self._hosts):
            transport.abort()
        self._hosts.clear()

    def _make_room(self) -> None:
        (largest, _), *_ = Counter(self._hosts.values()).most_common(1)
        oldest = next(transport for transport, host in self._hosts.items() if host == largest)
        del self._hosts[oldest]
        oldest.abort()


class TlsHandshake(asyncio.Protocol):
    """A connection to a TLS server until its handshake is done; then `protocol` gets the connection."""

    def __init__(self, protocol: asyncio.Protocol, context: ssl.SSLContext, handshakes: Handshakes) -> None:
        self._protocol = protocol
        self._context = context
        self._handshakes = handshakes
        self._task: asyncio.Task[None] | None = None

    @property
    def protocol(self) -> object:
        """The sans-IO protocol of a WebSocket, which its library looks for when it chooses a subprotocol."""
        return getattr(self._protocol, "protocol", None)

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Start the handshake."""
        transport.pause_reading()  # the first bytes are for TLS, which starts later
        self._handshakes.begin(transport)
        self._task = asyncio.get_running_loop().create_task(self._run(transport))

    async def _run(self, transport: asyncio.Transport) -> None:
        early = _EarlyBytes()
        try:
            secure = await asyncio.get_running_loop().start_tls(
                transport,
                early,
                self._context,
                server_side=True,
                ssl_handshake_timeout=HANDSHAKE_TIMEOUT,
            )
        except OSError:
            transport.abort()
        else:
            if secure is not None and not transport.is_closing():
                early.hand_over(secure, self._protocol)
        finally:
            self._handshakes.end(transport)


class _EarlyBytes(asyncio.Protocol):
    """Keeps what arrives between the end of the TLS handshake and its notice."""

    def __init__(self) -> None:
        self._calls: list[Callable[[asyncio.Protocol], object]] = []

    def data_received(self, data: bytes) -> None:
        self._calls.append(lambda protocol: protocol.data_received(data))

    def eof_received(self) -> None:
        self._calls.append(lambda protocol: protocol.eof_received())

    def connection_lost(self, exc: Exception | None) -> None:
        self._calls.append(lambda protocol: protocol.connection_lost(exc))

    def hand_over(self, transport: asyncio.Transport, protocol: asyncio.Protocol) -> None:
        """Let another protocol go on with the connection."""
        transport.set_protocol(protocol)
        protocol.connection_made(transport)
        for call in self._calls:
            call(protocol)
