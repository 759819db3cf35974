"""Sockets alone, which look at nothing that they receive: what Python itself costs."""

from __future__ import annotations

import asyncio
import socket

from .child import Ear, serve

LARGEST = 1 << 16


def _blocking(ear: Ear) -> None:
    """A loop of blocking calls."""
    sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sock.bind(("127.0.0.1", ear.port))
    while True:
        sock.recvfrom(LARGEST)
        ear.hear()


class _Protocol(asyncio.DatagramProtocol):
    def __init__(self, ear: Ear) -> None:
        self._ear = ear

    def datagram_received(self, data: bytes, addr: tuple[str, int]) -> None:
        self._ear.hear()


async def _datagrams(ear: Ear) -> None:
    loop = asyncio.get_running_loop()
    await loop.create_datagram_endpoint(lambda: _Protocol(ear), local_addr=("127.0.0.1", ear.port))
    await loop.create_future()


if __name__ == "__main__":
    serve({"blocking": _blocking, "asyncio": lambda ear: asyncio.run(_datagrams(ear))})
