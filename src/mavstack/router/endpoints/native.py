"""Endpoints whose descriptors the engine reads and writes itself: UDP, TCP, Unix sockets, serial ports.

Python opens them and opens them again; no packet passes through it.
"""

from __future__ import annotations

import asyncio
import logging
from abc import abstractmethod
from time import monotonic
from typing import TYPE_CHECKING

from mavstack.errors import LinkError
from mavstack.links.os_errors import open_error
from mavstack.links.stream import send_at_once
from mavstack.router.endpoints.base import DOWN, ENDED, Endpoint
from mavstack.router.peer import Peer

if TYPE_CHECKING:
    from serial import Serial

    from mavstack.links.connection import ClientLink
    from mavstack.links.serial import SerialLink
    from mavstack.links.tcp import TcpClient
    from mavstack.links.udp import UdpListener
    from mavstack.links.udp_sender import UdpSender
    from mavstack.links.unix import UnixClient
    from mavstack.router.attachments import Attachments
    from mavstack.router.config import EndpointConfig

_log = logging.getLogger("mavstack.router")
#: Seconds: a connection that lasted longer resets the delay before the next attempt to connect.
STABLE_TIME = 5.0
#: Size of a serial line's send queue: in seconds at its baud rate, and at least in bytes.
LINE_QUEUE_TIME = 0.5
MIN_LINE_QUEUE = 4096
BITS_PER_BYTE = 10  # 8 data bits, a start bit and a stop bit


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
                trusts_senders=getattr(self._link, "router_trusts_senders", False),
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


def queue_of_line(link: SerialLink) -> int:
    """Return the bytes that wait for a serial line: what it sends in half a second, not stale telemetry."""
    return min(link.send_queue, max(MIN_LINE_QUEUE, int(link.baud / BITS_PER_BYTE * LINE_QUEUE_TIME)))


def _peer_of(address: object) -> Peer | None:
    """Return the peer at an IP address; None for a path."""
    return Peer(*address[:2]) if isinstance(address, tuple) else None
