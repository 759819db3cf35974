from __future__ import annotations

import asyncio

from mavstack.server.client_queue import ClientQueue


async def test_the_oldest_data_is_dropped_and_counted() -> None:
    queue: ClientQueue[bytes] = ClientQueue(10)
    for packets, data in enumerate((b"aaaa", b"bbbb", b"cccc"), 1):
        queue.put(data, packets)
    assert queue.dropped == 1
    assert [await queue.get(), await queue.get()] == [b"bbbb", b"cccc"]
    queue.put(b"d" * 50)
    assert (await queue.get(), queue.dropped) == (b"d" * 50, 1)


async def test_getting_waits_for_data() -> None:
    queue: ClientQueue[str] = ClientQueue(10)
    waiting = asyncio.create_task(queue.get())
    await asyncio.sleep(0)
    queue.put("x")
    assert await waiting == "x"
