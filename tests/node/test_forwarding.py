"""Forwarding over memory links, in both directions, byte for byte."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.dialects import common
from mavstack.errors import LinkError, MavstackError
from mavstack.links import BytesReceived, MemoryNetwork
from mavstack.node import Node
from mavstack.node.forwarding import Forwarding
from mavstack.sim.virtual import run_virtually
from mavstack.wire import Encoder, Parser

VEHICLE, OTHER, STATION = Encoder(1, 1), Encoder(2, 1), Encoder(254, 190)
#: A message id that no dialect defines.
UNKNOWN_ID = 50_000


class LinkPeer:
    """The far end of a link: records received bytes, and sends."""

    def __init__(self, link):
        self.link = link
        self.parser = Parser(common)
        self.data = b""

    async def listen(self):
        async for event in self.link:
            if isinstance(event, BytesReceived):
                self.data += bytes(event.data)

    def write(self, data):
        for channel in self.link.channels:
            channel.write(data)

    def has_received(self, raw):
        return raw in self.data


def unknown_packet():
    """Return a packet with an unknown message id."""
    raw = bytearray(VEHICLE.encode(common.Attitude(roll=1.0)))
    raw[7:10] = UNKNOWN_ID.to_bytes(3, "little")
    crc = 0xFFFF
    for byte in [*raw[1:-2], 77]:  # the last one is its CRC_EXTRA
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ (0x8408 if crc & 1 else 0)
    raw[-2:] = crc.to_bytes(2, "little")
    return bytes(raw)


def run_forwarding(scenario):
    """Run a scenario with a node, two vehicles on links of their own, and a station on an output."""

    async def run():
        networks = [MemoryNetwork() for _ in range(3)]
        ends = [LinkPeer(network.link()) for network in networks]
        links = [network.link() for network in networks]
        for end in ends:
            await end.link.open()
        async with Node(*links[:2], heartbeat=False) as node, Forwarding(node) as forwarding:
            tasks = [asyncio.create_task(end.listen()) for end in ends]
            output = await forwarding.add(links[2])
            await asyncio.sleep(0.1)
            await scenario(*ends, forwarding, output)
            for task in tasks:
                task.cancel()
        for end in ends:
            await end.link.close()

    run_virtually(run())


def test_received_packets_reach_the_output_unchanged():
    async def scenario(first, second, station, forwarding, output):
        packets = [VEHICLE.encode(common.Attitude(roll=0.25)), unknown_packet()]
        first.write(b"garbage" + packets[0][:9])
        first.write(packets[0][9:] + packets[1])
        second.write(other := OTHER.encode(common.Heartbeat()))
        await asyncio.sleep(0.1)
        assert station.data.count(packets[0]) == 1
        assert station.has_received(packets[1])
        assert station.has_received(other)
        assert not station.has_received(b"garbage")
        assert not second.has_received(packets[0])
        assert output.sent == 3

    run_forwarding(scenario)


def test_packets_of_the_output_reach_their_target_unchanged():
    async def scenario(first, second, station, forwarding, output):
        first.write(VEHICLE.encode(common.Heartbeat()))
        second.write(OTHER.encode(common.Heartbeat()))
        await asyncio.sleep(0.1)
        command = STATION.encode(common.CommandLong(target_system=2, target_component=1, command=400))
        station.write(command[:5])
        station.write(command[5:])
        station.write(heartbeat := STATION.encode(common.Heartbeat(type=common.MavType.GCS)))
        await asyncio.sleep(0.1)
        assert second.data.count(command) == 1
        assert not first.has_received(command)
        assert first.has_received(heartbeat)
        assert second.has_received(heartbeat)
        assert output.received == 2

    run_forwarding(scenario)


def test_signed_packets_are_forwarded_unchanged():
    async def scenario(first, second, station, forwarding, output):
        from mavstack.security import SigningKey

        encoder = Encoder(1, 1, signing=SigningKey(bytes(range(32))).signing())
        first.write(raw := encoder.encode(common.Attitude(roll=0.5), 1_700_000_000.0))
        await asyncio.sleep(0.1)
        assert station.has_received(raw)

    run_forwarding(scenario)


def test_an_output_can_be_removed_and_cannot_be_added_twice():
    async def scenario(first, second, station, forwarding, output):
        with pytest.raises(LinkError, match="already"):
            await forwarding.add(MemoryNetwork().link())
        with pytest.raises(MavstackError, match="outputs: memory"):
            await forwarding.remove("udpout://127.0.0.1:9")
        assert await forwarding.remove(0) is output
        assert forwarding.outputs == ()
        first.write(VEHICLE.encode(common.Attitude()))
        await asyncio.sleep(0.1)
        assert station.data == b""

    run_forwarding(scenario)
