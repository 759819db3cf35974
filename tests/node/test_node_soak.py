"""A node for a long time: vehicles, links and clients that come and go, and ten million packets in order.

`MAVSTACK_SOAK_MINUTES` sets the length of the soak (10 minutes without it).
"""

from __future__ import annotations

import asyncio
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Final

import pytest

from mavstack.dialects import common
from mavstack.node import Node
from mavstack.wire import Encoder
from tests.waiting import wait_until

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.wire import Packet

MINUTES: Final = float(os.environ.get("MAVSTACK_SOAK_MINUTES", "10"))
#: Memory in MB that may be added from the second to the last fifth: allocators keep some, a leak has no end.
GROWTH: Final = 3.0
SOURCES: Final = 50
PACKETS: Final = int(os.environ.get("MAVSTACK_SOAK_PACKETS", "10_000_000"))
#: Packets of each source in a burst, and bytes of the socket buffer that holds the burst of all.
BURST: Final = 20


@pytest.mark.nightly
@pytest.mark.timeout(60 * MINUTES + 300)
@pytest.mark.skipif(not Path("/proc/self/fd").exists(), reason="counts descriptors in /proc")
def test_memory_descriptors_and_threads_level_while_vehicles_and_clients_come_and_go():
    # Without the test runner, which keeps the records of all logs while a test runs.
    command = [sys.executable, "-m", "tests.node.soak", str(MINUTES)]
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stderr
    report = json.loads(ended.stdout)
    memory, descriptors, threads = report["memory"], report["descriptors"], report["threads"]
    print(
        f"\n{report['clients']} clients, {report['vehicles']} vehicles;"
        f" memory {memory[0]:.1f} … {memory[-1]:.1f} MB,"
        f" descriptors {min(descriptors)} … {max(descriptors)}, threads {min(threads)} … {max(threads)}"
    )
    fifth = max(1, len(memory) // 5)
    first, last = slice(fifth, 2 * fifth), slice(-fifth, None)
    assert min(memory[last]) - min(memory[first]) < GROWTH
    assert max(descriptors[last]) <= max(descriptors[first]) + 2
    assert max(threads[last]) <= max(threads[first])


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
