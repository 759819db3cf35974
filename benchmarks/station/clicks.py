"""The delay from a click to the packet at the vehicle: by HTTP, and by a raw WebSocket."""

from __future__ import annotations

import json
import socket
from http.client import HTTPConnection
from time import perf_counter
from typing import TYPE_CHECKING

from mavstack.dialects import Message
from mavstack.dialects import ardupilotmega as dialect
from mavstack.wire import Encoder, Parser

from .clients import RAW
from .websocket import BINARY, HOST, WebSocket, handshake

if TYPE_CHECKING:
    from typing import Self

SYSTEM, OWN_SYSTEM, OWN_COMPONENT = 200, 254, 190
TIMEOUT = 5.0
REPEAT_RELAY = 182


class Clicks:
    """A vehicle of its own on the station's source, a client of its API, and one of its WebSockets."""

    def __init__(self, port: int, source: int, echo: int) -> None:
        self._vehicle = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._vehicle.settimeout(TIMEOUT)
        self._vehicle.connect((HOST, source))
        self._encoder = Encoder(SYSTEM, 1)
        self._parser = Parser(dialect)
        self._http = HTTPConnection(HOST, port)
        self._own = Encoder(OWN_SYSTEM, OWN_COMPONENT)
        self._echo = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._echo.connect((HOST, echo))
        self._websocket = WebSocket(port, handshake(port, "/ws", RAW))

    def echo(self) -> float:
        """Return the seconds from a datagram to its echo."""
        started = perf_counter()
        self._echo.send(b"click")
        self._echo.recv(4096)
        return perf_counter() - started

    def post(self) -> float:
        """Return the seconds from a POST of a command to its arrival at the vehicle."""
        body = json.dumps({"command": REPEAT_RELAY, "params": [0, 1, 1]})
        self._beat()
        started = perf_counter()
        path, headers = f"/api/vehicles/{SYSTEM}/command", {"Content-Type": "application/json"}
        self._http.request("POST", path, body, headers)
        arrived = self._arrival(dialect.CommandLong, REPEAT_RELAY)
        ack = dialect.CommandAck(command=REPEAT_RELAY, target_system=255, target_component=190)
        self._vehicle.send(self._encoder.encode(ack))
        self._http.getresponse().read()
        return arrived - started

    def send(self) -> float:
        """Return the seconds from a MANUAL_CONTROL in a WebSocket to its arrival at the vehicle."""
        self._beat()
        packet = self._own.encode(dialect.ManualControl(target=SYSTEM, z=500))
        started = perf_counter()
        self._websocket.send(BINARY, packet)
        arrived = self._arrival(dialect.ManualControl)
        self._drain()
        return arrived - started

    def _arrival(self, kind: type[Message], command: int | None = None) -> float:
        while True:
            data = self._vehicle.recv(4096)
            arrived = perf_counter()
            for packet in self._parser.feed(data):
                message = packet.message
                if isinstance(message, kind) and command in (None, getattr(message, "command", None)):
                    return arrived

    def _beat(self) -> None:
        heartbeat = dialect.Heartbeat(type=2, autopilot=3, system_status=3, mavlink_version=3)
        self._vehicle.send(self._encoder.encode(heartbeat))

    def _drain(self) -> None:
        """Read what the WebSocket has, so that it is a client that reads."""
        sock = self._websocket.sock
        sock.setblocking(False)
        try:
            while sock.recv(1 << 18):
                pass
        except BlockingIOError:
            sock.setblocking(True)

    def __enter__(self) -> Self:
        self._beat()
        return self

    def __exit__(self, *_: object) -> None:
        for each in (self._vehicle, self._echo, self._websocket.sock, self._http):
            each.close()
