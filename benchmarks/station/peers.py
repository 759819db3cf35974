"""The API of the ground station beside mavlink2rest and mavlink-server: requests, delays, load, memory.

    python -m benchmarks.station.peers [--turns 3] [--seconds 4] [--count 200] [--rate 1000] [--clients 8]

`fleet.py` sends packets to each server over UDP. The servers take turns; each figure is the median of the
turns, beside the lowest and the highest one. All have the same clients, in processes of their own:
`http_load.py` asks for the latest ATTITUDE of a vehicle, `clients.py` reads WebSockets, `delays.py` is a
vehicle and a client in one process. The clients are Python programs: where a server needs less time for a
request than its client, the rate is that of the client, and the processor time per request tells more.

The environment variables MAVLINK2REST and MAVLINK_SERVER name the other programs, or they are in PATH.
"""

from __future__ import annotations

import argparse
import json
import os
from collections import defaultdict
from contextlib import ExitStack
from statistics import median, quantiles
from time import monotonic, sleep
from typing import TYPE_CHECKING

from .__main__ import ask, line, process, processor_time
from .api_servers import running, servers
from .delays import Delays
from .growth import server_memory

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from .api_servers import Ports, Server, Socket

#: Packets per second while requests are measured, and vehicles while packets are.
CALM, VEHICLES = 100, 10
SETTLING_TIME = 2.0


def measure_requests(server: Server, options: argparse.Namespace) -> Iterator[tuple[str, str, float]]:
    """Yield the figures of requests for the latest message, with one client and with several."""
    for count in (1, options.clients):
        with running(server) as (pid, ports), ExitStack() as others:
            others.enter_context(process("benchmarks.station.fleet", ports.source, CALM, 1))
            sleep(SETTLING_TIME)
            words = ("benchmarks.station.http_load", ports.http, server.latest, count)
            load = others.enter_context(process(*words))
            ask(load, "0.5")
            before = processor_time(pid)
            found = ask(load, str(options.seconds))
            used = (processor_time(pid) - before) / found["requests"]
        row = f"GET, {count} client{'s' if count > 1 else ''}"
        yield row, "requests/s", found["rate"]
        yield row, "median ms", found["median"]
        yield row, "p99 ms", found["p99"]
        yield row, "CPU µs", used * 1e6


def measure_delays(server: Server, options: argparse.Namespace) -> Iterator[tuple[str, str, float]]:
    """Yield the delays: idle in both directions, and those of packets received while others arrive."""
    with running(server) as (_, ports), ExitStack() as others:
        delays = others.enter_context(Delays(server, ports))
        sleep(SETTLING_TIME)
        ways: dict[str, Callable[[], float]] = {"packet to JSON": delays.json, "POST to packet": delays.post}
        ways["text to packet"] = delays.text
        if delays.has_raw:
            ways |= {"packet to raw": delays.raw, "raw to packet": delays.binary}
        for row, measure in ways.items():
            yield from _spread(row, measure, options.count)
        others.enter_context(process("benchmarks.station.fleet", ports.source, options.rate, VEHICLES))
        sleep(SETTLING_TIME)
        for row in ("packet to JSON", "packet to raw"):
            if row in ways:
                yield from _spread(f"{row}, {options.rate} packets/s", ways[row], options.count)


def measure_load(server: Server, options: argparse.Namespace) -> Iterator[tuple[str, str, float]]:
    """Yield the processor time for 1,000 packets, by the number and kind of WebSocket clients, and memory."""
    for kind in ("none", "JSON", "raw"):
        for count in (0,) if kind == "none" else (1, options.clients):
            with running(server) as (pid, ports):
                place = server.raw_socket(ports) if kind == "raw" else server.json_socket(ports)
                if place is None:
                    continue
                row = f"{count} {kind}" if count else "no client"
                for name, value in _load(pid, ports, place, count, options).items():
                    yield row, name, value


def _load(pid: int, ports: Ports, place: Socket, count: int, options: argparse.Namespace) -> dict[str, float]:
    names = ("--path", place.path, "--subprotocol", place.subprotocol, "--hello", place.hello)
    with ExitStack() as others:
        fleet = ("benchmarks.station.fleet", ports.source, options.rate, VEHICLES)
        others.enter_context(process(*fleet))
        words = ("benchmarks.station.clients", place.port, count, *names)
        clients = others.enter_context(process(*words))
        line(clients)
        sleep(SETTLING_TIME)
        ask(clients)
        before, started = processor_time(pid), monotonic()
        sleep(options.seconds)
        packets, after = ask(clients), processor_time(pid)
        expected = options.rate * (monotonic() - started)
        found = {"CPU ms": (after - before) / expected * 1e6, "MB": server_memory(pid)}
        return found | ({"received %": 100 * min(packets) / expected} if count else {})


def _spread(row: str, measure: Callable[[], float], count: int) -> Iterator[tuple[str, str, float]]:
    delays = [measure() * 1e3 for _ in range(count)]
    yield row, "median ms", median(delays)
    yield row, "p99 ms", quantiles(delays, n=100)[-1]


def print_table(found: Mapping[str, Mapping[tuple[str, str], list[float]]]) -> None:
    """Print the figures of each server, row by row."""
    rows = dict.fromkeys(row for figures in found.values() for row, _ in figures)
    for row in rows:
        for name, figures in found.items():
            cells = [
                f"{column} {_number(median(values))} ({_number(min(values))} … {_number(max(values))})"
                for (of_row, column), values in figures.items()
                if of_row == row
            ]
            if cells:
                print(f"{row:34} {name:15} {'   '.join(cells)}")
    print()


def _number(value: float) -> str:
    return f"{value:,.0f}" if value >= 100 else f"{value:.1f}" if value >= 10 else f"{value:.2f}"


def main() -> None:
    """Measure in turns, and print the tables."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.station.peers")
    parser.add_argument("--turns", type=int, default=3)
    parser.add_argument("--seconds", type=float, default=4.0, help="of each measurement")
    parser.add_argument("--count", type=int, default=200, help="delays of each kind")
    parser.add_argument("--rate", type=int, default=1000, help="packets per second")
    parser.add_argument("--clients", type=int, default=8, help="the larger number of clients")
    parser.add_argument("--only", choices=sorted(TABLES), nargs="*", default=list(TABLES))
    parser.add_argument("--json", action="store_true", help="print every turn, too")
    options = parser.parse_args()
    there = servers()
    for title in options.only:
        found: dict[str, dict[tuple[str, str], list[float]]] = {
            each.name: defaultdict(list) for each in there
        }
        for _ in range(options.turns):
            for server in there:
                for row, column, value in TABLES[title](server, options):
                    found[server.name][row, column].append(value)
        print_table(found)
        if options.json:
            flat = {name: {" | ".join(key): each for key, each in of.items()} for name, of in found.items()}
            print(json.dumps(flat))
    print(f"load average {os.getloadavg()[0]:.1f}, {os.cpu_count()} cores")


TABLES = {"requests": measure_requests, "delays": measure_delays, "load": measure_load}

if __name__ == "__main__":
    main()
