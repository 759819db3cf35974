from __future__ import annotations

import asyncio
import socket
import sys
from contextlib import asynccontextmanager
from time import time
from types import SimpleNamespace

import pytest

from mavstack._core import Intake
from mavstack.dialects import Dialect
from mavstack.errors import LinkError
from mavstack.links import BytesReceived, ChannelClosed, ChannelOpened, open_link
from mavstack.links.udp import UdpLink
from tests.waiting import wait_until

from .conformance import Conformance, receive
from .peers import UdpPeer

DIALECT = Dialect.load("all")


class TestUdpin(Conformance):
    datagrams = True
    greeting = b"hello"
    detects_disconnect = False

    @asynccontextmanager
    async def pair(self, query=""):
        link = open_link(f"udpin://127.0.0.1:0?trust_senders=yes&{query}".rstrip("&"))

        async def peer():
            return UdpPeer(link.address)

        yield link, peer


class TestUdpout(Conformance):
    datagrams = True
    detects_disconnect = False

    @asynccontextmanager
    async def pair(self, query=""):
        peer = UdpPeer()
        link = open_link(f"udpout://127.0.0.1:{peer.port}?{query}")

        async def open_peer():
            peer.target = ("127.0.0.1", link.address[1])
            return peer

        yield link, open_peer
        await peer.close()


class ReadNatively:
    """The datagrams of senders that are not attached take the way over the thread of the core."""

    @asynccontextmanager
    async def pair(self, query=""):
        async with super().pair(query) as (link, peer):
            open_transport, intake = link.open_transport, Intake(DIALECT, {}, (0,) * 5, (0,) * 5)

            def pump():
                _, datagrams, _, overloaded, _ = intake.take()
                for _, address, data, count in datagrams:
                    link.receive(data, address, count)
                for _ in overloaded:
                    reading.take_over()

            async def open_natively():
                nonlocal reading
                await open_transport()
                asyncio.get_running_loop().add_reader(descriptor, pump)
                reading = link.read_natively(intake, 1)

            reading, descriptor = None, intake.start(0.0)
            link.open_transport = open_natively
            try:
                yield link, peer
            finally:
                asyncio.get_running_loop().remove_reader(descriptor)
                intake.stop()


needs_descriptors = pytest.mark.skipif(
    sys.platform == "win32", reason="the event loop waits for no descriptor"
)


@needs_descriptors
class TestUdpinReadNatively(ReadNatively, TestUdpin):
    """A link that listens, read by the thread."""


@needs_descriptors
class TestUdpoutReadNatively(ReadNatively, TestUdpout):
    """A link with one peer, read by the thread."""


async def test_a_link_that_is_to_return_its_socket_handles_what_it_read_and_reads_no_more():
    async with open_link("udpin://127.0.0.1:0") as link:
        peer, returns = UdpPeer(link.address), []
        await peer.send(b"newer")
        link._native = SimpleNamespace(
            is_due=True, handled=lambda: returns.append(len(link._backlog)), stop=lambda: None
        )
        link._backlog.add((b"older", ("127.0.0.1", 9), 0.0), known=False)
        link._readable(link._socket)
        assert len(link._backlog) == 1
        link._handle_backlog()
        assert returns == [0]
        await peer.close()


async def test_the_socket_reader_calls_the_callback_in_order():
    async with open_link("udpin://127.0.0.1:0") as link:
        peer = UdpPeer(link.address)
        callers, data = [], []

        def callback(events):
            callers.append(sys._getframe(1).f_code.co_name)
            data.extend(event.data for event in events if isinstance(event, BytesReceived))

        reading = asyncio.create_task(link.read(callback))
        for number in range(10):
            await peer.send(bytes([number]))
            await wait_until(lambda number=number: len(data) > number)
        assert data == [bytes([number]) for number in range(10)]
        assert callers[0] == "run_reader"  # the first one is queued together with the event of the channel
        assert callers[-1] == "deliver"
        reading.cancel()
        await peer.close()


class WithoutReaders(asyncio.SelectorEventLoop):
    """An event loop without socket readers, like the proactor of Windows."""

    def add_reader(self, fd, callback, *args):  # type: ignore[override]
        raise NotImplementedError


