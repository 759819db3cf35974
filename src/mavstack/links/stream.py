"""Channels over asyncio's streams: TCP, TLS, unix sockets and, on POSIX, serial ports.

The send queue is the transport's own buffer. Reading pauses while the receive queue is full, so that the
kernel's flow control slows down the peer and no bytes are lost.

A caller of `Link.read` with `direct=True` gets bytes from the transport, without a task that is woken for
them: a request and its reply then cost two turns of the event loop instead of three.
"""

from __future__ import annotations

import asyncio
import os
import socket
from contextlib import suppress
from time import time
from typing import TYPE_CHECKING

from mavstack.errors import LinkClosedError, LinkError
from mavstack.links.connection import ConnectionChannel
from mavstack.links.framing import FrameReader, frame

if TYPE_CHECKING:
    from asyncio.trsock import TransportSocket
    from collections.abc import Awaitable, Callable, Iterable

    from mavstack.links.channel import Channel, Data
    from mavstack.links.inbox import Inbox

MAX_READ = 1 << 16
#: Maximum number of unsent bytes in the kernel for a TCP connection (`send_at_once`).
MAX_UNSENT = 16 << 10


class DirectProtocol(asyncio.StreamReaderProtocol):
    """The protocol of a stream, whose bytes a channel may take before its reader.

    Attributes:
        take: Takes received bytes, or returns False for those that the stream's reader gets.
        passed: Number of bytes that the stream's reader got.
    """

    take: Callable[[bytes], bool] | None = None
    passed = 0

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Read less at once: asyncio allocates 256 KiB for each read, which costs more than a short one."""
        super().connection_made(transport)
        if hasattr(transport, "max_size"):
            transport.max_size = MAX_READ

    def data_received(self, data: bytes) -> None:
        """Pass bytes to the channel, or to the reader."""
        if self.take is None or not self.take(data):
            self.passed += len(data)
            super().data_received(data)


async def connect_stream(
    connect: Callable[[Callable[[], DirectProtocol]], Awaitable[tuple[asyncio.Transport, DirectProtocol]]],
) -> tuple[asyncio.StreamReader, asyncio.StreamWriter]:
    """Connect a stream, as `asyncio.open_connection` does, with a `DirectProtocol`.

    Args:
        connect: Connects a transport with the protocol that the function makes.
    """
    loop = asyncio.get_running_loop()
    reader = asyncio.StreamReader(loop=loop)
    transport, protocol = await connect(lambda: DirectProtocol(reader, loop=loop))
    return reader, asyncio.StreamWriter(transport, protocol, reader, loop)


class StreamChannel(ConnectionChannel):
    """A channel over one stream, read by a task of its link and written through the transport."""

    def __init__(
        self,
        name: str,
        peer: str,
        on_closed: Callable[[Channel, str], None],
        streams: tuple[asyncio.StreamReader, asyncio.StreamWriter],
        send_queue: int,
        *,
        framed: bool = False,
    ) -> None:
        super().__init__(name, peer, on_closed)
        self._frames = FrameReader() if framed else None
        self._reader, self._writer = streams
        self._send_queue = send_queue
        self._read_transport: asyncio.BaseTransport = self._writer.transport
        self._is_behind = True  # True while the reader may hold received bytes
        self._taken = 0  # bytes taken from the reader
        self._inbox: Inbox | None = None  # while it is read
        self._is_passed = False  # another reader reads the stream, or will
        self._failure = 0  # number of the error that another reader of the stream got
        self._writer.transport.set_write_buffer_limits(high=send_queue // 2)

    async def receive_all(self, inbox: Inbox) -> str:
        """Read until the connection ends."""
        self._take_directly(inbox)
        self._inbox = inbox
        try:
            while data := await self._reader.read(MAX_READ):
                self._taken += len(data)
                self._is_behind = len(data) == MAX_READ
                self._receive(data, inbox)
                await inbox.wait_for_room()
        except OSError as error:
            return error.strerror or str(error)
        except LinkError as error:
            return str(error)
        return os.strerror(self._failure) if self._failure else "closed by the peer"

    def may_be_read_natively(self) -> bool:
        """Return whether a thread of the core can read the stream: all its bytes are packets."""
        transport, protocol = self._read_transport, self._read_transport.get_protocol()
        is_plain = self._frames is None and self.role_filter is None and not self._is_encrypted()
        is_native = isinstance(protocol, DirectProtocol) and hasattr(transport, "pause_reading")
        return is_plain and is_native and not self.closed

    def _is_encrypted(self) -> bool:
        return self._read_transport.get_extra_info("sslcontext") is not None

    def pass_stream(self) -> int | None:
        """Stop reading; return the descriptor of the stream, or None while received bytes wait."""
        transport, protocol = self._read_transport, self._read_transport.get_protocol()
        is_read = self._inbox is not None and self._inbox.is_read
        if not (
            is_read and isinstance(protocol, DirectProtocol) and isinstance(transport, asyncio.ReadTransport)
        ):
            return None
        self._is_passed = True
        transport.pause_reading()
        if protocol.passed != self._taken or transport.is_closing():
            return None  # the bytes come soon, and the node asks again
        source = transport.get_extra_info("socket") or transport.get_extra_info("pipe")
        return int(source.fileno())

    def read_itself(self, error: int = 0) -> None:
        """Read the stream by the event loop again, after another reader of it got an error or 0."""
        transport, is_passed = self._read_transport, self._is_passed
        self._is_passed, self._failure = False, error
        if is_passed and isinstance(transport, asyncio.ReadTransport) and not transport.is_closing():
            transport.resume_reading()

    def _take_directly(self, inbox: Inbox) -> None:
        """Let the protocol pass bytes directly, while the reader has none that came before."""

        def take(data: bytes) -> bool:
            if self._is_behind or not inbox.is_direct:
                self._is_behind = True
                return False
            self._receive(data, inbox)
            return True

        protocol = self._read_transport.get_protocol()
        if isinstance(protocol, DirectProtocol) and self._frames is None:
            protocol.take = take

    def _receive(self, data: bytes, inbox: Inbox) -> None:
        if self.closed:
            return
        self.last_received = now = time()
        for chunk in (data,) if self._frames is None else self._frames.feed(data):
            if allowed := self.allowed(chunk):
                inbox.receive(self, allowed, now)

    async def drain(self) -> None:
        """Wait until less than half of the send queue is in use."""
        try:
            await self._writer.drain()
        except OSError as error:
            raise LinkClosedError(f"{self.name} is closed") from error

    async def wait_closed(self) -> None:
        """Wait until the transport has sent its buffer."""
        with suppress(OSError):
            await self._writer.wait_closed()

    def abort(self) -> None:
        """Close the transport without sending its buffer."""
        self._writer.transport.abort()

    def send_bytes(self, data: Data) -> bool:
        """Send or queue a chunk."""
        transport = self._writer.transport
        if self._frames is not None:
            data = frame(data)
        if transport.is_closing() or transport.get_write_buffer_size() + len(data) > self._send_queue:
            return False
        self._writer.write(data)
        return True

    def close_transport(self) -> None:
        """Start closing the transport."""
        self._writer.close()


async def stop_accepting(sockets: Iterable[TransportSocket | socket.socket]) -> None:
    """Stop accepting, and wait for connections that the event loop is accepting.

    If the server is closed immediately, asyncio drops such a connection without closing it, and the peer
    waits for ever.
    """
    for sock in sockets:
        with suppress(NotImplementedError, RuntimeError):  # the event loop of Windows has no readers
            asyncio.get_running_loop().remove_reader(sock)
    for _ in range(3):
        await asyncio.sleep(0)


def enable_keepalive(writer: asyncio.StreamWriter) -> None:
    """Enable TCP keepalive of a stream (see `keep_alive`)."""
    keep_alive(writer.get_extra_info("socket"))


def send_at_once(sock: socket.socket) -> None:
    """Send small packets of a TCP connection without delay, and limit the unsent bytes that the system takes.

    The others wait in the program, which can send urgent packets first.
    """
    with suppress(OSError):
        sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    option = getattr(socket, "TCP_NOTSENT_LOWAT", None)  # some systems lack this option
    if option is not None:
        with suppress(OSError):
            sock.setsockopt(socket.IPPROTO_TCP, option, MAX_UNSENT)


def keep_alive(sock: socket.socket) -> None:
    """Enable TCP keepalive, so that a lost peer is detected within about a minute."""
    settings = {"SO_KEEPALIVE": 1, "TCP_KEEPIDLE": 30, "TCP_KEEPINTVL": 10, "TCP_KEEPCNT": 3}
    for name, value in settings.items():
        option = getattr(socket, name, None)  # some systems lack this option
        if option is not None:
            level = socket.SOL_SOCKET if name.startswith("SO_") else socket.IPPROTO_TCP
            with suppress(OSError):
                sock.setsockopt(level, option, value)
