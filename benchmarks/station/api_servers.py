"""Servers of MAVLink over HTTP and WebSocket, as commands and requests: ours and two others.

The environment variables MAVLINK2REST and MAVLINK_SERVER name the programs, or they are in PATH.
"""

from __future__ import annotations

import json
import os
import shutil
import socket
import subprocess
import sys
import tempfile
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from time import monotonic, sleep
from typing import TYPE_CHECKING, Any, NamedTuple

from .__main__ import BYTECODE, HOST
from .clients import RAW

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

#: The system id of the servers, which no vehicle and no client has.
OWN_SYSTEM, OWN_COMPONENT = 254, 190
MAX_START_TIME = 20.0
SUBSCRIBE = '{"subscribe": ["*"]}'


@dataclass(frozen=True, slots=True)
class Ports:
    """The ports of a server: HTTP, its UDP source, and raw packets by WebSocket."""

    http: int
    source: int
    raw: int


class Socket(NamedTuple):
    """A WebSocket of a server, and the text that a client sends first."""

    port: int
    path: str
    subprotocol: str
    hello: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Server:
    """A server and its requests.

    Attributes:
        name: The name in tables.
        command: The command, with the names of `Ports` in braces.
        latest: The path of the latest ATTITUDE of vehicle 1.
        post: The path that takes a message to send.
        json_path: The path of the WebSocket with JSON.
        json_protocol: Its subprotocol; empty: none.
        json_hello: The text that a JSON client sends first; empty: none.
        raw_path: The path of the WebSocket with raw packets; empty: there is none.
        raw_protocol: Its subprotocol; empty: none.
        raw_port: The name of its port.
        is_nested: A message to send has its fields under `fields`, and stands under `send` in a WebSocket.
        environment: Further environment variables.
    """

    name: str
    command: Sequence[str]
    latest: str
    post: str
    json_path: str
    json_protocol: str = ""
    json_hello: str = ""
    raw_path: str = ""
    raw_protocol: str = ""
    raw_port: str = "http"
    is_nested: bool = False
    environment: Mapping[str, str] = field(default_factory=dict)

    def json_socket(self, ports: Ports) -> Socket:
        """Return the WebSocket with JSON."""
        return Socket(ports.http, self.json_path, self.json_protocol, self.json_hello)

    def raw_socket(self, ports: Ports) -> Socket | None:
        """Return the WebSocket with raw packets; None: there is none."""
        port = int(getattr(ports, self.raw_port))
        return Socket(port, self.raw_path, self.raw_protocol) if self.raw_path else None

    def post_body(self, mark: int) -> bytes:
        """Return the body of a request that sends a DEBUG message with a mark."""
        fields: dict[str, Any] = {"time_boot_ms": mark, "ind": 0, "value": 0.0}
        if self.is_nested:
            return json.dumps({"message": "DEBUG", "fields": fields}).encode()
        header = {"system_id": OWN_SYSTEM, "component_id": OWN_COMPONENT, "sequence": mark % 256}
        return json.dumps({"header": header, "message": {"type": "DEBUG", **fields}}).encode()

    def text(self, mark: int) -> bytes:
        """Return the text by which a WebSocket client sends that message."""
        body = self.post_body(mark)
        return b'{"send": ' + body + b"}" if self.is_nested else body


def _mavstack() -> Server:
    source = f"udpin://{HOST}:{{source}}"
    return Server(
        name="mav web",
        command=(sys.executable, "-m", "mavstack", "web", source, "--no-browser", "--port", "{http}"),
        latest="/api/vehicles/1/messages/ATTITUDE",
        post="/api/messages",
        json_path="/ws",
        json_protocol="mavstack.json.1",
        json_hello=SUBSCRIBE,
        raw_path="/ws",
        raw_protocol=RAW,
        is_nested=True,
        environment={"PYTHONPYCACHEPREFIX": str(BYTECODE)},
    )


def _mavlink2rest(program: str) -> Server:
    ids = ("--system-id", str(OWN_SYSTEM), "--component-id", str(OWN_COMPONENT))
    return Server(
        name="mavlink2rest",
        command=(program, "-c", f"udpin:{HOST}:{{source}}", "-s", f"{HOST}:{{http}}", *ids),
        latest="/mavlink/vehicles/1/components/1/messages/ATTITUDE",
        post="/mavlink",
        json_path="/ws/mavlink?filter=.*",
    )


def _mavlink_server(program: str) -> Server:
    ids = ("--mavlink-system-id", str(OWN_SYSTEM), "--mavlink-component-id", str(OWN_COMPONENT))
    places = ("--web-server", f"{HOST}:{{http}}", "--log-path", "{folder}")
    links = (f"udps://{HOST}:{{source}}", f"wsserver://{HOST}:{{raw}}")
    return Server(
        name="mavlink-server",
        command=(program, *places, *ids, *links),
        latest="/v1/rest/mavlink/vehicles/1/components/1/messages/ATTITUDE",
        post="/v1/rest/mavlink",
        json_path="/v1/rest/ws",
        raw_path="/",
        raw_port="raw",
    )


def servers() -> tuple[Server, ...]:
    """Return ours and the others that are there; tells which ones are not."""
    found = [_mavstack()]
    for name, make in (("mavlink2rest", _mavlink2rest), ("mavlink-server", _mavlink_server)):
        variable = name.upper().replace("-", "_")
        program = shutil.which(os.environ.get(variable, name))
        if program is None:
            print(f"{name} is left out: not in PATH and not the value of {variable}")
        else:
            found.append(make(program))
    return tuple(found)


@contextmanager
def running(server: Server) -> Iterator[tuple[int, Ports]]:
    """Run a server; yields its process id and its ports when they are open."""
    ports = Ports(*(_free_port() for _ in range(3)))
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONDONTWRITEBYTECODE"}
    environment |= server.environment
    with tempfile.TemporaryDirectory() as folder:
        names = {"http": ports.http, "source": ports.source, "raw": ports.raw, "folder": folder}
        words = [each.format_map(names) for each in server.command]
        null = subprocess.DEVNULL
        with subprocess.Popen(words, stdout=null, stderr=null, cwd=folder, env=environment) as process:
            try:
                _wait_for_port(ports.http)
                yield process.pid, ports
            finally:
                process.terminate()


def _free_port() -> int:
    with socket.socket() as free:
        free.bind((HOST, 0))
        return int(free.getsockname()[1])


def _wait_for_port(port: int) -> None:
    end = monotonic() + MAX_START_TIME
    while monotonic() < end:
        with suppress(ConnectionRefusedError), socket.create_connection((HOST, port)):
            return
        sleep(0.02)
    raise SystemExit(f"no server listens at port {port}")
