"""Streams whose bytes bypass their reader."""

from __future__ import annotations

import asyncio
from functools import partial

from mavstack.links import BytesReceived, open_link

from .conformance import wait_until


async def test_direct_bytes_come_from_the_transport_in_order_and_wake_no_task():
    async with open_link("tcpin://127.0.0.1:0") as server:
        port = server.address[1]
        async with open_link(f"tcp://127.0.0.1:{port}") as client:
            peer = (await anext(server)).channel
            received, tasks = b"", []

            def take(events):
                nonlocal received
                tasks.append(asyncio.current_task())
                received += b"".join(event.data for event in events if isinstance(event, BytesReceived))

            def arrived(size):
                return len(received) >= size

            peer.write(b"before,")
            reading = asyncio.create_task(client.read(take, direct=True))
            expected = b"before,"
            for chunk in (b"first,", b"second,", bytes(200_000), b"third"):
                expected += chunk
                peer.write(chunk)
                await wait_until(partial(arrived, len(expected)))
            assert received == expected
            assert tasks[-1] is None  # by a callback of the event loop
            await client.close()
            await reading
