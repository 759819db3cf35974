"""The receiver: a process on one core that tracks the vehicle, and reports packets, CPU time and losses.

    python -m benchmarks.tracked.receiver memory RATE
    python -m benchmarks.tracked.receiver udp
    python -m benchmarks.tracked.receiver first

From memory it writes the packets to a link of its own process, in chunks. Over UDP it prints its port; a line
on its input begins the measurement, the next one ends it. With `first` the vehicle is not known when
the measurement begins, with `udp` it was found.
"""

from __future__ import annotations

import asyncio
import json
import os
import sys
import time
from typing import TYPE_CHECKING

from benchmarks.measure import last_core
from mavstack import connect
from mavstack.dialects import Dialect
from mavstack.links import memory_pair

from .packets import SUBSCRIBED, Part, packets

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.dialects import Message
    from mavstack.node import Subscription
    from mavstack.vehicle import Connection

CHUNK = 1 << 15
#: Part of the packets that are sent before the measurement: the vehicle is found.
WARM_UP = 0.1


class _Follower:
    """The program: it reads positions, and iterates over twenty subscriptions."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        self.handled = 0
        dialect = Dialect.load("all")
        self._streams = [connection.stream(dialect[name]) for name in SUBSCRIBED]
        self._tasks = [asyncio.create_task(self._iterate(stream)) for stream in self._streams]
        self._tasks.append(asyncio.create_task(self._read()))

    async def _iterate(self, stream: Subscription[Message]) -> None:
        async for _ in stream:
            self.handled += 1

    async def _read(self) -> None:
        while True:
            await asyncio.sleep(0.1)
            for vehicle in self._connection.vehicles.values():
                _ = vehicle.position, vehicle.attitude, vehicle.battery

    def report(self, count: int, seconds: float, cpu: float) -> None:
        """Print the figures; CPU time of a packet in microseconds."""
        parsers = [
            state.parser
            for link in self._connection.links
            for channel in link.channels
            if (state := self._connection.channel_state(channel)) is not None
        ]
        lost = sum(source.lost for parser in parsers for source in parser.sources.values())
        dropped = sum(stream.dropped for stream in self._streams)
        figures = {
            "rate": count / seconds,
            "cpu": cpu * 1e6 / max(count, 1),
            "lost": lost,
            "dropped": dropped,
        }
        print(json.dumps(figures | {"dropped": dropped, "handled": self.handled}), flush=True)


def _packets(connection: Connection) -> int:
    states = (connection.channel_state(channel) for link in connection.links for channel in link.channels)
    return sum(state.parser.statistics.packets for state in states if state is not None)


async def _from_memory(rate: int) -> None:
    (sent,) = packets(Part(1.0, rate))
    stream = b"".join(sent)
    chunks = [stream[at : at + CHUNK] for at in range(0, len(stream), CHUNK)]
    local, remote = memory_pair()
    await remote.open()
    async with connect(local) as connection:
        (channel,) = remote.channels
        first = int(len(chunks) * WARM_UP)
        await _write(chunks[:first], channel.write)
        follower = _Follower(connection)
        await _write(chunks[first : 2 * first], channel.write)
        before, cpu, at = _packets(connection), time.process_time(), time.perf_counter()
        await _write(chunks[2 * first :], channel.write)
        seconds, cpu = time.perf_counter() - at, time.process_time() - cpu
        follower.report(_packets(connection) - before, seconds, cpu)
    await remote.close()


async def _write(chunks: list[bytes], write: Callable[[bytes], object]) -> None:
    for chunk in chunks:
        write(chunk)
        await asyncio.sleep(0)
        await asyncio.sleep(0)


async def _over_udp(is_from_first: bool) -> None:
    async with connect("udpin://127.0.0.1:0") as connection:
        address = connection.links[0].address
        assert address is not None
        print(address[1], flush=True)
        follower = None if is_from_first else await _found(connection)
        await _line()
        before, cpu, at = _packets(connection), time.process_time(), time.perf_counter()
        follower = follower or await _found(connection)
        await _line()
        seconds, cpu = time.perf_counter() - at, time.process_time() - cpu
        follower.report(_packets(connection) - before, seconds, cpu)


async def _found(connection: Connection) -> _Follower:
    await connection.wait_for_vehicle(timeout=30.0)
    return _Follower(connection)


async def _line() -> None:
    await asyncio.get_running_loop().run_in_executor(None, sys.stdin.readline)


if __name__ == "__main__":
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {last_core()})
    if sys.argv[1] == "memory":
        asyncio.run(_from_memory(int(sys.argv[2])))
    else:
        asyncio.run(_over_udp(sys.argv[1] == "first"))
