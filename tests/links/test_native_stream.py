"""A thread of the core reads connections and serial ports; nothing is lost, and ends are found."""

from __future__ import annotations

import asyncio
import errno
import os
import socket
from contextlib import asynccontextmanager
from time import sleep, time
from types import SimpleNamespace

import pytest

from mavstack.dialects import common
from mavstack.links import ChannelClosed, native_stream
from mavstack.links.native_stream import StreamReading
from mavstack.node import Node
from mavstack.security import SigningKey
from mavstack.wire import Encoder
from tests.waiting import wait_until

pytestmark = pytest.mark.skipif(os.name != "posix", reason="the event loop waits for no descriptor")

AUTOPILOT = common.Heartbeat(type=common.MavType.QUADROTOR, autopilot=common.MavAutopilot.PX4)


class Vehicle:
    """A vehicle at the other end of a stream, by its descriptor."""

    def __init__(self, descriptor: int) -> None:
        self.descriptor = descriptor
        self.encoder = Encoder(1, 1)
        self.written = 0
        os.set_blocking(descriptor, False)

    async def write(self, data: bytes) -> None:
        self.written += len(data)
        while data:
            try:
                data = data[os.write(self.descriptor, data) :]
            except BlockingIOError:
                await asyncio.sleep(0.001)

    def fill(self, data: bytes) -> int:
        """Write until the system accepts no more; return the number of bytes."""
        sent = refused = 0
        while sent < len(data) and refused < 50:
            try:
                sent += os.write(self.descriptor, data[sent : sent + 65536])
                refused = 0
            except BlockingIOError:
                refused += 1
                sleep(0.002)
        return sent

    def end(self) -> None:
        """Close the stream, and give the thread time to find its end before the event loop turns."""
        os.close(self.descriptor)
        self.descriptor = -1
        sleep(0.1)

    async def send(self, *messages) -> None:
        await self.write(b"".join(self.encoder.encode(message) for message in messages))


@asynccontextmanager
async def tcp_client():
    with socket.create_server(("127.0.0.1", 0)) as server:

        def connect(node):
            return server.accept()[0].detach()

        yield f"tcpout://127.0.0.1:{server.getsockname()[1]}?reconnect=no", connect


@asynccontextmanager
async def tcp_server():
    yield (
        "tcpin://127.0.0.1:0",
        lambda node: socket.create_connection(node.links[0].address).detach(),
    )


@asynccontextmanager
async def unix(folder):
    path = str(folder / "s")
    with socket.socket(socket.AF_UNIX) as server:
        server.bind(path)
        server.listen()
        yield f"unix://{path}?reconnect=no", lambda node: server.accept()[0].detach()


@asynccontextmanager
async def serial():
    pytest.importorskip("serial")
    master, slave = os.openpty()
    yield f"serial://{os.ttyname(slave)}?reconnect=no", lambda node: os.close(slave) or master


STREAMS = ("tcp_client", "tcp_server", "unix", "serial")


@asynccontextmanager
async def vehicle_on(stream, tmp_path, **options):
    """Open a node, and a vehicle that is known and whose stream is read by the thread."""
    opened = unix(tmp_path) if stream == "unix" else globals()[stream]()
    async with opened as (url, connect), Node(url, heartbeat=False, **options) as node:
        vehicle = Vehicle(connect(node))
        try:
            await vehicle.send(AUTOPILOT)
            await node.wait_for_autopilot(timeout=20)
            await wait_until(lambda: readings(node))
            yield node, vehicle
        finally:
            if vehicle.descriptor >= 0:
                os.close(vehicle.descriptor)


def readings(node):
    return [each for each in node._host.driver.native._readings.values() if isinstance(each, StreamReading)]


@pytest.mark.parametrize("stream", STREAMS)
async def test_every_packet_comes_in_order_and_is_counted(stream, tmp_path):
    async with vehicle_on(stream, tmp_path) as (node, vehicle):
        received = []
        node.add_listener(common.VfrHud, lambda message: received.append(message.heading))
        for start in range(0, 2000, 100):
            await vehicle.send(*[common.VfrHud(heading=start + number) for number in range(100)])
            await asyncio.sleep(0)
        await wait_until(lambda: len(received) >= 2000)
        assert received == list(range(2000))
        (channel,) = node.links[0].channels
        state = node.channel_state(channel)
        assert state.parser.sources[1, 1].lost == 0
        assert state.parser.statistics.packets == 2001
        assert channel.counters.bytes_in == vehicle.written
        assert channel.last_valid > 0


