from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

from mavstack.server.client_queue import ClientQueue, stream_texts

if TYPE_CHECKING:
    from collections.abc import Sequence


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


async def test_each_item_gives_other_tasks_a_turn() -> None:
    """A client that left is noticed before the rest of its queue is sent."""
    queue: ClientQueue[str] = ClientQueue(100)
    for text in "abc":
        queue.put(text)
    sent: list[str] = []

    async def send() -> None:
        async for text in queue.stream():
            sent.append(text)  # noqa: PERF401 (it has no end)

    sender = asyncio.create_task(send())
    asyncio.get_running_loop().call_soon(sender.cancel)
    await asyncio.wait([sender])
    assert sent == ["a"]


async def test_the_number_of_drops_comes_before_the_next_text() -> None:
    queue: ClientQueue[str] = ClientQueue(4)
    texts = stream_texts(queue)
    for text in ("one", "two", "six"):
        queue.put(text)
    assert [await anext(texts), await anext(texts)] == ['{"dropped": 2}', "six"]
    queue.put("ten")
    assert await anext(texts) == "ten"


async def test_data_for_a_client_that_keeps_up_is_written_at_once_and_in_order() -> None:
    sent: list[str | bytes] = []
    ready = True

    def write_now(items: Sequence[str | bytes]) -> bool:
        if ready:
            sent.extend(items)
        return ready

    async def send() -> None:
        async for text in queue.stream():
            sent.append(text)  # noqa: PERF401 (it has no end)

    queue: ClientQueue[str] = ClientQueue(100, write_now)
    queue.put("1")  # there is no reader yet
    sender = asyncio.create_task(send())
    await asyncio.sleep(0)
    queue.put("2")  # the reader has not come back
    for _ in range(5):
        await asyncio.sleep(0)
    assert sent == ["1", "2"]
    queue.put("3")
    queue.put_all(["4", "5"])
    assert sent == ["1", "2", "3", "4", "5"]
    ready = False
    queue.put_all(["6", "7"])
    ready = True
    queue.put("8")
    assert sent[5:] == []
    for _ in range(9):
        await asyncio.sleep(0)
    assert sent[5:] == ["6", "7", "8"]
    queue.put_all([])
    assert len(sent) == 8
    sender.cancel()
