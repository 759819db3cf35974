"""The lane of observers: a pilot's task has its turn after few of their sends."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.server.observer_lane import WIDTH, ObserverLane


async def test_few_observers_send_in_a_turn_of_the_loop():
    """Before: all of them sent between two steps of a pilot's request."""
    lane, sent = ObserverLane(), 0

    async def observe() -> None:
        nonlocal sent
        for _ in range(10):
            await lane.turn()
            sent += 1

    observers = [asyncio.create_task(observe()) for _ in range(200)]
    largest = 0
    while not all(task.done() for task in observers):
        before = sent
        await asyncio.sleep(0)
        largest = max(largest, sent - before)
    assert 0 < largest <= WIDTH
    assert sent == 2000


async def test_a_client_that_leaves_gives_its_turn_back():
    lane = ObserverLane()
    waiting = [asyncio.create_task(lane.turn()) for _ in range(3 * WIDTH)]
    await asyncio.sleep(0)
    for task in waiting:
        task.cancel()
    await asyncio.gather(*waiting, return_exceptions=True)
    await asyncio.wait_for(lane.turn(), 5)


@pytest.mark.parametrize("blocked", [WIDTH, 10 * WIDTH])
async def test_a_blocked_send_keeps_no_other_from_its_turn(blocked):
    lane = ObserverLane()

    async def send() -> None:
        await lane.turn()
        await asyncio.Event().wait()

    tasks = [asyncio.create_task(send()) for _ in range(blocked)]
    await asyncio.wait_for(lane.turn(), 5)
    for task in tasks:
        task.cancel()
