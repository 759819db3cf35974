"""CPU time per packet over the number of vehicles and of subscriptions: `python -m benchmarks.growth`.

All vehicles together send the same number of packets in a second, in the same proportions, over links
within the process, so that only the number of vehicles or subscriptions changes. A network has 255 system ids
at most, so 1,000 vehicles are five connections. The subscriptions are to messages that come seldom.
`--json FILE` writes the figures that `docs/_tools/growth_picture.py` draws.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import time
from contextlib import AsyncExitStack
from itertools import cycle, islice
from pathlib import Path
from typing import TYPE_CHECKING, Final

from benchmarks.fleets.sender import AUTOPILOT, messages
from benchmarks.report import machine
from mavstack import connect
from mavstack.dialects import Dialect
from mavstack.links import memory_pair
from mavstack.wire import Encoder

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from mavstack.dialects import Message
    from mavstack.links import Link
    from mavstack.vehicle import Connection

VEHICLES: Final = (1, 10, 50, 200, 1000)
SUBSCRIPTIONS: Final = (1, 20, 50, 100, 200)
#: Vehicles of a connection.
MAX_VEHICLES: Final = 200
#: Packets of all vehicles in a second, of which one in `HEARTBEATS` is a heartbeat.
RATE: Final = 100_000
HEARTBEATS: Final = 100
#: Chunks in a second, and seconds before and of the measurement.
CHUNKS: Final = 100
LEAD, SECONDS = 1.5, 1.5
TURNS: Final = 5


class Source:
    """The packets of a vehicle; as many in a second as its share, whatever the number of vehicles."""

    def __init__(self, system: int) -> None:
        self._encoder = Encoder(system, 1)
        self._messages = messages(system)
        self._count = system * 7  # the heartbeats of vehicles come at different times

    def packets(self, count: int, boot_ms: int) -> bytes:
        """Return the next packets."""
        return b"".join(self._packet(boot_ms) for _ in range(count))

    def _packet(self, boot_ms: int) -> bytes:
        self._count += 1
        if self._count % HEARTBEATS == 0:
            return self._encoder.encode(AUTOPILOT)
        message = next(self._messages)
        if hasattr(message, "time_boot_ms"):
            message = message.replace(time_boot_ms=boot_ms)
        return self._encoder.encode(message)


def _chunks(vehicles: int, seconds: float) -> list[list[bytes]]:
    """Return the bytes for each connection in each chunk."""
    sizes = [MAX_VEHICLES] * (vehicles // MAX_VEHICLES) or [vehicles]
    fleets = [[Source(system) for system in range(1, size + 1)] for size in sizes]
    turns = [cycle(fleet) for fleet in fleets]
    part, found = RATE // CHUNKS // len(fleets), []
    for number in range(int(seconds * CHUNKS)):
        boot_ms, each = 10_000 + 1000 * number // CHUNKS, max(1, part // MAX_VEHICLES)
        found.append(
            [
                b"".join(source.packets(each, boot_ms) for source in islice(turn, part // each))
                for turn in turns
            ]
        )
    return found


def measure(vehicles: int, subscriptions: int) -> float:
    """Return the CPU time of a packet in microseconds."""
    return asyncio.run(_measure(_chunks(vehicles, LEAD + SECONDS), subscriptions))


async def _measure(chunks: list[list[bytes]], subscriptions: int) -> float:
    async with AsyncExitStack() as stack:
        ends = [memory_pair() for _ in chunks[0]]
        remotes = [await stack.enter_async_context(remote) for _, remote in ends]
        connections = [await stack.enter_async_context(connect(local)) for local, _ in ends]
        for kind in islice(_seldom(), subscriptions):
            for connection in connections:
                stack.callback(connection.stream(kind).close)
        lead = int(LEAD * CHUNKS)
        await _send(chunks[:lead], remotes)
        count, cpu = _count(connections), time.process_time()
        await _send(chunks[lead:], remotes)
        return (time.process_time() - cpu) * 1e6 / (_count(connections) - count)


def _seldom() -> Iterator[type[Message]]:
    """Yield message classes that the vehicles do not send."""
    sent = {type(message) for message in islice(messages(1), 20)} | {type(AUTOPILOT)}
    return (kind for kind in Dialect.load("all") if kind not in sent)


async def _send(chunks: Sequence[list[bytes]], remotes: Sequence[Link]) -> None:
    began = time.perf_counter()
    for number, parts in enumerate(chunks):
        for remote, data in zip(remotes, parts, strict=True):
            remote.channels[0].write(data)
        await asyncio.sleep(max(0.0, began + (number + 1) / CHUNKS - time.perf_counter()))


def _count(connections: Sequence[Connection]) -> int:
    states = (
        connection.channel_state(channel)
        for connection in connections
        for link in connection.links
        for channel in link.channels
    )
    return sum(state.parser.statistics.packets for state in states if state is not None)


def _rows(turns: int) -> Iterator[dict[str, float]]:
    """Measure each row, least disturbed of some turns, which change between the rows."""
    cases = [(count, 1) for count in VEHICLES] + [(1, count) for count in SUBSCRIPTIONS[1:]]
    found = [[measure(*case) for case in cases] for _ in range(turns)]
    for (vehicles, subscriptions), cpu in zip(cases, zip(*found, strict=True), strict=True):
        yield {"vehicles": vehicles, "subscriptions": subscriptions, "cpu": min(cpu), "worst": max(cpu)}


def main() -> None:
    """Measure, print a line for each row, and write the figures."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.growth", description="Cost of a packet.")
    parser.add_argument("--turns", type=int, default=TURNS, help=f"turns of each row (default: {TURNS})")
    parser.add_argument("--json", type=Path, metavar="FILE", help="the file to write")
    options = parser.parse_args()
    rows = list(_rows(options.turns))
    print("vehicles  subscriptions  CPU µs per packet, least  most")
    for row in rows:
        print(f"{row['vehicles']:8}  {row['subscriptions']:13}  {row['cpu']:.2f}  {row['worst']:.2f}")
    print(f"machine  {machine()}")
    if options.json is not None:
        options.json.write_text(json.dumps(rows, indent=2) + "\n", "utf-8")


if __name__ == "__main__":
    main()
