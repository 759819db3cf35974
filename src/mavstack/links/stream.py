"""A connection over asyncio's streams: TCP, TLS, unix sockets and, on POSIX, serial ports.

The bounded queue for sending is the transport's own buffer; receiving stops while nobody makes room in the
inbox, so that the kernel's flow control slows the peer and nothing is lost.
"""

from __future__ import annotations

import asyncio
import socket
from contextlib import suppress
from time import time
from typing import TYPE_CHECKING

from mavstack.errors import LinkClosedError
from mavstack.links.connection import Connection

if TYPE_CHECKING:
    from asyncio.trsock import TransportSocket
    from collections.abc import Callable, Iterable

    from mavstack.links.channel import Channel, Data
    from mavstack.links.inbox import Inbox

CHUNK = 1 << 16


class StreamConnection(Connection):
    """One stream, read by its link's task and written at once or from the transport's buffer."""

    def __init__(
        self,
        name: str,
        peer: str,
        gone: Callable[[Channel, str], None],
        streams: tuple[asyncio.StreamReader, asyncio.StreamWriter],
        send_queue: int,
    ) -> None:
        super().__init__(name, peer, gone)
        self._reader, self._writer = streams
        self._send_queue = send_queue
        self._writer.transport.set_write_buffer_limits(high=send_queue // 2)

    async def pump(self, inbox: Inbox) -> str:
        """Read until the peer hangs up or fails."""
        try:
            while data := await self._reader.read(CHUNK):
                if not self.closed:
                    inbox.put(self, data, time())
                    await inbox.room()
        except OSError as error:
            return error.strerror or str(error)
        return "closed by the peer"

    async def drain(self) -> None:
        """Wait until less than half of the queue is in use."""
        try:
            await self._writer.drain()
        except OSError as error:
            raise LinkClosedError(f"{self.name} is closed") from error

    async def wait_closed(self) -> None:
        """Wait until the transport has sent what it buffered."""
        with suppress(OSError):
            await self._writer.wait_closed()

    def abort(self) -> None:
        """Close the transport without sending what it buffered."""
        self._writer.transport.abort()

    def _send(self, data: Data) -> bool:
        transport = self._writer.transport
        if transport.is_closing() or transport.get_write_buffer_size() + len(data) > self._send_queue:
            return False
        self._writer.write(data)
        return True

    def _shut(self) -> None:
        self._writer.close()


async def stop_accepting(sockets: Iterable[TransportSocket | socket.socket]) -> None:
    """Let connections that were accepted a moment ago arrive, before their server is closed.

    Closing at once would orphan them: asyncio drops such a connection without closing it, and its peer would
    wait for ever.
    """
    for sock in sockets:
        with suppress(NotImplementedError, RuntimeError):  # Windows' event loop accepts in another way
            asyncio.get_running_loop().remove_reader(sock)
    for _ in range(3):
        await asyncio.sleep(0)


def keep_alive(writer: asyncio.StreamWriter) -> None:
    """Let the kernel find out, within about a minute, that a silent TCP peer is gone."""
    sock = writer.get_extra_info("socket")
    settings = {"SO_KEEPALIVE": 1, "TCP_KEEPIDLE": 30, "TCP_KEEPINTVL": 10, "TCP_KEEPCNT": 3}
    for name, value in settings.items():
        option = getattr(socket, name, None)  # not every system has all of them
        if option is not None:
            level = socket.SOL_SOCKET if name.startswith("SO_") else socket.IPPROTO_TCP
            with suppress(OSError):
                sock.setsockopt(level, option, value)
