"""The thread that reads UDP links leaves out packets that are not wanted, and no others."""

from __future__ import annotations

import asyncio
import os
import socket
from contextlib import asynccontextmanager
from itertools import pairwise
from time import time

import pytest

import mavstack
from mavstack.dialects import Dialect, common
from mavstack.node import Node
from mavstack.node.message_fields import BOOT_FIELDS, POSITION_FIELDS
from mavstack.security import SigningKey
from mavstack.services.heartbeat import AddressConflict
from mavstack.vehicle import Vehicle
from tests.waiting import wait_until

pytestmark = pytest.mark.skipif(os.name != "posix", reason="the event loop waits for no descriptor")

DIALECT = Dialect.load("all")
AUTOPILOT = common.Heartbeat(type=common.MavType.QUADROTOR, autopilot=common.MavAutopilot.PX4)


class Sender:
    """A vehicle: a socket that sends messages."""

    def __init__(self, port: int, system: int = 1) -> None:
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.connect(("127.0.0.1", port))
        self.system = system
        self.sequence = 0

    def send(self, *messages, signing=None) -> None:
        for message in messages:
            encoder = mavstack.Encoder(self.system, 1, signing=signing)
            encoder.sequence = self.sequence
            self.sequence = (self.sequence + 1) % 256
            self.socket.send(encoder.encode(message, None if signing is None else time()))


@asynccontextmanager
async def vehicle_on(query: str = "", **options):
    """Open a node, and a vehicle that is known and whose channel is read by the thread."""
    async with Node(f"udpin://127.0.0.1:0{query}", heartbeat=False, **options) as node:
        sender = Sender(node.links[0].address[1])
        sender.send(AUTOPILOT)
        await node.wait_for_autopilot(timeout=20)
        yield node, sender
        sender.socket.close()


def native(node: Node):
    return node._host.driver.native


async def granted(node: Node, sender: Sender) -> None:
    """Wait until the packets of the vehicle need not come any more."""
    async with asyncio.timeout(20):
        while not node._host.intake.sources():
            sender.send(AUTOPILOT)
            await asyncio.sleep(0.01)


async def flush(node: Node, sender: Sender) -> None:
    """Wait until everything sent so far was handled."""
    seen = []
    with_listener = node.add_listener(common.Ping, seen.append)
    sender.send(common.Ping(seq=1, target_system=255, target_component=190))
    await wait_until(lambda: seen)
    with_listener.close()


def arrivals(node: Node) -> list[str]:
    """Return a list of the names of the packets that come to the engine from now on."""
    names: list[str] = []
    handle = node._host.engine.handle

    def record(state, packets, now):
        names.extend(packet.name for packet in packets)
        return handle(state, packets, now)

    node._host.engine.handle = record
    return names


async def test_packets_that_are_not_wanted_do_not_come_and_are_counted_and_kept():
    async with vehicle_on() as (node, sender):
        vehicle = Vehicle(node, node.component(1))
        await granted(node, sender)
        sender.send(common.VfrHud(alt=1))
        await flush(node, sender)
        names = arrivals(node)
        (channel,) = node.links[0].channels
        packets = node.channel_state(channel).parser.statistics.packets
        for number in range(50):
            sender.send(common.VfrHud(alt=number))
        await flush(node, sender)
        assert "VFR_HUD" not in names
        assert vehicle.latest(common.VfrHud).alt == 49
        assert vehicle.latest(common.VfrHud) is vehicle.latest(common.VfrHud)
        assert vehicle.age(common.VfrHud) < 20
        state = node.channel_state(channel)
        assert state.parser.statistics.packets == packets + 51
        assert state.parser.sources[1, 1].lost == 0
        assert channel.counters.chunks_in >= 51
        assert channel.last_valid > 0


async def test_every_packet_of_a_listener_comes_in_order():
    async with vehicle_on() as (node, sender):
        await granted(node, sender)
        sender.send(common.VfrHud())
        await flush(node, sender)
        everything, own = [], []
        node.add_packet_listener(None, everything.append)
        node.add_listener(common.VfrHud, lambda message: own.append(message.heading))
        async with node.stream(common.VfrHud, keep_all=True) as stream:
            for number in range(360):
                sender.send(common.VfrHud(heading=number), common.Attitude())
                if number % 20 == 0:
                    await asyncio.sleep(0)
            await flush(node, sender)
            assert own == [each.heading for each in stream.drain()] == list(range(360))
        sequences = [packet.sequence for packet in everything]
        assert len(sequences) >= 721
        assert all((after - before) % 256 == 1 for before, after in pairwise(sequences))


async def test_a_listener_that_ends_lets_packets_be_left_out_again():
    async with vehicle_on() as (node, sender):
        await granted(node, sender)
        listener = node.add_packet_listener(None, lambda packet: None)
        sender.send(common.VfrHud())
        await flush(node, sender)
        listener.close()
        sender.send(common.VfrHud())
        await flush(node, sender)
        names = arrivals(node)
        sender.send(*[common.VfrHud()] * 20)
        await flush(node, sender)
        assert "VFR_HUD" not in names


