"""The other end of a link under test, implemented with plain sockets and files instead of our own links."""

from __future__ import annotations

import asyncio
import os
import socket
from typing import Protocol


class Peer(Protocol):
    async def send(self, data: bytes) -> None: ...
    async def receive(self, count: int) -> bytes: ...
    async def close(self) -> None: ...


class UdpPeer:
    def __init__(self, target: tuple[str, int] | None = None) -> None:
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 20)
        self.socket.setblocking(False)
        self.socket.bind(("127.0.0.1", 0))
        self.target = target

    @property
    def port(self) -> int:
        return self.socket.getsockname()[1]

    async def send(self, data: bytes) -> None:
        self.socket.sendto(data, self.target)
        await asyncio.sleep(0)

    async def receive(self, count: int) -> bytes:
        data = b""
        while len(data) < count:
            piece, self.target = await asyncio.get_running_loop().sock_recvfrom(self.socket, 65536)
            data += piece
        return data

    async def close(self) -> None:
        self.socket.close()


class StreamPeer:
    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self.reader, self.writer = reader, writer

    async def send(self, data: bytes) -> None:
        self.writer.write(data)
        await self.writer.drain()

    async def receive(self, count: int) -> bytes:
        return await self.reader.readexactly(count)

    async def close(self) -> None:
        self.writer.close()
        await asyncio.gather(self.writer.wait_closed(), return_exceptions=True)


class Acceptor:
    """A stream server that queues its connections."""

    def __init__(self) -> None:
        self.accepted: asyncio.Queue[StreamPeer] = asyncio.Queue()
        self.peers: list[StreamPeer] = []
        self.server: asyncio.Server | None = None

    async def listen_tcp(self, port: int = 0, **options) -> int:
        self.server = await asyncio.start_server(self._accept, "127.0.0.1", port, **options)
        return self.server.sockets[0].getsockname()[1]

    async def listen_unix(self, path) -> None:
        self.server = await asyncio.start_unix_server(self._accept, path)

    def _accept(self, reader, writer) -> None:
        peer = StreamPeer(reader, writer)
        self.peers.append(peer)
        self.accepted.put_nowait(peer)

    async def close(self) -> None:
        self.server.close()
        for peer in self.peers:
            await peer.close()
        await self.server.wait_closed()


class PtyPeer:
    """The other end of a pseudo-terminal; `path` is the device."""

    def __init__(self) -> None:
        self.master, self.slave = os.openpty()
        self.path = os.ttyname(self.slave)
        os.set_blocking(self.master, False)

    async def _ready(self, add, remove) -> None:
        future = asyncio.get_running_loop().create_future()
        add(self.master, lambda: future.done() or future.set_result(None))
        try:
            await future
        finally:
            remove(self.master)

    async def send(self, data: bytes) -> None:
        loop = asyncio.get_running_loop()
        while data:
            await self._ready(loop.add_writer, loop.remove_writer)
            data = data[os.write(self.master, data) :]

    async def receive(self, count: int) -> bytes:
        loop = asyncio.get_running_loop()
        data = b""
        while len(data) < count:
            await self._ready(loop.add_reader, loop.remove_reader)
            data += os.read(self.master, count - len(data))
        return data

    async def close(self) -> None:
        if self.master >= 0:
            os.close(self.master)
            os.close(self.slave)
            self.master = -1


class LinkPeer:
    """The other link of a memory pair."""

    def __init__(self, link) -> None:
        self.link = link

    async def send(self, data: bytes) -> None:
        self.link.channels[0].write(data)
        await asyncio.sleep(0)

    async def receive(self, count: int) -> bytes:
        data = b""
        while len(data) < count:
            event = await anext(self.link)
            data += getattr(event, "data", b"")
        return data

    async def close(self) -> None:
        await self.link.close()
