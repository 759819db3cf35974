"""Subscriptions: bounded queues, their end, and waiting readers."""

from __future__ import annotations

import asyncio

from mavstack.node.subscription import Subscription


async def test_the_iteration_ends_after_the_queued_items() -> None:
    closed = []
    subscription: Subscription[int] = Subscription(closed.append)
    for number in range(3):
        subscription.put(number)
    subscription.close()
    subscription.close()
    assert [item async for item in subscription] == [0, 1, 2]
    assert closed == [subscription]


async def test_a_new_item_wakes_a_waiting_reader() -> None:
    subscription: Subscription[int] = Subscription(lambda _: None)
    reader = asyncio.ensure_future(anext(subscription))
    await asyncio.sleep(0)
    subscription.put(7)
    assert await reader == 7


async def test_a_cancelled_reader_loses_no_item() -> None:
    subscription: Subscription[int] = Subscription(lambda _: None)
    reader = asyncio.ensure_future(anext(subscription))
    await asyncio.sleep(0)
    reader.cancel()
    subscription.put(7)
    assert await anext(subscription) == 7


async def test_keep_all_drops_nothing() -> None:
    subscription: Subscription[int] = Subscription(lambda _: None, queue=2, keep_all=True)
    for number in range(10):
        subscription.put(number)
    assert subscription.drain() == list(range(10))
    assert subscription.dropped == 0


async def test_a_full_queue_drops_its_oldest_items_and_counts_them() -> None:
    subscription: Subscription[int] = Subscription(lambda _: None, queue=3)
    for number in range(10):
        subscription.put(number)
    assert subscription.drain() == [7, 8, 9]
    assert subscription.dropped == 7


async def test_several_readers_share_the_items() -> None:
    subscription: Subscription[int] = Subscription(lambda _: None)
    readers = [asyncio.ensure_future(anext(subscription)) for _ in range(3)]
    await asyncio.sleep(0)
    subscription.put(1)
    await asyncio.sleep(0)
    subscription.put(2)
    subscription.put(3)
    assert sorted(await asyncio.gather(*readers)) == [1, 2, 3]
