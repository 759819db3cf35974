"""The memory of the ground station while clients come and go.

    python -m benchmarks.station.growth [--minutes 30] [--vehicles 100] [--rate 1000] [--clients 20]

`fleet.py` sends the packets of the vehicles over UDP to `mav web`. Each client is a connection of a few
seconds: a WebSocket with raw packets that reads or does not, one with JSON messages, or a request of the API.
They all leave without a word. The table shows the memory of the server's process without a file behind it
(`RssAnon`), its open descriptors and the clients so far.
"""

from __future__ import annotations

import argparse
import random
import socket
from collections import deque
from pathlib import Path
from statistics import median
from time import monotonic, sleep
from typing import NamedTuple

from .__main__ import HOST, process, station
from .clients import REQUEST

#: Seconds between two clients, two lines of the table, and two samples.
CLIENT_INTERVAL, LINE_INTERVAL, SAMPLE_INTERVAL = 0.2, 30.0, 1.0
MINUTE = 60.0
JSON_REQUEST = REQUEST.replace("mavstack.raw.1", "mavstack.json.1")
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


class Sample(NamedTuple):
    """The memory in MB and the open descriptors of a process, at a time in seconds since the start."""

    time: float
    memory: float
    descriptors: int


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
            request = JSON_REQUEST if kind == "json" else REQUEST
            sock.sendall(request.format(port=self._port).encode())
        if kind == "json":
            sock.sendall(bytes([0x81, 0x80 | len(SUBSCRIBE)]) + MASK + SUBSCRIBE)
        sock.setblocking(False)
        return sock, kind != "lazy"


def _has_read(sock: socket.socket) -> bool:
    try:
        return bool(sock.recv(1 << 18))
    except OSError:
        return False


def sample(pid: int, started: float) -> Sample:
    """Return the present figures of a process."""
    status = Path(f"/proc/{pid}/status").read_text()
    anonymous = next(line for line in status.splitlines() if line.startswith("RssAnon"))
    descriptors = len(list(Path(f"/proc/{pid}/fd").iterdir()))
    return Sample(monotonic() - started, int(anonymous.split()[1]) / 1000, descriptors)


def run(minutes: float, vehicles: int, rate: int, clients: int) -> list[Sample]:
    """Run the station under load, print a line every `LINE_INTERVAL` seconds, and return all samples."""
    samples: list[Sample] = []
    with station() as (pid, port, source):
        visitors, started = Visitors(port, clients), monotonic()
        with process("benchmarks.station.fleet", source, rate, vehicles):
            next_line = next_sample = 0.0
            while (elapsed := monotonic() - started) < minutes * MINUTE:
                visitors.step()
                if elapsed >= next_sample:
                    samples.append(sample(pid, started))
                    next_sample = elapsed + SAMPLE_INTERVAL
                if elapsed >= next_line:
                    print(_line(samples[-1], visitors.seen), flush=True)
                    next_line = elapsed + LINE_INTERVAL
                sleep(CLIENT_INTERVAL)
        visitors.close()
    return samples


def _line(at: Sample, seen: int) -> str:
    return f"{at.time:7.0f} s {at.memory:8.1f} MB {at.descriptors:5} descriptors {seen:7} clients"


def main() -> None:
    """Run, and print the medians of the second, the middle and the last minute."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.station.growth")
    parser.add_argument("--minutes", type=float, default=30.0)
    parser.add_argument("--vehicles", type=int, default=100)
    parser.add_argument("--rate", type=int, default=1000)
    parser.add_argument("--clients", type=int, default=20)
    options = parser.parse_args()
    samples = run(options.minutes, options.vehicles, options.rate, options.clients)
    size = min(int(MINUTE / SAMPLE_INTERVAL), len(samples) // 3)
    middle = len(samples) // 2
    for name, part in (
        ("second minute" if len(samples) > 2 * size else "first third", samples[size : 2 * size]),
        ("middle", samples[middle - size // 2 : middle + size // 2]),
        ("last minute", samples[-size:]),
    ):
        print(f"{name:14} {median(each.memory for each in part):8.1f} MB")


if __name__ == "__main__":
    main()
