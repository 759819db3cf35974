"""Delays of a server between the wire and its clients, in both directions."""

from __future__ import annotations

import random
import select
import socket
from http.client import HTTPConnection
from time import monotonic, perf_counter, sleep
from typing import TYPE_CHECKING

from mavstack.dialects import ardupilotmega as dialect
from mavstack.wire import Encoder

from .websocket import BINARY, HOST, TEXT, WebSocket, handshake

if TYPE_CHECKING:
    from typing import Self

    from .api_servers import Ports, Server, Socket

SYSTEM, CLIENT_SYSTEM, CLIENT_COMPONENT = 200, 253, 190
TIMEOUT = 5.0
#: The mark of the first message; its digits occur in no other message.
FIRST_MARK = 739_100_000
#: The longest pause between two measurements in seconds, so that they meet all phases of batches.
MAX_PAUSE = 0.02


class _Client(WebSocket):
    """A client that waits for a mark."""

    mark = b""
    found_at = 0.0

    def take(self, opcode: int, data: bytes, start: int, end: int) -> None:
        """Note the time if a message has the mark."""
        if opcode in (TEXT, BINARY) and self.mark and data.find(self.mark, start, end) >= 0:
            self.found_at = perf_counter()

    def drain(self) -> None:
        """Read all that has arrived."""
        while select.select([self.sock], [], [], 0)[0]:
            self.read()

    def wait(self) -> float:
        """Return the time at which the mark arrives."""
        end = monotonic() + TIMEOUT
        while not self.found_at:
            if not select.select([self.sock], [], [], max(end - monotonic(), 0.0))[0]:
                raise SystemExit("a packet did not reach a WebSocket")
            self.read()
        return self.found_at


class Delays:
    """A vehicle on the source of a server, and its clients; each method returns seconds."""

    def __init__(self, server: Server, ports: Ports) -> None:
        self._server = server
        self._mark = FIRST_MARK
        self._random = random.Random(1)
        self._vehicle = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._vehicle.settimeout(TIMEOUT)
        self._vehicle.connect((HOST, ports.source))
        self._encoder = Encoder(SYSTEM, 1)
        self._own = Encoder(CLIENT_SYSTEM, CLIENT_COMPONENT)
        self._http = HTTPConnection(HOST, ports.http)
        self._json = _connected(server.json_socket(ports))
        raw = server.raw_socket(ports)
        self._raw = None if raw is None else _connected(raw)

    @property
    def has_raw(self) -> bool:
        """True if the server has a WebSocket with raw packets."""
        return self._raw is not None

    def json(self) -> float:
        """Measure from a packet of the vehicle to the client with JSON."""
        self._begin()
        return self._received(self._json, str(self._mark).encode())

    def raw(self) -> float:
        """Measure from a packet of the vehicle to the client with raw packets."""
        self._begin()
        assert self._raw is not None
        return self._received(self._raw, self._mark.to_bytes(4, "little"))

    def post(self) -> float:
        """Measure from an HTTP request to the packet at the vehicle."""
        self._begin()
        body, started = self._server.post_body(self._mark), perf_counter()
        self._http.request("POST", self._server.post, body, {"Content-Type": "application/json"})
        arrived = self._arrival()
        answer = self._http.getresponse()
        answer.read()
        if answer.status != 200:
            raise SystemExit(f"{self._server.name} answered {answer.status}")
        return arrived - started

    def text(self) -> float:
        """Measure from a text by WebSocket to the packet at the vehicle."""
        self._begin()
        text, started = self._server.text(self._mark), perf_counter()
        self._json.send(TEXT, text)
        return self._arrival() - started

    def binary(self) -> float:
        """Measure from a raw packet by WebSocket to the packet at the vehicle."""
        self._begin()
        packet = self._own.encode(dialect.Debug(time_boot_ms=self._mark))
        assert self._raw is not None
        started = perf_counter()
        self._raw.send(BINARY, packet)
        return self._arrival() - started

    def _begin(self) -> None:
        """Send a heartbeat, read what is old, and wait for a moment that no batch determines."""
        self._mark += 1
        heartbeat = dialect.Heartbeat(type=2, autopilot=3, system_status=3, mavlink_version=3)
        self._vehicle.send(self._encoder.encode(heartbeat))
        sleep(self._random.uniform(0, MAX_PAUSE))
        for client in filter(None, (self._json, self._raw)):
            client.mark, client.found_at = b"", 0.0
            client.drain()

    def _received(self, client: _Client, mark: bytes) -> float:
        packet = self._encoder.encode(dialect.Debug(time_boot_ms=self._mark))
        client.mark, started = mark, perf_counter()
        self._vehicle.send(packet)
        return client.wait() - started

    def _arrival(self) -> float:
        mark = self._mark.to_bytes(4, "little")
        while True:
            data = self._vehicle.recv(4096)
            arrived = perf_counter()
            if mark in data:
                return arrived

    def __enter__(self) -> Self:
        self._begin()
        return self

    def __exit__(self, *_: object) -> None:
        self._vehicle.close()
        self._http.close()
        for client in filter(None, (self._json, self._raw)):
            client.sock.close()


def _connected(place: Socket) -> _Client:
    client = _Client(place.port, handshake(place.port, place.path, place.subprotocol))
    if place.hello:
        client.send(TEXT, place.hello.encode())
    return client
