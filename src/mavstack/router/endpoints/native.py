"""Endpoints whose descriptors the engine reads and writes itself: UDP, TCP, Unix sockets, serial ports.

Python opens them and opens them again; no packet passes through it.
"""

from __future__ import annotations

import asyncio
import logging
from abc import abstractmethod
from itertools import count
from time import monotonic
from typing import TYPE_CHECKING

from mavstack.errors import LinkError
from mavstack.links.address import format_address
from mavstack.links.os_errors import open_error
from mavstack.links.stream import keep_alive, send_at_once
from mavstack.links.tcp import TcpServer
from mavstack.links.unix import UnixServer
from mavstack.router.endpoints.base import DOWN, ENDED, LISTENING, Endpoint
from mavstack.router.firewall import Peer

if TYPE_CHECKING:
    import socket
    from collections.abc import Sequence

    from serial import Serial

    from mavstack.links.connection import ClientLink
    from mavstack.links.serial import SerialLink
    from mavstack.links.tcp import TcpClient
    from mavstack.links.udp import UdpListener, UdpSender
    from mavstack.links.unix import UnixClient
    from mavstack.router.attachments import Attachments
    from mavstack.router.config import EndpointConfig

_log = logging.getLogger("mavstack.router")
#: Seconds after which a server accepts again when the system had no descriptors left.
ACCEPT_PAUSE = 1.0
#: A connection that lasted longer resets the delay before the next attempt, in seconds.
STABLE_TIME = 5.0
#: Seconds of a serial line's rate that wait to be sent on it, and the fewest bytes: those of several packets.
LINE_QUEUE_TIME = 0.5
MIN_LINE_QUEUE = 4096
BITS_PER_BYTE = 10  # with start and stop bit


class UdpEndpoint(Endpoint):
    """A UDP socket; the engine knows its peers."""

    def __init__(
        self, config: EndpointConfig, attachments: Attachments, link: UdpListener | UdpSender
    ) -> None:
        super().__init__(config, attachments)
        self._link = link

    @property
    def address(self) -> tuple[str, int] | None:
        """Host and port on which the socket listens."""
        return self._link.address

    async def open(self) -> None:
        """Open the socket."""
        engine, name = self._attachments.engine, self.config.name
        opened = await self._link.open_socket()
        if isinstance(opened, tuple):
            sock, peer = opened
            number = engine.add_udp(sock.fileno(), name=name, peer=peer[:2], start=False)
            self._attach(number, name, peer=_peer_of(peer))
        else:
            idle, max_peers = getattr(self._link, "idle", 60.0), getattr(self._link, "max_peers", 256)
            number = engine.add_udp(
                opened.fileno(),
                name=name,
                idle=idle or float(1 << 30),
                max_peers=max_peers,
                start=False,
            )
            self._attach(number, name, listening=True)

    def link_closed(self, number: int, reason: str) -> None:
        """End, because the socket failed."""
        super().link_closed(number, reason)
        self.state = ENDED

    async def close(self) -> None:
        """Close the socket."""
        await super().close()
        await self._link.close()


class ClientEndpoint(Endpoint):
    """A connection that is opened again when it is lost."""

    def __init__(self, config: EndpointConfig, attachments: Attachments, link: ClientLink) -> None:
        super().__init__(config, attachments)
        self._link = link
        self._lost = asyncio.Event()
        self._peer: Peer | None = None

    async def open(self) -> None:
        """Connect; with `wait=yes` in the background."""
        if not self._link.wait_for_peer:
            await self._connect()
        self._spawn(self._maintain())

    def link_closed(self, number: int, reason: str) -> None:
        """Connect again."""
        super().link_closed(number, reason)
        self._release()
        self._lost.set()

    async def close(self) -> None:
        """Close the connection."""
        await super().close()
        self._release()
        await self._link.close()

    @abstractmethod
    async def _add(self) -> int:
        """Connect once and return the engine's number; raises `OSError` or `LinkError`."""

    def _release(self) -> None:
        """Release what belongs to a lost connection."""

    async def _connect(self) -> None:
        try:
            number = await self._add()
        except OSError as error:
            raise open_error(self._link.url, error) from error
        self._lost.clear()
        self._attach(number, self.config.name, peer=self._peer)
        _log.info("endpoint %s is open", self.config.name)

    async def _maintain(self) -> None:
        delays = self._link.backoff.delays()
        while True:
            if not self._numbers:
                try:
                    await self._connect()
                except LinkError as error:
                    self.state, self.reason = DOWN, str(error)
                    await asyncio.sleep(next(delays))
                    continue
            opened = monotonic()
            await self._lost.wait()
            _log.warning("endpoint %s is down: %s", self.config.name, self.reason)
            if not self._link.reconnect:
                self.state = ENDED
                return
            if monotonic() - opened > STABLE_TIME:
                delays = self._link.backoff.delays()
            self.state = DOWN
            self.reconnections += 1
            await asyncio.sleep(next(delays))


