"""A program that keeps a connection open while vehicles and clients come and go; it prints its usage as JSON.

Run by itself, since a test runner keeps the log records and the output of a test while the test runs:
`python -m tests.node.soak MINUTES`.
"""

from __future__ import annotations

import asyncio
import json
import random
import socket
import sys
import threading
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Final

from mavstack import connect
from mavstack.dialects import common
from mavstack.node import Node
from mavstack.wire import Encoder

if TYPE_CHECKING:
    from mavstack.vehicle import Connection

HEARTBEAT: Final = common.Heartbeat(type=common.MavType.QUADROTOR, autopilot=common.MavAutopilot.PX4)
#: Turns between two measurements.
MEASURED_TURNS: Final = 10


@dataclass
class Report:
    """The clients and vehicles that came, and the usage of the process over the time.

    Attributes:
        memory: Memory without files behind it, in MB.
        descriptors: Open descriptors.
        threads: Threads, including those of the core.
    """

    clients: int = 0
    vehicles: int = 0
    memory: list[float] = field(default_factory=list)
    descriptors: list[int] = field(default_factory=list)
    threads: list[int] = field(default_factory=list)

    def measure(self) -> None:
        """Add the usage of this process."""
        lines = Path("/proc/self/status").read_text("ascii").splitlines()
        status = dict(line.split(":", 1) for line in lines)
        self.memory.append(int(status["RssAnon"].split()[0]) / 1024)
        self.descriptors.append(len(list(Path("/proc/self/fd").iterdir())))
        self.threads.append(int(status["Threads"]))


class Vehicles:
    """Vehicles on sockets of their own; one leaves and another one comes from time to time."""

    def __init__(self, port: int, seed: int) -> None:
        self._random = random.Random(seed)
        self._port = port
        self._alive: list[tuple[socket.socket, Encoder]] = []
        self.came = 0

    def send(self) -> None:
        """Send a heartbeat, a position and a burst of attitudes of each."""
        for sock, encoder in self._alive:
            sock.send(encoder.encode(HEARTBEAT))
            sock.send(encoder.encode(common.GlobalPositionInt(lat=self._random.randrange(1_000_000))))
            for _ in range(20):
                sock.send(encoder.encode(common.Attitude(roll=self._random.random())))

    def change(self) -> None:
        """Let one vehicle leave, and another one come."""
        if len(self._alive) > 5:
            sock, _ = self._alive.pop(self._random.randrange(len(self._alive)))
            sock.close()
        sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        sock.connect(("127.0.0.1", self._port))
        self._alive.append((sock, Encoder(self._random.randint(1, 30), 1)))
        self.came += 1

    def close(self) -> None:
        """Close the sockets."""
        for sock, _ in self._alive:
            sock.close()


async def client(port: int, connection: Connection, vehicles: Vehicles) -> None:
    """Come over a link of its own, read a while, and leave."""
    async with Node(f"udpout://127.0.0.1:{port}", system=255) as node:
        async with (
            node.stream(common.GlobalPositionInt) as positions,
            connection.stream(common.Attitude) as all_,
        ):
            vehicles.send()
            await asyncio.sleep(0.3)
            assert all_.drain()
            assert not positions.drain(), "the connection forwards nothing"
        for vehicle in list(connection.vehicles.values()):
            _ = vehicle.position, vehicle.heading


async def soak(minutes: float) -> Report:
    """Let vehicles and clients come and go for some time; return what was used."""
    report = Report()
    async with connect("udpin://127.0.0.1:0?idle=5") as connection:
        address = connection.links[0].address
        assert address is not None
        vehicles = Vehicles(int(address[1]), seed=27)
        end = asyncio.get_running_loop().time() + 60 * minutes
        try:
            while asyncio.get_running_loop().time() < end:
                if report.clients % 3 == 0:
                    vehicles.change()
                vehicles.send()
                await asyncio.sleep(0.1)
                await client(int(address[1]), connection, vehicles)
                report.clients += 1
                if report.clients % MEASURED_TURNS == 0:
                    report.measure()
        finally:
            vehicles.close()
    report.vehicles = vehicles.came
    # The thread of the core counts too; it ended with the connection.
    assert threading.active_count() == 1
    return report


if __name__ == "__main__":
    print(json.dumps(asdict(asyncio.run(soak(float(sys.argv[1]))))))
