"""Packets that wait in the core when a channel opens, gets a key or closes are handled, not dropped."""

from __future__ import annotations

import asyncio
import os
import socket
from contextlib import ExitStack
from itertools import pairwise
from time import sleep, time

import pytest

from mavstack.dialects import common
from mavstack.links import ChannelClosed
from mavstack.node import Node
from mavstack.security import SigningKey
from mavstack.vehicle import Vehicle
from mavstack.wire import Encoder
from tests.links.test_native_stream import vehicle_on
from tests.node.test_native_input import AUTOPILOT, Sender, arrivals, flush, granted, native
from tests.waiting import wait_until

pytestmark = pytest.mark.skipif(os.name != "posix", reason="the event loop waits for no descriptor")

COUNT = 3000
DATAGRAMS = 400


def fill(node, vehicle, encode) -> list[int]:
    """Let packets wait in the core, while the event loop does not turn; return the list of received ones."""
    received: list[int] = []
    node.add_listener(common.VfrHud, lambda message: received.append(message.heading))
    data = b"".join(encode(common.VfrHud(heading=number)) for number in range(COUNT))
    assert vehicle.fill(data) == len(data)
    sleep(0.1)
    assert not received
    return received


async def test_packets_that_wait_when_a_channel_closes_are_handled_before_its_end(tmp_path):
    async with vehicle_on("unix", tmp_path) as (node, vehicle), node.events(ChannelClosed) as events:
        received = fill(node, vehicle, vehicle.encoder.encode)
        node.links[0].channels[0].close()
        await asyncio.wait_for(anext(events), 20)
        assert received == list(range(len(received)))
        assert len(received) == COUNT


async def test_packets_that_wait_when_a_key_is_set_are_verified_with_it(tmp_path):
    key = SigningKey.generate()
    async with vehicle_on("unix", tmp_path) as (node, vehicle):
        signed = Encoder(1, 1, signing=key.signing())

        def encode(message: common.VfrHud) -> bytes:
            return signed.encode(message, time()) if message.heading % 2 else vehicle.encoder.encode(message)

        received = fill(node, vehicle, encode)
        state = node.channel_state(node.links[0].channels[0])
        state.signing = key.signing()
        await wait_until(lambda: len(received) == COUNT // 2)
        assert received == list(range(1, COUNT, 2))
        assert state.signing.refusals.unsigned == COUNT // 2


def send_in_turns(address) -> list[tuple[int, int]]:
    """Send datagrams of two vehicles while the event loop does not turn; return their systems and numbers."""
    sent = [(number % 2 + 1, number) for number in range(DATAGRAMS)]
    encoders = {system: Encoder(system, 1) for system in (1, 2)}
    with ExitStack() as stack:
        opened = [stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) for _ in encoders]
        for system, number in sent:
            opened[system - 1].sendto(encoders[system].encode(common.VfrHud(heading=number)), address)
    sleep(0.1)
    return sent


async def test_datagrams_that_wait_before_their_channels_are_attached_are_handled_in_order():
    async with Node("udpin://127.0.0.1:0", heartbeat=False) as node:
        received: list[tuple[int, int]] = []
        node.add_packet_listener(
            common.VfrHud, lambda packet: received.append((packet.system, packet.message.heading))
        )
        sent = send_in_turns(node.links[0].address)
        await wait_until(lambda: len(received) == DATAGRAMS)
        assert received == sent


async def test_a_vehicle_that_sends_much_from_its_first_packet_on_loses_nothing_and_keeps_its_order():
    async with Node("udpin://127.0.0.1:0", heartbeat=False) as node:
        sender = Sender(node.links[0].address[1])
        everything, headings = [], []
        node.add_packet_listener(None, lambda packet: everything.append(packet.sequence))
        node.add_listener(common.VfrHud, lambda message: headings.append(message.heading))
        for number in range(300):
            sender.send(AUTOPILOT, common.Attitude(time_boot_ms=number))
            for _ in range(5):
                sender.send(common.VfrHud(heading=number))
            if number % 60 == 59:
                await asyncio.sleep(0)  # part of them come while the channel is opened
        await flush(node, sender)
        (reading,) = native(node)._readings.values()
        assert reading._taken_over_at is None
        assert headings == [number for number in range(300) for _ in range(5)]
        assert all((after - before) % 256 == 1 for before, after in pairwise(everything))
        (channel,) = node.links[0].channels
        assert node.channel_state(channel).parser.sources[1, 1].lost == 0
        sender.socket.close()


async def test_packets_that_wait_when_their_source_is_granted_are_left_out_too():
    async with Node("udpin://127.0.0.1:0", heartbeat=False) as node:
        sender = Sender(node.links[0].address[1])
        sender.send(AUTOPILOT)
        await node.wait_for_autopilot(timeout=20)
        vehicle = Vehicle(node, node.component(1))
        await granted(node, sender)
        sender.send(common.VfrHud())
        await flush(node, sender)
        node._host.intake.revoke_all()
        names = arrivals(node)
        for number in range(4000):
            sender.send(common.VfrHud(alt=number))
        (channel,) = node.links[0].channels
        await wait_until(lambda: node.channel_state(channel).parser.statistics.packets > 4000)
        await flush(node, sender)
        assert 0 < names.count("VFR_HUD") < 4000
        assert vehicle.latest(common.VfrHud).alt == 3999
        sender.socket.close()
