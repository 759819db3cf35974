"""The core and the event loop read the same links with the same results, whichever of them a node uses."""

from __future__ import annotations

import asyncio
import os
import socket
from contextlib import asynccontextmanager
from time import time
from typing import TYPE_CHECKING

import pytest

from mavstack.dialects import common
from mavstack.links import ChannelClosed
from mavstack.node import Node
from mavstack.security import SigningKey
from mavstack.wire import Encoder
from tests.links import test_native_stream as streams
from tests.links.test_native_stream import AUTOPILOT, Vehicle
from tests.waiting import wait_until

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Callable
    from contextlib import AbstractAsyncContextManager
    from pathlib import Path

    Opened = AbstractAsyncContextManager[tuple[str, Callable[[Node], int]]]

pytestmark = pytest.mark.skipif(os.name != "posix", reason="the event loop waits for no descriptor")

GROUP = "239.255.77.2"


def datagrams_to(address: tuple[str, int], source: tuple[str, int] | None = None) -> int:
    """Return the descriptor of a socket that sends to an address, from another one."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        if source is not None:
            sock.bind(source)
        sock.connect(address)
        return sock.detach()


@asynccontextmanager
async def udp_server() -> AsyncIterator[tuple[str, Callable[[Node], int]]]:
    yield (
        "udpin://127.0.0.1:0?socket_buffer=4M",
        lambda node: datagrams_to(("127.0.0.1", node.links[0].address[1])),
    )


@asynccontextmanager
async def udp_client() -> AsyncIterator[tuple[str, Callable[[Node], int]]]:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as reserved:
        reserved.bind(("127.0.0.1", 0))
        peer = reserved.getsockname()
    yield (
        f"udpout://127.0.0.1:{peer[1]}?socket_buffer=4M",
        lambda node: datagrams_to(("127.0.0.1", node.links[0].address[1]), peer),
    )


@asynccontextmanager
async def multicast() -> AsyncIterator[tuple[str, Callable[[Node], int]]]:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        try:
            sock.connect((GROUP, 9))
        except OSError:
            pytest.skip("no route for multicast")
    yield (
        f"udpin://{GROUP}:0?socket_buffer=4M",
        lambda node: datagrams_to((GROUP, node.links[0].address[1])),
    )


KINDS: dict[str, Callable[[Path], Opened]] = {
    "udpin": lambda folder: udp_server(),
    "udpout": lambda folder: udp_client(),
    "multicast": lambda folder: multicast(),
    "tcpin": lambda folder: streams.tcp_server(),
    "tcpout": lambda folder: streams.tcp_client(),
    "unix": streams.unix,
    "serial": lambda folder: streams.serial(),
}
#: Kinds of links that open a channel with the first datagram of a sender.
ADMITTING = ("udpin", "multicast")


@pytest.fixture(params=["native", "asyncio"])
def reader(request, monkeypatch):
    """Choose the reader of links."""
    monkeypatch.setenv("MAVSTACK_INPUT", request.param)
    return request.param


@pytest.fixture(params=list(KINDS))
def kind(request):
    return request.param


@asynccontextmanager
async def vehicle_on(kind, folder, reader):
    """Open a node with one link, and a vehicle that it knows."""
    async with KINDS[kind](folder) as (url, connect), Node(url, heartbeat=False) as node:
        assert (node._host.driver.native is not None) == (reader == "native")
        vehicle = Vehicle(connect(node))
        try:
            await vehicle.send(AUTOPILOT)
            await node.wait_for_autopilot(timeout=20)
            yield node, vehicle
        finally:
            if vehicle.descriptor >= 0:
                os.close(vehicle.descriptor)


def headings(node) -> list[int]:
    """Return a list of the headings that a node receives from now on."""
    received: list[int] = []
    node.add_listener(common.VfrHud, lambda message: received.append(message.heading))
    return received


async def test_packets_come_in_order_and_the_lost_ones_are_counted(reader, kind, tmp_path):
    async with vehicle_on(kind, tmp_path, reader) as (node, vehicle):
        received = headings(node)
        for number in range(300):
            if number % 10 == 3:
                vehicle.encoder.sequence = (vehicle.encoder.sequence + 2) % 256
            await vehicle.send(common.VfrHud(heading=number), common.Attitude(roll=number))
        await wait_until(lambda: len(received) == 300)
        assert received == list(range(300))
        (channel,) = node.links[0].channels
        state = node.channel_state(channel)
        await wait_until(lambda: state.parser.statistics.packets == 601)
        assert state.parser.sources[1, 1].lost == 60
        assert state.parser.statistics.bad_bytes == 0
        assert channel.counters.bytes_in == vehicle.written
        assert channel.counters.dropped_in == 0
        assert channel.last_valid > 0


async def test_noise_and_damaged_packets_are_counted(reader, kind, tmp_path):
    async with vehicle_on(kind, tmp_path, reader) as (node, vehicle):
        received = headings(node)
        data = bytearray(vehicle.encoder.encode(common.VfrHud(heading=7)))
        data[-1] ^= 1
        await vehicle.write(bytes(data))
        await vehicle.write(b"noise")
        await vehicle.send(common.VfrHud(heading=8))
        await wait_until(lambda: received)
        assert received == [8]
        (channel,) = node.links[0].channels
        statistics = node.channel_state(channel).parser.statistics
        assert statistics.bad_bytes == len(data) + len(b"noise")


async def test_a_key_refuses_unsigned_packets_and_accepts_signed_ones(reader, kind, tmp_path):
    key = SigningKey.generate()
    async with vehicle_on(kind, tmp_path, reader) as (node, vehicle):
        received = headings(node)
        await vehicle.send(common.VfrHud(heading=1))
        await wait_until(lambda: received)
        state = node.channel_state(node.links[0].channels[0])
        state.signing = key.signing()
        await vehicle.send(common.VfrHud(heading=2))
        signed = Encoder(1, 1, signing=key.signing())
        await vehicle.write(signed.encode(common.VfrHud(heading=3), time()))
        await wait_until(lambda: len(received) == 2)
        assert received == [1, 3]
        assert state.signing.refusals.unsigned == 1


async def test_a_closed_channel_is_reported_and_the_next_packets_open_another_one(reader, kind, tmp_path):
    async with vehicle_on(kind, tmp_path, reader) as (node, vehicle), node.events(ChannelClosed) as events:
        received = headings(node)
        (channel,) = node.links[0].channels
        await vehicle.send(*[common.VfrHud(heading=number) for number in range(50)])
        await wait_until(lambda: len(received) == 50)
        channel.close()
        closed = await asyncio.wait_for(anext(events), 20)
        assert closed.channel is channel
        assert channel.counters.bytes_in == vehicle.written
        if kind in ADMITTING:
            await vehicle.send(common.VfrHud(heading=50))
            await wait_until(lambda: received[-1] == 50)


async def test_a_node_opens_the_link_again(reader, kind, tmp_path):
    for turn in range(2):
        folder = tmp_path / str(turn)
        folder.mkdir()
        async with vehicle_on(kind, folder, reader) as (node, vehicle):
            received = headings(node)
            await vehicle.send(*[common.VfrHud(heading=number) for number in range(20)])
            await wait_until(lambda received=received: len(received) == 20)


def recording(path: Path, count: int, *, is_timed: bool) -> None:
    """Write a file of packets, with the times of a tlog or without times."""
    encoder = Encoder(1, 1)
    with path.open("wb") as file:
        for number in range(count):
            message = common.VfrHud(heading=number % 30_000) if number else AUTOPILOT
            stamp = (1_700_000_000_000_000 + number * 1000).to_bytes(8, "big") if is_timed else b""
            file.write(stamp + encoder.encode(message))


@pytest.mark.parametrize("is_timed", [True, False])
async def test_a_file_is_received_completely(reader, is_timed, tmp_path):
    path = tmp_path / "flight.tlog"
    recording(path, 20_000, is_timed=is_timed)
    async with Node(heartbeat=False) as node, node.events(ChannelClosed) as events:
        received = headings(node)
        link = await node.add_link(f"file://{path}?speed=max")
        closed = await asyncio.wait_for(anext(events), 20)
        assert closed.reason == "end of file"
        assert received == list(range(1, 20_000))
        assert link.counters.dropped_in == 0
