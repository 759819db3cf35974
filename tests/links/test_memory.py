from __future__ import annotations

import asyncio
from contextlib import asynccontextmanager

import pytest

from mavstack.errors import LinkURLError
from mavstack.links import BytesReceived, ChannelClosed, ChannelOpened, MemoryNetwork, memory_pair

from .conformance import Conformance, receive
from .peers import LinkPeer


class TestMemory(Conformance):
    datagrams = True

    @asynccontextmanager
    async def pair(self, query=""):
        network = MemoryNetwork()
        link, other = network.link(f"memory://pair?{query}"), network.link(f"memory://pair?{query}")

        async def peer():
            return LinkPeer(await other.open())

        yield link, peer
        await other.close()

    async def test_unread_input_is_bounded(self):
        async with self.connected(self.small_queues) as (_, channel, peer):
            accepted = [peer.link.channels[0].write(bytes(1000)) for _ in range(100)]
            assert sum(accepted) == channel.counters.chunks_in < 10
            assert peer.link.counters.dropped_out == 100 - sum(accepted)


async def test_links_connect_to_links_of_the_same_name_only():
    network = MemoryNetwork(clock=lambda: 12.5)
    async with (
        network.link("memory://fleet") as one,
        network.link("memory://fleet") as two,
        network.link("memory://fleet") as three,
        network.link("memory://elsewhere") as other,
        MemoryNetwork().link("memory://fleet") as isolated,
    ):
        assert [len(link.channels) for link in (one, two, three, other, isolated)] == [2, 2, 2, 0, 0]
        for channel in one.channels:
            channel.write(b"hello")
        for link in (two, three):
            events = [await anext(link) for _ in range(3)]
            opened, opened_too, received = events
            assert isinstance(opened, ChannelOpened)
            assert isinstance(opened_too, ChannelOpened)
            assert isinstance(received, BytesReceived)
            assert (received.data, received.time) == (b"hello", 12.5)
            assert received.channel.peer == "fleet#1"


async def test_a_closed_link_closes_the_channels_to_it():
    one, two = memory_pair()
    async with one:
        async with two:
            pass
        assert isinstance(await anext(one), ChannelOpened)
        assert isinstance(await anext(one), ChannelClosed)
        async with one._network.link() as three:
            (await anext(three)).channel.write(b"new")
            await anext(one)
            assert await receive(one, 3) == b"new"


def test_other_urls_and_options_are_refused():
    with pytest.raises(LinkURLError, match="is not a memory URL"):
        MemoryNetwork().link("udpin://0.0.0.0:14550")
    with pytest.raises(LinkURLError, match="has no option 'loss'"):
        MemoryNetwork().link("memory://fleet?loss=0.1")


async def test_a_write_never_calls_the_reader_of_the_other_end():
    one, other = memory_pair()
    async with one, other:
        events = []
        reading = asyncio.create_task(other.read(events.extend))
        await asyncio.sleep(0)
        events.clear()
        one.channels[0].write(b"hello")
        assert events == []
        await asyncio.sleep(0)
        await asyncio.sleep(0)
        assert [event.data for event in events] == [b"hello"]
        reading.cancel()
