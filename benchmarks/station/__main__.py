"""The ground station under load: processor time, clients that do not read, and the delay of a command.

    python -m benchmarks.station [--clients 50] [--rate 2000] [--seconds 10] [--turns 3] [--clicks 500]

`fleet.py` sends packets of ten vehicles over UDP to `mav web`, and `clients.py` reads them from WebSockets
with raw packets, each in a process of its own. The processor time is that of the server's process, in cores:
1.0 is one core for the whole time. A click is measured from the request to the arrival of the packet at the
vehicle; the echo of a program that does nothing else tells how much of that is the noise of the machine.
Programs start with cached bytecode, as installed packages have it.
"""

from __future__ import annotations

import argparse
import json
import os
import socket
import subprocess
import sys
import tempfile
from contextlib import ExitStack, contextmanager
from pathlib import Path
from statistics import median, quantiles
from time import monotonic, sleep
from typing import TYPE_CHECKING, Any, NamedTuple

from .clicks import Clicks

if TYPE_CHECKING:
    from collections.abc import Iterator

HOST = "127.0.0.1"
VEHICLES = 10
TICKS = os.sysconf("SC_CLK_TCK")
BYTECODE = Path(tempfile.gettempdir()) / "mavstack-benchmark-bytecode"
#: Seconds until the links have settled.
SETTLING_TIME = 3.0


class Load(NamedTuple):
    """A load: reading clients, clients that do not read, and packets per second."""

    title: str
    clients: int
    rate: int
    idle: int = 0


class Figures(NamedTuple):
    """The figures of one turn: cores of the server, shares of the packets at the worst and median client."""

    cores: float
    worst: float
    median: float


@contextmanager
def process(*words: object) -> Iterator[subprocess.Popen[str]]:
    """Run a program of this package, which ends when its standard input is closed."""
    arguments = [sys.executable, "-m", *map(str, words)]
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONDONTWRITEBYTECODE"}
    environment["PYTHONPYCACHEPREFIX"] = str(BYTECODE)
    pipe = subprocess.PIPE
    with subprocess.Popen(arguments, stdin=pipe, stdout=pipe, text=True, env=environment) as running:
        try:
            yield running
        finally:
            running.terminate()


@contextmanager
def station() -> Iterator[tuple[int, int, int]]:
    """Run `mav web`; yields its process id, its port and the port of its source."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind((HOST, 0))
        source = free.getsockname()[1]
    words = ("mavstack", "web", f"udpin://{HOST}:{source}", "--no-browser", "--port", 0, "--json")
    with process(*words) as server:
        port = json.loads(line(server))["port"]
        yield server.pid, port, source


def line(running: subprocess.Popen[str]) -> str:
    """Return the next line that a program of this package prints."""
    assert running.stdout is not None
    return running.stdout.readline()


def ask(running: subprocess.Popen[str], text: str = "") -> Any:  # noqa: ANN401 (JSON has values of many types)
    """Send a line to a program of this package, and return the JSON that it answers."""
    assert running.stdin is not None
    running.stdin.write(f"{text}\n")
    running.stdin.flush()
    return json.loads(line(running))


def processor_time(pid: int) -> float:
    """Return the processor time of a process in seconds."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / TICKS


def measure(load: Load, seconds: float) -> Figures:
    """Return the figures of one turn."""
    with station() as (pid, port, source), ExitStack() as running:
        running.enter_context(process("benchmarks.station.fleet", source, load.rate, VEHICLES))
        clients = running.enter_context(process("benchmarks.station.clients", port, load.clients, load.idle))
        line(clients)
        sleep(SETTLING_TIME)
        ask(clients)
        before, started = processor_time(pid), monotonic()
        sleep(seconds)
        packets, after = ask(clients), processor_time(pid)
        elapsed = monotonic() - started
        expected = load.rate * elapsed
        return Figures((after - before) / elapsed, min(packets) / expected, median(packets) / expected)


def measure_clicks(load: Load, count: int) -> dict[str, list[float]]:
    """Return the delays in milliseconds by kind of click."""
    with station() as (_, port, source), ExitStack() as running:
        if load.rate:
            running.enter_context(process("benchmarks.station.fleet", source, load.rate, VEHICLES))
            clients = process("benchmarks.station.clients", port, load.clients, load.idle)
            line(running.enter_context(clients))
        echo = int(line(running.enter_context(process("benchmarks.station.echo"))))
        with Clicks(port, source, echo) as clicks:
            sleep(SETTLING_TIME)
            return {
                "echo of the machine": [clicks.echo() * 1e3 for _ in range(count)],
                "POST command": [clicks.post() * 1e3 for _ in range(count)],
                "raw WebSocket": [clicks.send() * 1e3 for _ in range(count)],
            }


def measure_start() -> tuple[float, float]:
    """Return the seconds from the start to the answer to the first request, and the processor time."""
    started = monotonic()
    with station() as (pid, port, _):
        with socket.create_connection((HOST, port)) as sock:
            sock.sendall(f"GET /api/vehicles HTTP/1.1\r\nHost: {HOST}:{port}\r\n\r\n".encode())
            sock.recv(1)
        return monotonic() - started, processor_time(pid)


def main() -> None:
    """Run all loads in turns, and print the tables."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.station")
    parser.add_argument("--clients", type=int, default=50)
    parser.add_argument("--rate", type=int, default=2000)
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--turns", type=int, default=3)
    parser.add_argument("--clicks", type=int, default=500)
    options = parser.parse_args()
    full = Load(f"{options.clients} clients", options.clients, options.rate)
    loads = (
        Load("1 client", 1, options.rate),
        full,
        full._replace(title=f"{options.clients} clients, 5 more never read", idle=5),
    )
    turns = {load: [measure(load, options.seconds) for _ in range(options.turns)] for load in loads}
    print(f"{options.rate} packets/s to each client: cores of the server, packets at the worst client\n")
    for load, figures in turns.items():
        cores = [each.cores for each in figures]
        worst = min(each.worst for each in figures)
        print(f"{load.title:32} {median(cores):5.2f} ({min(cores):.2f} to {max(cores):.2f})  {worst:7.1%}")
    print("\nclick to packet on the wire, milliseconds: median, 99 of 100\n")
    for load in (Load("idle", 0, 0), full):
        for kind, delays in measure_clicks(load, options.clicks).items():
            slow = quantiles(delays, n=100)[-1]
            print(f"{load.title:16} {kind:20} {median(delays):6.2f} {slow:6.2f}")
    starts, times = zip(*(measure_start() for _ in range(options.turns)), strict=True)
    print(
        f"\nstart to the first answer: {median(starts):.2f} s ({min(starts):.2f} to {max(starts):.2f}),",
        end="",
    )
    print(f" of it processor time: {median(times):.2f} s")


if __name__ == "__main__":
    main()
