"""The receiver of a fleet: a process that reports its CPU time, memory and counts.

    python -m benchmarks.fleets.receiver METHOD CONNECTIONS VEHICLES SUBSCRIPTIONS

It prints its ports. A line on its input begins the measurement, the next one ends it: then it prints the
figures.
"""

from __future__ import annotations

import asyncio
import json
import resource
import socket
import sys
import threading
import time
from pathlib import Path
from typing import TYPE_CHECKING

from mavstack import connect
from mavstack.dialects import common

if TYPE_CHECKING:
    from mavstack.vehicle import Connection

#: Seconds between two looks at the positions of all vehicles.
READ_INTERVAL = 0.2
MAX_DATAGRAM = 2048
BUFFER = 8 << 20


def _report(received: int, lost: int, cpu: float) -> None:
    status = Path("/proc/self/status").read_text()
    memory = next(int(line.split()[1]) for line in status.splitlines() if line.startswith("VmRSS"))
    print(json.dumps({"received": received, "lost": lost, "cpu": cpu, "memory": memory / 1024}), flush=True)


def _cpu() -> float:
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return usage.ru_utime + usage.ru_stime


async def _line() -> str:
    return await asyncio.get_running_loop().run_in_executor(None, sys.stdin.readline)


def _counts(connections: list[Connection]) -> tuple[int, int]:
    channels = [
        (connection, channel)
        for connection in connections
        for link in connection.links
        for channel in link.channels
    ]
    states = [connection.channel_state(channel) for connection, channel in channels]
    parsers = [state.parser for state in states if state is not None]
    received = sum(parser.statistics.packets for parser in parsers)
    return received, sum(source.lost for parser in parsers for source in parser.sources.values())


def _port(connection: Connection) -> int:
    address = connection.links[0].address
    assert address is not None
    return address[1]


async def _ours(count: int, vehicles: int, subscriptions: int) -> None:
    connections = [connect("udpin://127.0.0.1:0") for _ in range(count)]
    for connection in connections:
        await connection.open()
    print(*map(_port, connections), flush=True)
    await _line()
    while sum(len(each.vehicles) for each in connections) < count * vehicles:  # noqa: ASYNC110 (no event)
        await asyncio.sleep(0.1)
    streams = [connections[0].stream(common.GpsRawInt) for _ in range(subscriptions)]
    reading = asyncio.create_task(_read(connections))
    await asyncio.sleep(1.0)
    before, at, (received, lost_before) = _cpu(), time.perf_counter(), _counts(connections)
    await _line()
    cpu = (_cpu() - before) / (time.perf_counter() - at)
    after, lost = _counts(connections)
    _report(after, lost - lost_before, cpu * 1e6 / max(1.0, (after - received) / (time.perf_counter() - at)))
    reading.cancel()
    del streams


async def _read(connections: list[Connection]) -> None:
    """Read the position of each vehicle five times a second, spread over the interval."""
    while True:
        for connection in connections:
            for vehicle in connection.vehicles.values():
                _ = vehicle.position
            await asyncio.sleep(READ_INTERVAL / len(connections))


def _blocking(count: int) -> None:
    """Receive by a thread for each socket that only counts."""
    received = [0] * count
    sockets = []
    for index in range(count):
        sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, BUFFER)
        sock.bind(("127.0.0.1", 0))
        sockets.append(sock)

        def receive(sock: socket.socket = sock, index: int = index) -> None:
            while True:
                sock.recvfrom(MAX_DATAGRAM)
                received[index] += 1

        threading.Thread(target=receive, daemon=True).start()
    print(*(sock.getsockname()[1] for sock in sockets), flush=True)
    sys.stdin.readline()
    time.sleep(1.0)
    before, at, began = _cpu(), time.perf_counter(), sum(received)
    sys.stdin.readline()
    cpu = (_cpu() - before) / (time.perf_counter() - at)
    _report(sum(received), 0, cpu * 1e6 / max(1.0, (sum(received) - began) / (time.perf_counter() - at)))


if __name__ == "__main__":
    method, counts = sys.argv[1], [int(number) for number in sys.argv[2:]]
    if method == "ours":
        asyncio.run(_ours(*counts))
    else:
        _blocking(counts[0])
