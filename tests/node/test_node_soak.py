"""A node for a long time: vehicles, links and clients that come and go, and ten million packets in order.

`MAVSTACK_SOAK_MINUTES` sets the length of the soak (10 minutes without it).
"""

from __future__ import annotations

import asyncio
import os
import random
import socket
import threading
from pathlib import Path
from typing import TYPE_CHECKING, Final

import pytest

from mavstack import connect
from mavstack.dialects import common
from mavstack.node import Node
from mavstack.wire import Encoder
from tests.waiting import wait_until

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.vehicle import Connection
    from mavstack.wire import Packet

MINUTES: Final = float(os.environ.get("MAVSTACK_SOAK_MINUTES", "10"))
HEARTBEAT: Final = common.Heartbeat(type=common.MavType.QUADROTOR, autopilot=common.MavAutopilot.PX4)
#: Memory in MB that may be added from the second to the last fifth: allocators keep some, a leak has no end.
GROWTH: Final = 3.0
SOURCES: Final = 50
PACKETS: Final = int(os.environ.get("MAVSTACK_SOAK_PACKETS", "10_000_000"))
#: Packets of each source in a burst, and bytes of the socket buffer that holds the burst of all.
BURST: Final = 20


def usage() -> tuple[float, int, int]:
    """Return the memory without files behind it in MB, the open descriptors, and the threads."""
    status = dict(line.split(":", 1) for line in Path("/proc/self/status").read_text("ascii").splitlines())
    descriptors = len(list(Path("/proc/self/fd").iterdir()))
    return int(status["RssAnon"].split()[0]) / 1024, descriptors, threading.active_count()


def port_of(connection: Connection) -> int:
    address = connection.links[0].address
    assert address is not None
    return int(address[1])


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


@pytest.mark.nightly
@pytest.mark.timeout(60 * MINUTES + 300)
@pytest.mark.skipif(not Path("/proc/self/fd").exists(), reason="counts descriptors in /proc")
async def test_memory_descriptors_and_threads_level_while_vehicles_and_clients_come_and_go():
    measured: list[tuple[float, int, int]] = []
    async with connect("udpin://127.0.0.1:0?idle=5") as connection:
        vehicles = Vehicles(port_of(connection), seed=27)
        end = asyncio.get_running_loop().time() + 60 * MINUTES
        try:
            turn = 0
            while asyncio.get_running_loop().time() < end:
                if turn % 3 == 0:
                    vehicles.change()
                vehicles.send()
                await asyncio.sleep(0.1)
                await client(port_of(connection), connection, vehicles)
                turn += 1
                if turn % 10 == 0:
                    measured.append(usage())
        finally:
            vehicles.close()
    fifth = max(1, len(measured) // 5)
    first, last = measured[fifth : 2 * fifth], measured[-fifth:]
    memory, descriptors, threads = zip(*measured, strict=True)
    print(
        f"\n{turn} clients, {vehicles.came} vehicles; memory {memory[0]:.1f} … {memory[-1]:.1f} MB,"
        f" descriptors {min(descriptors)} … {max(descriptors)}, threads {min(threads)} … {max(threads)}"
    )
    assert min(each[0] for each in last) - min(each[0] for each in first) < GROWTH
    assert max(each[1] for each in last) <= max(each[1] for each in first) + 2
    assert max(each[2] for each in last) <= max(each[2] for each in first)


def bursts(sources: int, packets: int) -> Iterator[bytes]:
    """Yield joined packets of all sources, in order; the number of each packet is in its first field."""
    encoders = [Encoder(system, 1) for system in range(1, sources + 1)]
    for first in range(0, packets // sources, BURST):
        for encoder in encoders:
            numbers = range(first, first + BURST)
            yield b"".join(encoder.encode(common.Attitude(time_boot_ms=number)) for number in numbers)


@pytest.mark.nightly
@pytest.mark.timeout(1800)
async def test_ten_million_packets_are_neither_lost_nor_out_of_order():
    expected = [0] * (SOURCES + 1)
    received = 0

    def check(packet: Packet) -> None:
        nonlocal received
        received += 1
        system, number = packet.system, packet.message.time_boot_ms
        assert expected[system] == number
        expected[system] += 1

    problems: list[object] = []
    asyncio.get_running_loop().set_exception_handler(lambda _, context: problems.append(context))
    async with Node("tcpin://127.0.0.1:0") as node:
        node.add_packet_listener(common.Attitude, check)
        address = node.links[0].address
        assert address is not None
        _, writer = await asyncio.open_connection("127.0.0.1", address[1])
        for data in bursts(SOURCES, PACKETS):
            writer.write(data)
            await writer.drain()
        await wait_until(lambda: received >= PACKETS or bool(problems), timeout=900)
        writer.close()
    assert not problems
    assert set(expected[1:]) == {PACKETS // SOURCES}
