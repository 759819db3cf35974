"""Packets that were lost, repeated, reordered and damaged on their way: both readers handle the same ones."""

from __future__ import annotations

import asyncio
import os
import socket
from random import Random
from typing import TYPE_CHECKING, NamedTuple

import pytest

from mavstack.dialects import common
from mavstack.links import Flow
from mavstack.node import Node
from mavstack.vehicle import Vehicle
from mavstack.wire import Encoder, Parser
from tests.services.network import random_impairment
from tests.waiting import wait_until

if TYPE_CHECKING:
    from mavstack.dialects import Message
    from tests.seeds import Seeds

pytestmark = pytest.mark.skipif(os.name != "posix", reason="the event loop waits for no descriptor")

SYSTEMS = (1, 2, 3)
#: Moments at which the vehicles send, and the datagrams between two turns of the event loop.
MOMENTS = 60
GROUP = 40
LISTENED = (common.VfrHud, common.Ping)
#: Whole packets at the end: a damaged length may swallow the first ones.
ENDS = 30
AUTOPILOT = common.Heartbeat(type=common.MavType.QUADROTOR, autopilot=common.MavAutopilot.PX4)


class Result(NamedTuple):
    """The packets that listeners got, the counters of the parser, and the latest messages of a vehicle."""

    listened: list[tuple[int, str, int]]
    packets: int
    bad_bytes: int
    lost: dict[tuple[int, int], int]
    latest: list[Message | None]


def messages(random: Random, number: int) -> list[Message]:
    """Return the messages of a vehicle at one moment."""
    return [
        common.Attitude(time_boot_ms=10_000 + 20 * number, roll=random.random()),
        *([common.VfrHud(heading=number)] * random.randrange(3)),
        *([AUTOPILOT] if number % 10 == 0 else []),
        *([common.SysStatus(load=number)] if number % 4 == 0 else []),
    ]


def datagrams(seed: int) -> list[bytes]:
    """Return the datagrams that arrive of some vehicles behind one lossy radio."""
    random = Random(seed)
    flow, encoders = Flow(random_impairment(random)), {system: Encoder(system, 1) for system in SYSTEMS}
    arrived = []
    for number in range(MOMENTS):
        for encoder in encoders.values():
            for message in messages(random, number):
                flow.send(encoder.encode(message), number * 0.02)
        arrived += flow.receive(number * 0.02)
    ends = [encoders[1].encode(common.Ping(seq=number)) for number in range(ENDS)]
    return [*arrived, *flow.receive(float("inf")), *ends]


async def receive(received: list[bytes], reader: str) -> Result:
    """Send datagrams to a node in groups; return what the node made of them."""
    async with Node("udpin://127.0.0.1:0", heartbeat=False) as node:
        assert (node._host.driver.native is not None) == (reader == "native")
        listened: list[tuple[int, str, int]] = []
        last: list[int] = []
        for kind in LISTENED:
            node.add_packet_listener(
                kind, lambda packet: listened.append((packet.system, packet.name, packet.sequence))
            )
        node.add_listener(common.Ping, lambda message: last.append(message.seq))
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
            sock.connect(node.links[0].address)
            sock.send(Encoder(1, 1).encode(AUTOPILOT))
            await node.wait_for_autopilot(timeout=20)
            vehicle = Vehicle(node, node.component(1))
            for number, data in enumerate(received):
                sock.send(data)
                if number % GROUP == 0:
                    await asyncio.sleep(0)
        await wait_until(lambda: last and last[-1] == ENDS - 1)
        (channel,) = node.links[0].channels
        parser = node.channel_state(channel).parser
        lost = {source: each.lost for source, each in parser.sources.items()}
        latest = [vehicle.latest(kind) for kind in (common.Attitude, common.SysStatus, common.Heartbeat)]
        return Result(listened, parser.statistics.packets, parser.statistics.bad_bytes, lost, latest)


def expected(received: list[bytes]) -> tuple[list[tuple[int, str, int]], int, int]:
    """Return the result of a parser alone: listened packets, the number of packets, and of bad bytes."""
    parser, first = Parser(common), Encoder(1, 1).encode(AUTOPILOT)
    packets = [packet for data in (first, *received) for packet in parser.feed(data)]
    listened = [
        (each.system, each.name, each.sequence) for each in packets if isinstance(each.message, LISTENED)
    ]
    return listened, parser.statistics.packets, parser.statistics.bad_bytes


def compare_readers(seed: int) -> None:
    received, results = datagrams(seed), {}
    for reader in ("native", "asyncio"):
        with pytest.MonkeyPatch.context() as patch:
            patch.setenv("MAVSTACK_INPUT", reader)
            results[reader] = asyncio.run(receive(received, reader))
    assert results["native"] == results["asyncio"]
    assert results["native"][:3] == expected(received)


@pytest.mark.timeout(120)
def test_both_readers_handle_the_same_packets(seeds: Seeds) -> None:
    seeds.check(compare_readers)
