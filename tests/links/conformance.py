"""The conformance tests of links: the test class of a backend inherits them and creates the pair of ends."""

from __future__ import annotations

import asyncio
import gc
import random
from contextlib import asynccontextmanager

import pytest

from mavstack.errors import InvalidStateError, LinkClosedError
from mavstack.links import BytesReceived, ChannelClosed, ChannelOpened
from tests.waiting import wait_until

TEST_TIMEOUT = 20  # seconds after which a test that hangs fails


class Conformance:
    """`pair` yields an unopened link, and a coroutine function that returns the peer of the open link."""

    datagrams = False  # True if chunks keep their boundaries and may be lost
    greeting = b""  # bytes that the peer must send first to become a channel
    detects_disconnect = True  # True if the link detects that its peer disconnected
    small_queues = "receive_queue=4096&send_queue=4096"

    def pair(self, query: str = ""):
        raise NotImplementedError

    @asynccontextmanager
    async def connected(self, query: str = ""):
        async with asyncio.timeout(TEST_TIMEOUT), self.pair(query) as (link, open_peer), link:
            peer = await open_peer()
            if self.greeting:
                await peer.send(self.greeting)
            event = await anext(link)
            assert isinstance(event, ChannelOpened)
            if self.greeting:
                assert (await anext(link)).data == self.greeting
            try:
                yield link, event.channel, peer
            finally:
                await peer.close()

    @pytest.fixture(autouse=True)
    async def _no_leaks(self):
        yield
        remaining = asyncio.all_tasks() - {asyncio.current_task()}
        if remaining:  # the tasks of a peer may need one more loop iteration to end
            await asyncio.wait(remaining, timeout=1)
        assert not asyncio.all_tasks() - {asyncio.current_task()}
        gc.collect()  # an unclosed socket or transport warns now, and warnings are errors

    async def test_opening_yields_one_channel(self):
        async with self.connected() as (link, channel, _):
            assert list(link.channels) == [channel]
            assert channel.name
            assert channel.peer
            assert not channel.closed
            assert await link.open() is link

    async def test_bytes_go_both_ways_unchanged(self):
        rng = random.Random(1)
        async with self.connected() as (link, channel, peer):
            for size in [1, 2, 255, *(rng.randrange(1, 1400) for _ in range(40))]:
                data = rng.randbytes(size)
                assert channel.write(data)
                assert await peer.receive(size) == data
                await peer.send(data)
                assert await receive(link, size) == data

    async def test_counters_count_bytes_and_chunks(self):
        async with self.connected() as (link, channel, peer):
            channel.write(b"12345")
            channel.write(memoryview(b"67"))
            await peer.receive(7)
            await peer.send(b"abc")
            await receive(link, 3)
            counters = channel.counters
            assert (counters.bytes_out, counters.chunks_out, counters.dropped_out) == (7, 2, 0)
            assert (counters.bytes_in, counters.dropped_in) == (3 + len(self.greeting), 0)
            assert link.counters == counters
            channel.close()
            assert link.counters == counters

    async def test_closing_the_link_closes_the_channel_and_ends_the_iteration(self):
        async with self.connected() as (link, channel, _):
            await link.close()
            await link.close()
            assert link.closed
            assert [event async for event in link] == [ChannelClosed(channel, "link closed")]
            assert not link.channels

    async def test_a_closed_channel_refuses_bytes(self):
        async with self.connected() as (link, channel, _):
            channel.close()
            channel.close()
            with pytest.raises(LinkClosedError, match="is closed"):
                channel.write(b"x")
            assert isinstance(await anext(link), ChannelClosed)

    async def test_a_closed_link_cannot_be_opened_again(self):
        async with self.connected() as (link, *_):
            await link.close()
            with pytest.raises(LinkClosedError, match="open a new link"):
                await link.open()

    async def test_iterating_before_opening_raises(self):
        async with self.pair() as (link, _):
            with pytest.raises(InvalidStateError, match="is not open"):
                aiter(link)
            await link.close()

    async def test_a_cancelled_reader_loses_no_event(self):
        async with self.connected() as (link, _, peer):
            reader = asyncio.create_task(anext(link))
            await asyncio.sleep(0)
            reader.cancel()
            await asyncio.gather(reader, return_exceptions=True)
            await peer.send(b"still there")
            assert await receive(link, 11) == b"still there"

    async def test_only_one_task_may_iterate(self):
        async with self.connected() as (link, *_):
            reader = asyncio.create_task(anext(link))
            await asyncio.sleep(0)
            with pytest.raises(InvalidStateError, match="two tasks"):
                await anext(link)
            reader.cancel()
            await asyncio.gather(reader, return_exceptions=True)

    async def test_batches_contain_all_bytes(self):
        async with self.connected() as (link, channel, peer):
            await peer.send(b"a" * 100)
            await peer.send(b"b" * 100)
            data = b""
            async for batch in link.batches():
                data += b"".join(event.data for event in batch if isinstance(event, BytesReceived))
                assert all(event.channel is channel for event in batch)
                if len(data) == 200:
                    break
            assert data == b"a" * 100 + b"b" * 100

    @pytest.mark.parametrize("direct", [False, True])
    async def test_read_passes_all_bytes_to_the_callback_until_the_link_ends(self, direct):
        async with self.connected() as (link, channel, peer):
            events = []
            reading = asyncio.create_task(link.read(events.extend, direct=direct))
            for letter in (b"a", b"b"):
                await peer.send(letter * 100)
            await wait_until(lambda: sum(len(each.data) for each in events) == 200)
            assert b"".join(event.data for event in events) == b"a" * 100 + b"b" * 100
            assert all(event.channel is channel for event in events)
            assert channel.counters.bytes_in >= 200
            await link.close()
            await reading
            assert isinstance(events[-1], ChannelClosed)

    async def test_a_cancelled_read_can_be_continued_by_another_task(self):
        async with self.connected() as (link, _, peer):
            events = []
            reading = asyncio.create_task(link.read(events.extend))
            await asyncio.sleep(0)
            with pytest.raises(InvalidStateError, match="two tasks"):
                await anext(link)
            reading.cancel()
            await asyncio.gather(reading, return_exceptions=True)
            await peer.send(b"later")
            assert await receive(link, 5) == b"later"
            assert not events

    async def test_chunks_beyond_the_send_queue_are_dropped_and_counted(self):
        async with self.connected(self.small_queues) as (_, channel, _):
            accepted = [channel.write(bytes(1000)) for _ in range(2000)]
            counters = channel.counters
            assert counters.chunks_out == sum(accepted)
            assert counters.dropped_out == len(accepted) - sum(accepted)

    async def test_unread_input_is_bounded(self):
        total, in_transit = 200, 10  # between wrapped links a few chunks are in transit
        async with self.connected(self.small_queues) as (link, channel, peer):
            sending = asyncio.create_task(send_many(peer, total))
            if self.datagrams:
                await sending
                await wait_until(
                    lambda: link.counters.chunks_in + link.counters.dropped_in >= total - in_transit
                )
                assert link.counters.dropped_in > 0
                assert channel.counters.bytes_in < 8192
            else:
                await asyncio.sleep(0.01)
                assert channel.counters.bytes_in < (1 << 18)
                assert len(await receive(link, total * 1000)) == total * 1000
                await sending
                assert channel.counters.dropped_in == 0

    async def test_a_disconnected_peer_closes_the_channel(self):
        if not self.detects_disconnect:
            pytest.skip("no connection")
        async with self.connected() as (link, channel, peer):
            await peer.close()
            event = await anext(link)
            assert isinstance(event, ChannelClosed)
            assert event.channel is channel
            assert event.reason
            assert channel.closed


async def receive(link, count: int) -> bytes:
    """Receive `count` bytes from the only channel of a link."""
    data = b""
    while len(data) < count:
        event = await anext(link)
        assert isinstance(event, BytesReceived), event
        data += event.data
    return data


async def send_many(peer, count: int) -> None:
    for _ in range(count):
        await peer.send(bytes(1000))