@pytest.mark.parametrize("stream", STREAMS)
async def test_packets_before_the_end_come_before_it_and_the_end_is_reported(stream, tmp_path):
    async with vehicle_on(stream, tmp_path) as (node, vehicle), node.events(ChannelClosed) as events:
        received = []
        node.add_listener(common.VfrHud, lambda message: received.append(message.heading))
        await vehicle.send(*[common.VfrHud(heading=number) for number in range(300)])
        if stream == "serial":  # a terminal that is closed drops what was not read
            await wait_until(lambda: len(received) == 300)
        os.close(vehicle.descriptor)
        vehicle.descriptor = -1
        closed = await asyncio.wait_for(anext(events), 20)
        assert received == list(range(300))
        assert closed.reason in ("closed by the peer", *map(os.strerror, (errno.EIO, errno.ECONNRESET)))
        assert not readings(node)


async def test_an_end_that_the_thread_finds_first_waits_for_all_packets_before_it(tmp_path):
    async with vehicle_on("unix", tmp_path) as (node, vehicle), node.events(ChannelClosed) as events:
        received = []
        node.add_listener(common.VfrHud, lambda message: received.append(message.heading))
        data = b"".join(vehicle.encoder.encode(common.VfrHud(heading=number)) for number in range(3000))
        assert vehicle.fill(data) == len(data)  # the event loop does not turn, the thread reads
        vehicle.end()
        await asyncio.wait_for(anext(events), 20)
        assert received == list(range(3000))


async def test_the_reason_of_a_reset_is_reported(tmp_path):
    async with vehicle_on("tcp_client", tmp_path) as (node, vehicle), node.events(ChannelClosed) as events:
        with socket.socket(fileno=vehicle.descriptor) as connection:
            vehicle.descriptor = -1
            connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, b"\1\0\0\0\0\0\0\0")
        assert (await asyncio.wait_for(anext(events), 20)).reason == "Connection reset by peer"


@pytest.mark.parametrize("stream", STREAMS)
async def test_the_node_answers_on_a_stream_that_the_thread_reads(stream, tmp_path):
    async with vehicle_on(stream, tmp_path) as (node, vehicle):
        node.send(common.Ping(seq=7, target_system=1, target_component=1))
        await wait_until(lambda: node.links[0].counters.chunks_out)
        data = b""
        while len(data) < 12:
            try:
                data += os.read(vehicle.descriptor, 1000)
            except BlockingIOError:
                await asyncio.sleep(0.001)
        assert data[:1] == b"\xfd"


async def test_a_slow_program_slows_down_the_sender_and_loses_nothing(tmp_path):
    async with vehicle_on("tcp_client", tmp_path) as (node, vehicle):
        numbers = []
        node.add_listener(common.NamedValueInt, lambda message: numbers.append(message.value))
        data = b"".join(
            vehicle.encoder.encode(common.NamedValueInt(name="n", value=number)) for number in range(400_000)
        )
        sent = vehicle.fill(data)  # the program takes nothing: its event loop does not turn
        assert sent < len(data), "the bytes that wait are bounded"
        await vehicle.write(data[sent:])
        await wait_until(lambda: len(numbers) == 400_000)
        assert numbers == list(range(400_000))
        assert not node.links[0].counters.dropped_in


async def test_a_key_returns_the_stream_to_the_event_loop(tmp_path):
    key = SigningKey.generate()
    async with vehicle_on("tcp_client", tmp_path) as (node, vehicle):
        (channel,) = node.links[0].channels
        state = node.channel_state(channel)
        state.signing = key.signing()
        assert not readings(node)
        received = []
        node.add_listener(common.VfrHud, received.append)
        signed = Encoder(1, 1, signing=key.signing())
        await vehicle.write(signed.encode(common.VfrHud(heading=5), time()))
        await wait_until(lambda: received)


@pytest.mark.parametrize("stream", STREAMS)
@pytest.mark.parametrize("step", ["dup", "isatty"])
async def test_the_event_loop_reads_a_stream_for_which_no_descriptor_is_left(
    stream, step, tmp_path, monkeypatch
):
    def refuse(descriptor):
        raise OSError(errno.EMFILE, os.strerror(errno.EMFILE))

    monkeypatch.setattr(native_stream, "os", SimpleNamespace(**(vars(os) | {step: refuse})))
    async with vehicle_on(stream, tmp_path) as (node, vehicle), node.events(ChannelClosed) as events:
        received = []
        node.add_listener(common.VfrHud, received.append)
        await vehicle.send(*[common.VfrHud(heading=number) for number in range(100)])
        await wait_until(lambda: len(received) == 100)
        assert node.links[0].counters.bytes_in == vehicle.written
        os.close(vehicle.descriptor)
        vehicle.descriptor = -1
        await asyncio.wait_for(anext(events), 20)
