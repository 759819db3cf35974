from __future__ import annotations

import asyncio
from contextlib import asynccontextmanager
from itertools import pairwise

import pytest

from mavstack.links import (
    BytesReceived,
    ChannelClosed,
    ChannelOpened,
    Impairment,
    LinkDown,
    impair,
    memory_pair,
    open_link,
)
from mavstack.sim.virtual import run_virtually

from .conformance import Conformance
from .peers import LinkPeer, UdpPeer


class TestImpaired(Conformance):
    """A link whose impairment has no effect conforms."""

    datagrams = True

    @asynccontextmanager
    async def pair(self, query=""):
        inner, other = memory_pair()
        link = impair(inner, Impairment())

        async def peer():
            return LinkPeer(await other.open())

        yield link, peer
        await other.close()

    async def test_unread_input_is_bounded(self):
        pytest.skip("bounded by the wrapped link")


class TestImpairedByUrl(Conformance):
    datagrams = True
    greeting = b"hello"
    detects_disconnect = False

    @asynccontextmanager
    async def pair(self, query=""):
        link = open_link(f"udpin://127.0.0.1:0?trust_senders=yes&latency=1ms&{query}")

        async def peer():
            return UdpPeer(link.address)

        yield link, peer


def exchange(impairment: Impairment, count: int = 200):
    """Send numbers through an impaired pair in virtual time; return the received ones with their times."""

    async def send_numbers():
        loop = asyncio.get_running_loop()
        inner, other = memory_pair(clock=loop.time)
        async with impair(inner, impairment, incoming=Impairment()) as sender, other:
            channel = (await anext(sender)).channel
            received = []

            async def receive_all():
                async for event in other:
                    if isinstance(event, BytesReceived):
                        received.append((round(event.time, 6), event.data))  # noqa: PERF401 - read while the loop runs

            receiver = asyncio.create_task(receive_all())
            for number in range(count):
                channel.write(bytes([number]) * 10)
                await asyncio.sleep(0.01)
            await asyncio.sleep(60)
            receiver.cancel()
            return received, channel.counters, channel.stats[0]

    return run_virtually(send_numbers())


def test_latency():
    received, _, _ = exchange(Impairment(latency=0.25))
    assert [at for at, _ in received] == pytest.approx([0.25 + n * 0.01 for n in range(200)])
    assert [data[0] for _, data in received] == list(range(200))


def test_loss_is_silent_and_reproducible():
    received, counters, stats = exchange(Impairment(loss=0.3, seed=9))
    assert 100 < len(received) < 180
    assert stats.lost == 200 - len(received)
    assert counters.dropped_out == 0
    assert exchange(Impairment(loss=0.3, seed=9))[0] == received
    assert exchange(Impairment(loss=0.3, seed=10))[0] != received


def test_chunks_beyond_the_queue_of_the_bandwidth_are_dropped():
    received, counters, _ = exchange(Impairment(bandwidth=100, queue=100))
    assert counters.dropped_out == 200 - len(received) > 0
    assert all(after[0] - before[0] >= 0.1 - 1e-6 for before, after in pairwise(received))


def test_the_delay_is_added_to_the_recorded_time(tmp_path):
    from .tlogs import tlog

    path = tmp_path / "flight.tlog"
    path.write_bytes(tlog([1e9, 1e9 + 1, 1e9 + 2]))

    async def follow():
        async with open_link(f"{path}?latency=500ms") as link:
            return [event.time async for event in link if isinstance(event, BytesReceived)]

    times = run_virtually(follow())
    assert times == pytest.approx(
        [1e9 + 0.5, 1e9 + 1.5], abs=1e-3
    )  # the last chunk is in transit when the file ends


async def test_a_lost_connection_of_the_inner_link_is_reported():
    server = await open_link("tcpin://127.0.0.1:0")
    url = f"tcpout://127.0.0.1:{server.address[1]}?loss=0&retry=1ms"
    async with open_link(url) as link:
        assert link.address is None
        opened = await anext(link)
        assert isinstance(opened, ChannelOpened)
        await server.close()
        assert await anext(link) == ChannelClosed(opened.channel, "closed by the peer")
        assert isinstance(await anext(link), LinkDown)
