"""Clients of the ground station that come, read or not, and leave without a word."""

from __future__ import annotations

import random
import socket
from collections import deque

from .__main__ import HOST
from .clients import RAW
from .websocket import handshake

JSON = "mavstack.json.1"
SUBSCRIBE = b'{"subscribe": ["*"], "rate": 5}'
#: The mask of the messages of these clients.
MASK = bytes(4)
PATHS = (
    "/api/vehicles",
    "/api/vehicles/1",
    "/api/vehicles/1/telemetry",
    "/api/vehicles/1/messages",
    "/api/vehicles/1/messages/ATTITUDE",
    "/api/vehicles/1/modes?wait=false",
    "/api/statistics",
    "/api/sources",
    "/openapi.json",
    "/",
)


class Visitors:
    """Clients that come, read for a while or not, and leave."""

    def __init__(self, port: int, count: int) -> None:
        self.seen = 0
        self._port = port
        self._count = count
        self._random = random.Random(1)
        self._open: deque[tuple[socket.socket, bool]] = deque()

    def step(self) -> None:
        """Let one client come, and one leave if there are too many; read what has arrived."""
        self._open.append(self._new())
        self.seen += 1
        if len(self._open) > self._count:
            self._open.popleft()[0].close()
        for sock, reads in self._open:
            while reads and _has_read(sock):
                pass

    def close(self) -> None:
        """Let all clients leave."""
        while self._open:
            self._open.popleft()[0].close()

    def _new(self) -> tuple[socket.socket, bool]:
        sock = socket.create_connection((HOST, self._port))
        kind = self._random.choice(("raw", "lazy", "json", "request", "request"))
        if kind == "request":
            path = self._random.choice(PATHS)
            sock.sendall(f"GET {path} HTTP/1.1\r\nHost: {HOST}:{self._port}\r\n\r\n".encode())
        else:
            sock.sendall(handshake(self._port, "/ws", JSON if kind == "json" else RAW))
        if kind == "json":
            sock.sendall(bytes([0x81, 0x80 | len(SUBSCRIBE)]) + MASK + SUBSCRIBE)
        sock.setblocking(False)
        return sock, kind != "lazy"


def _has_read(sock: socket.socket) -> bool:
    try:
        return bool(sock.recv(1 << 18))
    except OSError:
        return False
