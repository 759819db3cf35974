from __future__ import annotations

import asyncio
from contextlib import asynccontextmanager

import pytest

from mavstack import Node
from mavstack.dialects import common
from mavstack.errors import LinkError, LinkURLError
from mavstack.links import ChannelClosed, ChannelOpened, open_link
from tests.relay.harness import relay, url
from tests.waiting import wait_until

from .conformance import receive


async def opened(link):
    async with asyncio.timeout(10):
        while not isinstance(event := await anext(link), ChannelOpened):
            pass
    return event.channel


@asynccontextmanager
async def both_ends(query=""):
    async with (
        relay() as (server, port),
        open_link(url("relayin", port, query=query)) as host,
        open_link(url("relay", port, query=query)) as guest,
    ):
        yield server, port, host, guest


@pytest.mark.parametrize("query", ["", "&hybrid=yes&cipher=aes256"])
async def test_packets_go_both_ways(query):
    async with both_ends(query) as (_, _, host, guest):
        up, down = await opened(guest), await opened(host)
        assert up.write(b"from the ground")
        assert await receive(host, 15) == b"from the ground"
        assert down.write(b"from the boat")
        assert await receive(guest, 13) == b"from the boat"
        assert "***" in guest.url.redacted
        assert "room1" not in guest.url.redacted
        assert "5a5a" not in guest.url.redacted


async def test_each_guest_has_a_channel_which_ends_with_it():
    async with both_ends() as (_, port, host, guest):
        await opened(guest)
        first = await opened(host)
        async with open_link(url("relay", port)) as other:
            await opened(other)
            second = await opened(host)
            assert first.peer != second.peer
        async with asyncio.timeout(10):
            while not isinstance(event := await anext(host), ChannelClosed):
                pass
        assert event.channel is second
        assert not first.closed


async def test_the_host_may_come_later_and_come_back():
    async with relay() as (_, port), open_link(url("relay", port)) as guest:
        async with open_link(url("relayin", port)) as host:
            await opened(host)
            await opened(guest)
        async with open_link(url("relayin", port)) as host:
            channel = await opened(host)
            channel.write(b"back again")
            assert (await receive(guest, 10))[-10:] == b"back again"


async def test_a_guest_with_another_secret_opens_no_channel():
    async with (
        relay() as (_, port),
        open_link(url("relayin", port)) as host,
        open_link(url("relay", port, secret="11" * 32)) as stranger,
    ):
        await wait_until(lambda: host.refusals["forged or unknown key"])
        assert not host.channels
        assert not stranger.channels


async def test_the_relay_sees_no_content():
    seen = []
    async with both_ends() as (server, _, host, guest):
        receive_all = server.rooms.receive

        def tap(member, message, now):
            seen.append(message)
            return receive_all(member, message, now)

        server.rooms.receive = tap
        channel = await opened(guest)
        await opened(host)
        channel.write(b"secret" * 10)
        assert await receive(host, 60) == b"secret" * 10
    assert seen
    assert not any(b"secret" in message for message in seen)


async def test_nodes_meet_over_a_relay():
    async with (
        relay() as (_, port),
        Node(url("relayin", port), system=7, component=1) as vehicle,
        Node(url("relay", port), system=255) as ground,
    ):
        async with asyncio.timeout(10):
            component = await ground.wait_for_component(lambda info: info.address.system == 7)
        assert component.address.system == 7
        vehicle.send(common.Heartbeat())


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("relay://127.0.0.1?secret=" + "5a" * 32, "has no ticket"),
        ("relay://127.0.0.1?ticket=room1.boat", "needs a key"),
        ("relay://127.0.0.1?ticket=room1.boat&secret=5a", "64 hexadecimal digits"),
        ("relay://127.0.0.1?ticket=room1.boat&secret=zz&shared_key=fleet", "64 hexadecimal digits"),
    ],
)
def test_urls_that_cannot_work_are_refused(text, reason):
    with pytest.raises(LinkURLError, match=reason):
        open_link(text)


async def test_a_refused_ticket_is_reported():
    async with relay() as (_, port):
        link = open_link(f"relay://127.0.0.1:{port}?ticket=room1.none&secret={'5a' * 32}&tls=no")
        with pytest.raises(LinkError, match="401"):
            await link.open()
