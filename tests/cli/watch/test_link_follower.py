"""The follower of a link: chunks that were received together, and peers that are valid."""

from __future__ import annotations

import asyncio

from mavstack.cli.watch.link_follower import Follower, join_chunks
from mavstack.cli.watch.observer import Observer
from mavstack.dialects import common
from mavstack.links import BytesReceived, ChannelClosed, LinkDown, MemoryNetwork
from tests.cli.conftest import flight


class FakeChannel:
    """A channel in events."""


def test_bytes_that_a_channel_received_together_are_joined():
    one, two = FakeChannel(), FakeChannel()
    down = LinkDown("lost", 1.0)
    events = [
        BytesReceived(one, b"a", 5.0),
        BytesReceived(one, b"b", 5.0004),
        BytesReceived(two, b"c", 5.0005),
        BytesReceived(one, b"d", 5.0006),
        BytesReceived(one, b"e", 5.0017),
        down,
        BytesReceived(one, b"f", 5.0018),
        ChannelClosed(one, "end"),
        BytesReceived(two, b"g", 5.0019),
    ]
    joined = list(join_chunks(events))
    assert joined == [BytesReceived(one, b"ab", 5.0), *events[2:]]


def test_a_peer_is_valid_as_soon_as_it_sends_packets():
    async def run():
        network = MemoryNetwork()
        async with network.link() as link, network.link() as peer:
            follower = Follower(Observer(common.dialect))
            following = asyncio.create_task(follower.follow(link, 0.2))
            await asyncio.sleep(0)
            for channel in peer.channels:
                channel.write(b"noise")
            await asyncio.sleep(0.05)
            assert [channel.last_valid for channel in link.channels] == [0]
            for channel in peer.channels:
                channel.write(flight(0)[0])
            await asyncio.sleep(0.05)
            assert all(channel.last_valid > 0 for channel in link.channels)
            await following

    asyncio.run(run())