async def test_a_source_on_a_second_channel_comes_whole_and_each_packet_once():
    async with vehicle_on() as (node, sender):
        await granted(node, sender)
        other = Sender(node.links[0].address[1])
        other.sequence = sender.sequence
        sender.send(AUTOPILOT)
        other.send(AUTOPILOT)
        await flush(node, sender)
        assert not node._host.intake.sources()
        received = []
        node.add_listener(common.VfrHud, received.append)
        other.sequence = sender.sequence
        for number in range(20):
            sender.send(common.VfrHud(heading=number))
            other.send(common.VfrHud(heading=number))
        await flush(node, sender)
        assert [message.heading for message in received] == list(range(20))
        other.socket.close()


async def test_two_vehicles_with_one_id_on_one_channel_are_found():
    async with vehicle_on() as (node, sender), node.events(AddressConflict) as events:
        await granted(node, sender)
        north, south = (
            common.GlobalPositionInt(lat=lat, lon=1, time_boot_ms=1000) for lat in (470_000_000, 480_000_000)
        )
        sender.send(north)
        await flush(node, sender)
        for number in range(12):
            sender.send(
                *(each.__class__(lat=each.lat, lon=1, time_boot_ms=1000 + number) for each in (north, south))
            )
        await asyncio.wait_for(anext(events), 20)


async def test_a_choice_of_a_sender_lets_every_packet_come():
    async with vehicle_on() as (node, sender):
        await granted(node, sender)
        node.choose_sender(1, node.links[0].channels[0])
        assert not node._host.intake.sources()
        sender.send(common.VfrHud())
        await flush(node, sender)
        assert not node._host.intake.sources()


async def test_a_key_lets_the_engine_verify_every_packet():
    key = SigningKey.generate()
    async with vehicle_on() as (node, sender):
        await granted(node, sender)
        (channel,) = node.links[0].channels
        state = node.channel_state(channel)
        state.signing = key.signing()
        received = []
        node.add_listener(common.VfrHud, received.append)
        signing = key.signing(timestamp=state.clock + 1)
        sender.send(common.VfrHud(heading=1))
        sender.send(common.VfrHud(heading=2), signing=signing)
        await wait_until(lambda: received)
        assert [message.heading for message in received] == [2]
        assert state.signing.refusals.unsigned == 1
        assert not native(node)._attached


async def test_a_vehicle_that_only_sends_attitudes_is_alive():
    async with vehicle_on() as (node, sender):
        await granted(node, sender)
        sender.send(common.Attitude(time_boot_ms=1000))
        await flush(node, sender)
        before = node.components[(1, 1)].last_seen
        await asyncio.sleep(0.02)
        sender.send(common.Attitude(time_boot_ms=1020))
        await flush(node, sender)
        discovery = node._host.discovery
        assert max(seen_at for *_, seen_at in discovery.filters.last_seen()) > before


async def test_a_node_that_opens_again_receives_again():
    async with Node("udpin://127.0.0.1:0", heartbeat=False) as node:
        assert native(node) is not None
        port = node.links[0].address[1]
    async with Node(f"udpin://127.0.0.1:{port}", heartbeat=False) as node:
        sender = Sender(port)
        sender.send(AUTOPILOT)
        await node.wait_for_autopilot(timeout=20)
        sender.socket.close()


async def test_a_closed_channel_opens_again_with_the_next_datagram():
    async with vehicle_on() as (node, sender):
        await granted(node, sender)
        node.links[0].channels[0].close()
        await wait_until(lambda: not node._host.engine.channels)
        sender.send(AUTOPILOT)
        await wait_until(lambda: node._host.engine.channels)


async def test_a_program_that_does_not_keep_up_loses_nothing_and_reads_natively_again():
    async with vehicle_on("?socket_buffer=4M") as (node, sender):
        await granted(node, sender)
        received = []
        node.add_listener(common.VfrHud, lambda message: received.append(message.heading))
        for number in range(3):
            for _ in range(60):
                sender.send(common.VfrHud(heading=number))
            await flush(node, sender)
        (reading,) = native(node)._readings.values()
        node._host.intake.remove_socket(reading.number)
        reading.take_over()
        sender.send(common.VfrHud(heading=3))
        await wait_until(lambda: received[-1] == 3)
        await wait_until(lambda: reading.is_due)
        sender.send(common.VfrHud(heading=4))
        await wait_until(lambda: reading._taken_over_at is None)
        sender.send(common.VfrHud(heading=5))
        await wait_until(lambda: received[-1] == 5)
        assert received == [0] * 60 + [1] * 60 + [2] * 60 + [3, 4, 5]