def test_an_event_loop_without_socket_readers():
    async def exchange():
        async with open_link("udpin://127.0.0.1:0") as link:
            peer = UdpPeer(link.address)
            await peer.send(b"ping")
            channel = (await anext(link)).channel
            assert await receive(link, 4) == b"ping"
            assert channel.write(b"pong")
            await asyncio.sleep(0)
            peer.socket.settimeout(5)
            assert peer.socket.recv(100) == b"pong"
            await peer.close()

    with asyncio.Runner(loop_factory=WithoutReaders) as runner:
        runner.run(exchange())


async def test_a_reader_of_streams_gets_waiting_datagrams_of_one_sender_as_one_event():
    async with open_link("udpin://127.0.0.1:0") as link:
        link.joins_datagrams = True
        with socket.socket(type=socket.SOCK_DGRAM) as one, socket.socket(type=socket.SOCK_DGRAM) as other:
            for sender, data in ((one, b"a"), (one, b"b"), (other, b"x"), (one, b"c")):
                sender.sendto(data, link.address)
            events = [await anext(link) for _ in range(5)]
        chunks = [event.data for event in events if isinstance(event, BytesReceived)]
        assert chunks == [b"ab", b"x", b"c"]
        assert [channel.counters.chunks_in for channel in link.channels] == [3, 1]


@pytest.mark.parametrize("joined", [False, True])
async def test_a_full_queue_counts_each_datagram_that_it_drops(joined):
    async with open_link("udpin://127.0.0.1:0", receive_queue=1) as link:
        link.joins_datagrams = joined
        with socket.socket(type=socket.SOCK_DGRAM) as sender:
            sender.sendto(b"a", link.address)
            await wait_until(lambda: link.channels)
            for _ in range(5):
                sender.sendto(b"b", link.address)
            await wait_until(lambda: link.counters.dropped_in >= 5)
        assert link.counters.dropped_in + link.counters.chunks_in == 6


async def test_each_remote_address_is_a_channel():
    async with open_link("udpin://127.0.0.1:0", trust_senders=True) as link:
        peers = [UdpPeer(link.address) for _ in range(3)]
        for number, peer in enumerate(peers):
            await peer.send(bytes([number]))
        await wait_until(lambda: len(link.channels) == 3)
        assert [channel.peer for channel in link.channels] == [f"127.0.0.1:{p.port}" for p in peers]
        for channel in link.channels:
            channel.write(channel.peer.encode())
        for peer in peers:
            assert await peer.receive(1) == f"127.0.0.1:{peer.port}".encode()
            await peer.close()


async def test_a_full_link_closes_the_idlest_peer_for_a_new_one():
    async with open_link("udpin://127.0.0.1:0", max_peers=2) as link:
        peers = [UdpPeer(link.address) for _ in range(3)]
        for peer in peers:
            await peer.send(b"x")
        await wait_until(lambda: link.channels and link.channels[-1].peer.endswith(f":{peers[2].port}"))
        assert [channel.peer for channel in link.channels] == [f"127.0.0.1:{p.port}" for p in peers[1:]]
        for peer in peers:
            await peer.close()


async def test_a_new_peer_replaces_no_peer_with_valid_packets():
    async with open_link("udpin://127.0.0.1:0", max_peers=1) as link:
        peers = [UdpPeer(link.address) for _ in range(2)]
        await peers[0].send(b"x")
        await wait_until(lambda: link.channels)
        link.channels[0].last_valid = time()
        await peers[1].send(b"x")
        await wait_until(lambda: link.counters.dropped_in)
        assert [channel.peer for channel in link.channels] == [f"127.0.0.1:{peers[0].port}"]
        for peer in peers:
            await peer.close()


async def test_a_closed_peer_that_sends_again_is_a_new_channel():
    async with open_link("udpin://127.0.0.1:0") as link:
        peer = UdpPeer(link.address)
        await peer.send(b"1")
        first = (await anext(link)).channel
        await anext(link)
        first.close()
        await peer.send(b"2")
        assert await anext(link) == ChannelClosed(first, "closed by this side")
        second = (await anext(link)).channel
        assert second is not first
        assert await receive(link, 1) == b"2"
        await peer.close()


