from __future__ import annotations

import asyncio
import errno
from contextlib import asynccontextmanager
from itertools import pairwise

import pytest

from mavstack.errors import LinkError
from mavstack.links import ChannelClosed, ChannelOpened, LinkDown, open_link
from mavstack.links.connection import Backoff
from mavstack.links.tcp import TcpClient
from mavstack.sim.virtual import run_virtually
from tests.waiting import wait_until

from .conformance import Conformance, receive
from .peers import Acceptor, StreamPeer, UdpPeer


class TestTcpin(Conformance):
    @asynccontextmanager
    async def pair(self, query=""):
        link = open_link(f"tcpin://127.0.0.1:0?{query}")

        async def peer():
            return StreamPeer(*await asyncio.open_connection(*link.address))

        yield link, peer


class TestTcpout(Conformance):
    @asynccontextmanager
    async def pair(self, query=""):
        acceptor = Acceptor()
        port = await acceptor.listen_tcp()
        yield open_link(f"tcpout://127.0.0.1:{port}?{query}"), acceptor.accepted.get
        await acceptor.close()


def free_port() -> int:
    """Return a port on which no program listens."""
    peer = UdpPeer()
    port = peer.port
    peer.socket.close()
    return port


async def test_a_refused_connection_raises_immediately():
    url = f"tcpout://127.0.0.1:{free_port()}"
    with pytest.raises(LinkError, match=rf"cannot open {url}: connection refused.*\?wait=yes"):
        await open_link(url)


async def test_waiting_for_a_server_that_starts_later():
    acceptor, port = Acceptor(), free_port()
    async with open_link(f"tcpout://127.0.0.1:{port}?wait=yes&retry=1ms") as link:
        down = await anext(link)
        assert isinstance(down, LinkDown)
        assert "connection refused" in down.reason
        assert down.retry_in == 0.001
        await acceptor.listen_tcp(port)
        while isinstance(event := await anext(link), LinkDown):
            pass
        assert isinstance(event, ChannelOpened)
        await acceptor.close()


async def test_the_client_reconnects_to_a_restarted_server():
    acceptor = Acceptor()
    port = await acceptor.listen_tcp()
    async with open_link(f"tcpout://127.0.0.1:{port}?retry=1ms&retry_limit=2ms") as link:
        first = (await anext(link)).channel
        await acceptor.close()
        assert await anext(link) == ChannelClosed(first, "closed by the peer")
        assert await anext(link) == LinkDown("closed by the peer", 0.001)
        acceptor = Acceptor()
        await acceptor.listen_tcp(port)
        while isinstance(event := await anext(link), LinkDown):
            pass
        assert event.channel is not first
        event.channel.write(b"back")
        assert await (await acceptor.accepted.get()).receive(4) == b"back"
        await acceptor.close()


async def test_without_reconnect_the_iteration_ends():
    acceptor = Acceptor()
    port = await acceptor.listen_tcp()
    async with open_link(f"tcpout://127.0.0.1:{port}", reconnect=False) as link:
        await acceptor.accepted.get()
        await acceptor.close()
        kinds = [type(event) async for event in link]
        assert kinds == [ChannelOpened, ChannelClosed]


def test_the_delays_double_up_to_the_limit():
    delays = Backoff(0.25, 3.0).delays()
    assert [next(delays) for _ in range(7)] == [0.25, 0.5, 1.0, 2.0, 3.0, 3.0, 3.0]


def test_attempts_follow_the_reported_delays(monkeypatch):
    async def refuse(self):
        raise ConnectionRefusedError(errno.ECONNREFUSED, "refused")

    async def attempts():
        loop = asyncio.get_running_loop()
        async with open_link("tcpout://127.0.0.1:5760?wait=yes") as link:
            moments = []
            while len(moments) < 8:
                event = await anext(link)
                moments.append((round(loop.time(), 6), event.retry_in))
        return moments

    monkeypatch.setattr(TcpClient, "_connect", refuse)
    moments = run_virtually(attempts())
    assert [delay for _, delay in moments] == [0.25, 0.5, 1, 2, 4, 8, 10, 10]
    for (before, delay), (after, _) in pairwise(moments):
        assert after == pytest.approx(before + delay, abs=1e-3)


async def test_the_number_of_peers_is_limited():
    async with open_link("tcpin://127.0.0.1:0", max_peers=2) as link:
        peers = [StreamPeer(*await asyncio.open_connection(*link.address)) for _ in range(3)]
        await wait_until(lambda: len(link.channels) == 2)
        outcomes = [await peer.reader.read(1) for peer in peers if peer.reader.at_eof()] or [b""]
        assert outcomes == [b""]
        for channel in link.channels:
            channel.write(b"!")
        for peer in peers:
            await peer.close()


async def test_a_port_in_use_raises():
    async with open_link("tcpin://127.0.0.1:0") as first:
        port = first.address[1]
        with pytest.raises(LinkError, match=f"port {port} is in use"):
            await open_link(f"tcpin://127.0.0.1:{port}")


async def test_bytes_written_before_closing_are_sent():
    acceptor = Acceptor()
    port = await acceptor.listen_tcp()
    async with open_link(f"tcpout://127.0.0.1:{port}", send_queue="16M") as link:
        (await anext(link)).channel.write(bytes(8 << 20))
        peer = await acceptor.accepted.get()
        _, data = await asyncio.gather(link.close(), peer.receive(8 << 20))
        assert len(data) == 8 << 20
    await acceptor.close()


async def test_drain_prevents_drops():
    acceptor = Acceptor()
    port = await acceptor.listen_tcp()
    async with open_link(f"tcpout://127.0.0.1:{port}", send_queue="8k") as link:
        channel = (await anext(link)).channel
        peer = await acceptor.accepted.get()
        receiving = asyncio.create_task(peer.receive(4_000_000))
        for _ in range(4000):
            assert channel.write(bytes(1000))
            await channel.drain()
        assert len(await receiving) == 4_000_000
        assert channel.counters.dropped_out == 0
    await acceptor.close()


async def test_closing_with_a_full_receive_queue_does_not_hang():
    async with open_link("tcpin://127.0.0.1:0", receive_queue=1024) as link:
        peer = StreamPeer(*await asyncio.open_connection(*link.address))
        for _ in range(10):
            await peer.send(bytes(1000))
        await wait_until(lambda: link.counters.bytes_in)
        await link.close()
        assert await peer.reader.read() == b""
        await peer.close()


async def test_the_iteration_raises_the_error_of_a_task(monkeypatch):
    from mavstack.links.stream import StreamChannel

    async def broken(self, inbox):
        raise ZeroDivisionError

    monkeypatch.setattr(StreamChannel, "receive_all", broken)
    acceptor = Acceptor()
    port = await acceptor.listen_tcp()
    async with open_link(f"tcpout://127.0.0.1:{port}") as link:
        assert isinstance(await anext(link), ChannelOpened)
        assert isinstance(await anext(link), ChannelClosed)
        with pytest.raises(ZeroDivisionError):
            await receive(link, 1)
    await acceptor.close()


async def test_a_channel_closed_before_the_link_still_sends():
    acceptor = Acceptor()
    port = await acceptor.listen_tcp()
    async with open_link(f"tcpout://127.0.0.1:{port}?send_queue=16M") as link:
        channel = (await anext(link)).channel
        peer = await acceptor.accepted.get()
        channel.write(bytes(8 << 20))
        channel.close()
        _, data = await asyncio.gather(link.close(), peer.receive(8 << 20))
        assert len(data) == 8 << 20
    await acceptor.close()