async def test_the_event_loop_waits_for_the_socket_while_packets_are_taken_and_the_thread_afterwards():
    async with vehicle_on() as (node, sender):
        await granted(node, sender)
        received = []
        listener = node.add_listener(common.VfrHud, received.append)
        async with asyncio.timeout(20):
            while not native(node)._is_direct:
                sender.send(common.VfrHud())
                await asyncio.sleep(0.01)
        sender.send(common.VfrHud(heading=5))
        await wait_until(lambda: received[-1].heading == 5)
        listener.close()
        async with asyncio.timeout(20):
            while native(node)._is_direct:
                sender.send(common.VfrHud())
                await asyncio.sleep(0.01)
        await flush(node, sender)


async def test_a_listener_that_fails_is_reported_and_the_others_are_called(caplog):
    async with vehicle_on() as (node, sender):
        await granted(node, sender)
        received = []
        failing = node.add_listener(common.VfrHud, lambda message: 1 // 0)
        node.add_listener(common.VfrHud, lambda message: received.append(message.heading))
        for number in range(5):
            sender.send(common.VfrHud(heading=number))
        await wait_until(lambda: len(received) == 5)
        failing.close()
        sender.send(common.VfrHud(heading=5))
        await wait_until(lambda: received == list(range(6)))
    assert "ZeroDivisionError" in caplog.text


async def test_a_listener_that_closes_itself_gets_no_further_packet():
    async with vehicle_on() as (node, sender):
        await granted(node, sender)
        received = []
        listeners = []

        def close(message):
            received.append(message)
            listeners[0].close()

        listeners.append(node.add_listener(common.VfrHud, close))
        sender.send(*[common.VfrHud()] * 30)
        await flush(node, sender)
        assert len(received) == 1


async def test_packets_of_a_stream_that_are_not_wanted_do_not_come_either():
    async with Node("tcpin://127.0.0.1:0", heartbeat=False) as node:
        _reader, writer = await asyncio.open_connection(*node.links[0].address)
        encoder = mavstack.Encoder(1, 1)
        writer.write(encoder.encode(AUTOPILOT))
        await node.wait_for_autopilot(timeout=20)
        vehicle = Vehicle(node, node.component(1))
        received = []
        node.add_listener(common.Attitude, lambda message: received.append(message.roll))
        for number in range(3):
            first, second = common.VfrHud(heading=number), common.Attitude(roll=number)
            data = encoder.encode(first) + encoder.encode(second)
            writer.write(data[:20])
            await asyncio.sleep(0.01)
            writer.write(data[20:])
            await wait_until(lambda wanted=number: received == list(range(wanted + 1)))
        names = arrivals(node)
        writer.write(encoder.encode(common.VfrHud(heading=9)) + encoder.encode(common.Attitude(roll=3)))
        await wait_until(lambda: len(received) == 4)
        assert "VFR_HUD" not in names
        assert vehicle.latest(common.VfrHud).heading == 9
        (channel,) = node.links[0].channels
        assert channel.last_valid > 0
        assert node.channel_state(channel).parser.sources[1, 1].lost == 0
        writer.close()
        await wait_until(lambda: not node._host.engine.channels)
        assert not native(node)._attached


async def test_the_event_loop_reads_if_the_environment_names_it(monkeypatch):
    monkeypatch.setenv("MAVSTACK_INPUT", "asyncio")
    async with vehicle_on() as (node, sender):
        assert native(node) is None
        vehicle = Vehicle(node, node.component(1))
        sender.send(common.VfrHud(alt=5))
        await flush(node, sender)
        assert vehicle.latest(common.VfrHud).alt == 5


async def test_another_look_follows_if_the_one_before_was_a_moment_ago(monkeypatch):
    async with vehicle_on() as (node, _):
        times, looks = iter((1e9, 1e9, 1e9 + 0.0001, 1e9)), []
        monkeypatch.setattr("mavstack.node.native_input.monotonic", lambda: next(times, 0.0))
        monkeypatch.setattr(native(node), "_take", lambda: looks.append(None) or len(looks) < 3)
        native(node)._on_readable()
        assert len(looks) == 1
        native(node)._on_readable()
        assert len(looks) == 3


def test_the_core_finds_the_fields():
    for kind in (common.SystemTime, common.Attitude, common.GlobalPositionInt, common.LocalPositionNed):
        payload = kind(time_boot_ms=0x01020304).to_payload()
        offset = BOOT_FIELDS[kind.__mavlink_row__[0]]
        assert payload[offset : offset + 4] == b"\x04\x03\x02\x01"
    message_id, latitude, longitude, north, east = POSITION_FIELDS
    payload = common.GlobalPositionInt(
        lat=0x01020304, lon=0x05060708, vx=0x090A, vy=0x0B0C, hdg=1
    ).to_payload()
    assert message_id == common.GlobalPositionInt.__mavlink_row__[0]
    assert payload[latitude : latitude + 4] == b"\x04\x03\x02\x01"
    assert payload[longitude : longitude + 4] == b"\x08\x07\x06\x05"
    assert payload[north : north + 2] == b"\x0a\x09"
    assert payload[east : east + 2] == b"\x0c\x0b"
