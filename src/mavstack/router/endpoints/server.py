"""Endpoints that listen, and whose clients the engine reads and writes itself: TCP and Unix sockets."""

from __future__ import annotations

import asyncio
import logging
from contextlib import suppress
from itertools import count
from time import monotonic
from typing import TYPE_CHECKING, Final

from mavstack.links.address import format_address
from mavstack.links.stream import keep_alive, send_at_once
from mavstack.links.tcp import TcpServer
from mavstack.links.unix import UnixServer
from mavstack.router.endpoints.base import LISTENING, Endpoint
from mavstack.router.endpoints.client_proofs import ClientProofs
from mavstack.router.peer import Peer
from mavstack.security.admission import Admission

if TYPE_CHECKING:
    import socket
    from collections.abc import Sequence

    from mavstack.router.attachments import Attachments
    from mavstack.router.config import EndpointConfig

_log = logging.getLogger("mavstack.router")
#: Seconds until a server accepts clients again after an error, such as too many open files.
ACCEPT_PAUSE: Final = 1.0
#: Seconds between two log lines about clients that were refused because the server was full.
WARN_INTERVAL: Final = 1.0


class ServerEndpoint(Endpoint):
    """A listening TCP or Unix socket; each client is a link of its own, with its own routes and queue.

    Attributes:
        refused: Clients that were refused because there were too many.
        replaced: Clients that were closed to make room for others (see `mavstack.security.admission`).
    """

    def __init__(
        self, config: EndpointConfig, attachments: Attachments, link: TcpServer | UnixServer
    ) -> None:
        super().__init__(config, attachments)
        self._link = link
        self._framed = getattr(link, "framed", False)
        self._sockets: Sequence[socket.socket] = ()
        self._counter = count(1)
        self._admission = Admission(link.max_peers)
        self._proofs = ClientProofs(attachments.engine)
        self.refused = self.replaced = 0
        self._warned_at = float("-inf")

    @property
    def address(self) -> tuple[str, int] | None:
        """Host and port on which the first socket listens, or None."""
        return self._sockets[0].getsockname()[:2] if self._sockets and not self._link.url.path else None

    async def open(self) -> None:
        """Listen."""
        link = self._link
        self._sockets = await link.open_sockets() if isinstance(link, TcpServer) else [link.open_socket()]
        self.state = LISTENING
        for sock in self._sockets:
            self._spawn(self._accept(sock))

    def link_closed(self, number: int, reason: str) -> None:
        """Forget a client that left."""
        name = self._numbers.get(number, "")
        super().link_closed(number, reason)
        _log.info("%s left: %s", name, reason)
        self.reason = ""
        self.state = LISTENING if not self._numbers else self.state

    def _detach(self, number: int) -> None:
        super()._detach(number)
        self._proofs.remove(number)

    async def close(self) -> None:
        """Stop listening, and close all clients."""
        await super().close()
        for sock in self._sockets:
            sock.close()
        if self._sockets and isinstance(self._link, UnixServer):
            self._link.remove_path()
        self._sockets = ()
        await self._link.close()

    async def _accept(self, sock: socket.socket) -> None:
        while True:
            try:
                client, address = await _accepted(sock)
            except OSError as error:
                # for example too many open files, or a client that closed its connection already
                _log.warning("endpoint %s: accepting a client failed: %s", self.config.name, error)
                await asyncio.sleep(ACCEPT_PAUSE)
                continue
            with client:
                self._admit(client, address)

    def _admit(self, client: socket.socket, address: object) -> None:
        host = str(address[0]) if isinstance(address, tuple) else ""
        if not self._make_room(host):
            self.refused += 1
            self._warn("a client was refused")
            return
        peer = format_address(address) if isinstance(address, tuple) else f"#{next(self._counter)}"
        name = f"{self.config.name} {peer}"
        if isinstance(address, tuple):
            keep_alive(client)
            send_at_once(client)
        number = self._attachments.engine.add_stream(
            client.fileno(),
            name=name,
            framing="length" if self._framed else "none",
            queue_bytes=self._link.send_queue,
            start=False,
        )
        self._proofs.add(number, host, monotonic())
        self._attach(number, name, peer=_peer_of(address))
        _log.info("%s connected", name)

    def _make_room(self, host: str) -> bool:
        """Return whether a new client may be added; a full server closes another one for it."""
        if len(self._numbers) < self._link.max_peers:
            return True
        now = monotonic()
        admitted, leaving = self._admission.admit(host, self._proofs.places(now), now)
        if leaving is not None:
            self.replaced += 1
            self._warn(f"{self._numbers.get(leaving, '')} was closed to make room for another client")
            self._detach(leaving)
        return admitted

    def _warn(self, event: str) -> None:
        """Log an event of a full server; of many in a short time the first one."""
        now = monotonic()
        if now - self._warned_at >= WARN_INTERVAL:
            self._warned_at = now
            _log.warning("endpoint %s is full (%d clients): %s", self.config.name, len(self._numbers), event)


def _peer_of(address: object) -> Peer | None:
    """Return the peer at an IP address; None for a path."""
    return Peer(*address[:2]) if isinstance(address, tuple) else None


async def _accepted(sock: socket.socket) -> tuple[socket.socket, object]:
    """Return the next client and its address, without `sock_accept` of the loop, which loads OpenSSL."""
    loop = asyncio.get_running_loop()
    while True:
        with suppress(BlockingIOError, InterruptedError):
            client, address = sock.accept()
            client.setblocking(False)
            return client, address
        readable = asyncio.Event()
        try:
            loop.add_reader(sock, readable.set)
        except NotImplementedError:  # an event loop without socket readers (Windows)
            return await loop.sock_accept(sock)
        try:
            await readable.wait()
        finally:
            loop.remove_reader(sock)