class SocketEndpoint(ClientEndpoint):
    """A connected TCP or Unix socket."""

    def __init__(
        self, config: EndpointConfig, attachments: Attachments, link: TcpClient | UnixClient
    ) -> None:
        super().__init__(config, attachments, link)
        self._connector = link

    async def _add(self) -> int:
        framed = getattr(self._connector, "framed", False)
        with await self._connector.connect_socket() as sock:
            self._peer = _peer_of(sock.getpeername())
            if self._peer is not None:
                send_at_once(sock)
            return self._attachments.engine.add_stream(
                sock.fileno(),
                name=self.config.name,
                framing="length" if framed else "none",
                queue_bytes=self._link.send_queue,
                start=False,
            )


class SerialEndpoint(ClientEndpoint):
    """A serial port, open exclusively."""

    def __init__(self, config: EndpointConfig, attachments: Attachments, link: SerialLink) -> None:
        super().__init__(config, attachments, link)
        self._serial = link
        self._port: Serial | None = None

    async def _add(self) -> int:
        from mavstack.links.serial import block_for_one_byte

        self._port = port = self._serial.open_port()
        try:
            block_for_one_byte(port.fileno())
            return self._attachments.engine.add_stream(
                port.fileno(), name=self.config.name, queue_bytes=queue_of_line(self._serial), start=False
            )
        except BaseException:
            self._release()
            raise

    def _release(self) -> None:
        if self._port is not None:
            self._port.close()
            self._port = None


class ServerEndpoint(Endpoint):
    """A listening TCP or Unix socket; each client is a link of its own, with its own routes and queue.

    Attributes:
        refused: Clients that were refused because there were too many.
    """

    def __init__(
        self, config: EndpointConfig, attachments: Attachments, link: TcpServer | UnixServer
    ) -> None:
        super().__init__(config, attachments)
        self._link = link
        self._framed = getattr(link, "framed", False)
        self._sockets: Sequence[socket.socket] = ()
        self._counter = count(1)
        self.refused = 0

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
        loop = asyncio.get_running_loop()
        while True:
            try:
                client, address = await loop.sock_accept(sock)
            except OSError as error:  # such as too many open files, or a client that left already
                _log.warning("endpoint %s: accepting a client failed: %s", self.config.name, error)
                await asyncio.sleep(ACCEPT_PAUSE)
                continue
            with client:
                self._admit(client, address)

    def _admit(self, client: socket.socket, address: object) -> None:
        if len(self._numbers) >= self._link.max_peers:
            self.refused += 1
            _log.warning(
                "endpoint %s: a client was refused: there are %d", self.config.name, len(self._numbers)
            )
            return
        is_tcp = isinstance(address, tuple)
        peer = format_address(address) if isinstance(address, tuple) else f"#{next(self._counter)}"
        name = f"{self.config.name} {peer}"
        if is_tcp:
            keep_alive(client)
            send_at_once(client)
        number = self._attachments.engine.add_stream(
            client.fileno(),
            name=name,
            framing="length" if self._framed else "none",
            queue_bytes=self._link.send_queue,
            start=False,
        )
        self._attach(number, name, peer=_peer_of(address))
        _log.info("%s connected", name)


def queue_of_line(link: SerialLink) -> int:
    """Return the bytes that wait for a serial line: what it sends in half a second, not stale telemetry."""
    return min(link.send_queue, max(MIN_LINE_QUEUE, int(link.baud / BITS_PER_BYTE * LINE_QUEUE_TIME)))


def _peer_of(address: object) -> Peer | None:
    """Return the peer at an IP address; None for a path."""
    return Peer(*address[:2]) if isinstance(address, tuple) else None
