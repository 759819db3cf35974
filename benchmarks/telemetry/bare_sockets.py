"""Bare sockets that ignore the received data: the cost of Python itself."""

from __future__ import annotations

import asyncio
import socket

from .child import MessageRecorder, serve

MAX_DATAGRAM = 1 << 16


def _blocking(recorder: MessageRecorder) -> None:
    """Receive by a loop of blocking calls."""
    sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sock.bind(("127.0.0.1", recorder.port))
    while True:
        sock.recvfrom(MAX_DATAGRAM)
        recorder.record()


class _Protocol(asyncio.DatagramProtocol):
    def __init__(self, recorder: MessageRecorder) -> None:
        self._recorder = recorder

    def datagram_received(self, data: bytes, addr: tuple[str, int]) -> None:
        self._recorder.record()


async def _datagrams(recorder: MessageRecorder) -> None:
    loop = asyncio.get_running_loop()
    await loop.create_datagram_endpoint(lambda: _Protocol(recorder), local_addr=("127.0.0.1", recorder.port))
    await loop.create_future()


if __name__ == "__main__":
    serve({"blocking": _blocking, "asyncio": lambda recorder: asyncio.run(_datagrams(recorder))})