async def test_a_silent_peer_is_closed():
    async with open_link("udpin://127.0.0.1:0", idle="20ms") as link:
        peer = UdpPeer(link.address)
        await peer.send(b"x")
        channel = (await anext(link)).channel
        await anext(link)
        assert await anext(link) == ChannelClosed(channel, "silent for 0.02 s")
        await peer.close()


async def test_a_port_in_use_raises_and_leaks_nothing():
    async with open_link("udpin://127.0.0.1:0") as first:
        url = f"udpin://127.0.0.1:{first.address[1]}"
        with pytest.raises(LinkError, match=rf"cannot open {url}: port \d+ is in use by another program"):
            await open_link(url)


async def test_listening_on_a_foreign_address_raises():
    with pytest.raises(LinkError, match=r"192\.0\.2\.1 is not an address of this machine.*udpout"):
        await open_link("udpin://192.0.2.1:14550")


async def test_an_unknown_host_name_raises(monkeypatch):
    async def fail(*_, **__):
        raise socket.gaierror(socket.EAI_NONAME, "no such name")

    monkeypatch.setattr(asyncio.get_running_loop(), "getaddrinfo", fail)
    with pytest.raises(LinkError, match=r"'drone\.invalid' cannot be resolved"):
        await open_link("udpout://drone.invalid:14550")


async def test_an_unreachable_peer_does_not_close_a_udpout():
    closed_peer = UdpPeer()
    port = closed_peer.port
    await closed_peer.close()
    async with open_link(f"udpout://127.0.0.1:{port}") as link:
        channel = (await anext(link)).channel
        for _ in range(10):
            channel.write(b"unreachable")
            await asyncio.sleep(0)
        late = UdpPeer(("127.0.0.1", link.address[1]))
        await late.send(b"from another port of the peer")
        assert await receive(link, 29) == b"from another port of the peer"
        await late.close()


async def test_a_udpout_ignores_other_hosts():
    async with open_link("udpout://127.0.0.2:14550") as link:
        other_host = UdpPeer(("127.0.0.1", link.address[1]))
        await other_host.send(b"unexpected")
        await wait_until(lambda: link.counters.dropped_in)
        assert link.counters.bytes_in == 0
        await other_host.close()


async def test_a_datagram_too_large_is_dropped():
    async with open_link("udpout://127.0.0.1:9") as link:
        channel = (await anext(link)).channel
        assert not channel.write(bytes(70_000))
        assert channel.counters.dropped_out == 1


async def test_a_broadcast_address_may_be_sent_to():
    async with open_link("udpout://127.255.255.255:14550") as link:
        assert (await anext(link)).channel.write(b"x")


@pytest.mark.skipif(not socket.has_ipv6, reason="no IPv6")
async def test_ipv6():
    try:
        link = await open_link("udpin://[::1]:0")
    except LinkError:
        pytest.skip("no IPv6 here")
    async with link, open_link(f"udpout://[::1]:{link.address[1]}") as other:
        (await anext(other)).channel.write(b"six")
        opened = await anext(link)
        assert isinstance(opened, ChannelOpened)
        assert opened.channel.peer == f"[::1]:{other.address[1]}"
        assert isinstance(await anext(link), BytesReceived)


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux reports it")
async def test_kernel_drops_are_counted():
    async with open_link("udpin://127.0.0.1:0", socket_buffer=4096) as link:
        assert isinstance(link, UdpLink)
        assert link.kernel_drops == 0
        peer = UdpPeer(link.address)
        for _ in range(100):
            peer.socket.sendto(bytes(1000), link.address)
        assert link.kernel_drops
        await peer.close()


async def test_a_link_to_a_loopback_address_is_not_reachable_from_the_network():
    async with open_link("udpout://127.0.0.1:14550") as link:
        assert link.address[0] == "127.0.0.1"
    async with open_link("udpout://192.0.2.1:14550") as link:
        assert link.address[0] == "0.0.0.0"


async def test_many_waiting_datagrams_arrive_in_order():
    async with open_link("udpin://127.0.0.1:0") as link:
        peer = UdpPeer(link.address)
        for number in range(300):
            peer.socket.sendto(b"%d" % number, link.address)
        received = []
        while len(received) < 300:
            event = await anext(link)
            if isinstance(event, BytesReceived):
                received.append(int(event.data))
        assert received == list(range(300))
        await peer.close()
