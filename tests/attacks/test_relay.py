"""Attacks on a relay (strangers, forged tickets, floods, half-open connections), and by a hostile relay."""

from __future__ import annotations

import asyncio
from contextlib import AsyncExitStack
from secrets import token_bytes

import pytest
from websockets.asyncio.client import connect
from websockets.exceptions import InvalidStatus

from mavstack.handshakes import MAX_HANDSHAKES
from mavstack.links import BytesReceived, ChannelOpened, open_link
from mavstack.links.relay import MAX_GUESTS
from mavstack.links.relay_frames import RELAY_PROTOCOL, encode_datagram
from mavstack.relay.rooms import Limits
from mavstack.security.room_tickets import Seat
from tests.relay.harness import relay, ticket, url
from tests.waiting import wait_until


async def opened(link):
    async with asyncio.timeout(10):
        while not isinstance(event := await anext(link), ChannelOpened):
            pass
    return event.channel


async def delivers(sender, receiver) -> bool:
    """Return whether a datagram arrives within five seconds; the relay may drop some under a flood."""
    async with asyncio.timeout(5):
        while True:
            sender.write(b"alive")
            event = await anext(receiver)
            if isinstance(event, BytesReceived) and b"alive" in event.data:
                return True


def dial(port, *words):
    return connect(f"ws://127.0.0.1:{port}", subprotocols=list(words), proxy=None, close_timeout=0.1)


async def test_forged_tickets_neither_enter_nor_delay_members():
    async with (
        relay() as (server, port),
        open_link(url("relayin", port)) as host,
        open_link(url("relay", port)) as guest,
    ):
        channel = await opened(guest)
        await opened(host)

        async def attempt(number: int) -> None:
            words = [RELAY_PROTOCOL, f"room1.boat.host.1900000000.{number:064x}"]
            with pytest.raises(InvalidStatus, match="401"):
                await dial(port, *words)

        await asyncio.gather(*map(attempt, range(50)))
        assert server.rooms.counts["refused: the signature of the ticket is wrong"] == 50
        assert server.rooms.members == 2
        assert await delivers(channel, host)


async def test_half_open_connections_are_bounded_and_lock_out_no_member():
    async with AsyncExitStack() as stack, relay() as (_, port):
        readers = []
        for _ in range(MAX_HANDSHAKES + 16):
            reader, writer = await asyncio.open_connection("127.0.0.1", port)
            stack.callback(writer.close)
            writer.write(b"GET / HTTP/1.1\r\nHost: relay\r\n")
            readers.append(reader)
        await wait_until(lambda: sum(not reader.at_eof() for reader in readers) <= MAX_HANDSHAKES)
        async with dial(port, RELAY_PROTOCOL, ticket(Seat.HOST)):
            pass


async def test_a_guest_that_floods_is_slowed_down_and_silences_no_other():
    async with (
        relay(Limits(pace=20_000)) as (server, port),
        open_link(url("relayin", port)) as host,
        open_link(url("relay", port)) as guest,
        dial(port, RELAY_PROTOCOL, ticket(Seat.GUEST)) as loud,
    ):
        channel = await opened(guest)
        await opened(host)

        async def flood() -> None:
            while True:
                await loud.send(token_bytes(1000))

        task = asyncio.create_task(flood())
        try:
            await wait_until(lambda: server.rooms.counts["forwarded"] > 20)
            assert await delivers(channel, host)
            assert server.rooms.counts["forwarded"] < 400  # as many as were sent, without the pace
        finally:
            task.cancel()
            await asyncio.gather(task, return_exceptions=True)


async def test_a_ticket_without_the_secret_opens_no_channel_of_the_vehicle():
    async with (
        relay() as (_, port),
        open_link(url("relayin", port)) as host,
        dial(port, RELAY_PROTOCOL, ticket(Seat.GUEST)) as thief,
    ):
        for size in (0, 1, 25, 76, 300):
            await thief.send(b"\x01" + token_bytes(size))
            await thief.send(b"\x80" + token_bytes(size))
        await wait_until(lambda: host.refusals["malformed"])
        assert not host.channels


async def test_a_hostile_relay_fills_no_memory_of_the_vehicle_and_opens_nothing():
    async def serve_junk(socket) -> None:
        for guest in range(1, 4 * MAX_GUESTS):
            await socket.send(encode_datagram(guest, b"\x80" + token_bytes(60)))
            await socket.send(token_bytes(3))
        await socket.send(b"done")
        await socket.wait_closed()

    from websockets.asyncio.server import serve

    async with serve(serve_junk, "127.0.0.1", 0, subprotocols=[RELAY_PROTOCOL]) as server:
        port = server.sockets[0].getsockname()[1]
        async with open_link(url("relayin", port)) as host:
            await wait_until(lambda: host.refusals["no session"] >= 4 * MAX_GUESTS - 1)
            assert len(host._sealed) <= MAX_GUESTS
            assert not host.channels
