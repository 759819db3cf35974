"""A thread reads the bytes of a link for programs that parse them themselves."""

from __future__ import annotations

import asyncio
import os
import socket

import pytest

from mavstack.dialects import common
from mavstack.links import BytesReceived, ChannelOpened, open_link
from mavstack.node.native_bytes import read_natively
from mavstack.wire import Encoder, Parser

pytestmark = pytest.mark.skipif(os.name != "posix", reason="the event loop waits for no descriptor")


async def received(senders: int, count: int, url: str = "udpin://127.0.0.1:0") -> dict[str, list[int]]:
    """Return the numbers in the packets of some senders, by channel."""
    numbers: dict[str, list[int]] = {}
    async with asyncio.timeout(30), open_link(url) as link:
        link.joins_datagrams = True
        async with read_natively(link, common.dialect):
            sockets = [socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(senders)]
            for number in range(count):
                for each in sockets:
                    data = Encoder(1, 1).encode(common.Attitude(time_boot_ms=number))
                    each.sendto(data, link.address)
            total = 0
            async for events in link.batches():
                for event in events:
                    if isinstance(event, ChannelOpened):
                        numbers[event.channel.name] = []
                    elif isinstance(event, BytesReceived):
                        packets = Parser(common).feed(event.data)
                        numbers[event.channel.name] += [each.message.time_boot_ms for each in packets]
                        total += len(packets)
                if total == senders * count:
                    break
            for each in sockets:
                each.close()
    return numbers


@pytest.mark.parametrize("way", ["native", "asyncio"])
@pytest.mark.parametrize("senders", [1, 5])
async def test_all_datagrams_arrive_in_order(monkeypatch, way, senders) -> None:
    monkeypatch.setenv("MAVSTACK_INPUT", way)
    numbers = await received(senders, 200)
    assert list(numbers.values()) == [list(range(200))] * senders


async def test_more_datagrams_than_the_queue_holds_arrive() -> None:
    numbers = await received(1, 6000)
    assert list(numbers.values()) == [list(range(6000))]


async def test_links_that_the_thread_cannot_read_are_read_as_ever() -> None:
    async with (
        asyncio.timeout(20),
        open_link("tcpin://127.0.0.1:0") as link,
        read_natively(link, common.dialect),
    ):
        _, writer = await asyncio.open_connection(*link.address)
        writer.write(Encoder(1, 1).encode(common.Attitude()))
        async for events in link.batches():
            if any(isinstance(event, BytesReceived) for event in events):
                break
        writer.close()
