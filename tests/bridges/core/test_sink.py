"""The queues between threads and the event loop."""

from __future__ import annotations

import asyncio
import threading

from mavstack.bridges.core.sink import Handoff, Outbox


async def test_items_of_a_thread_arrive_in_order() -> None:
    got: list[int] = []
    done = asyncio.Event()

    def take(item: int) -> None:
        got.append(item)
        if item == 99:
            done.set()

    handoff = Handoff(asyncio.get_running_loop(), take)
    thread = threading.Thread(target=lambda: [handoff.put(number) for number in range(100)])
    thread.start()
    await asyncio.wait_for(done.wait(), 5)
    thread.join()
    assert got == list(range(100))


async def test_a_full_handoff_drops_the_oldest() -> None:
    got: list[int] = []
    handoff = Handoff(asyncio.get_running_loop(), got.append, 3)
    for number in range(5):
        handoff.put(number)
    await asyncio.sleep(0)
    await asyncio.sleep(0)
    assert got == [2, 3, 4]
    assert handoff.dropped == 2


def test_work_that_blocks_does_not_delay_put() -> None:
    gate, begun, done = threading.Event(), threading.Event(), []

    def work(item: int) -> None:
        begun.set()
        gate.wait(5)
        if item == 4:
            raise OSError("no")
        done.append(item)

    outbox = Outbox(work, 2)
    outbox.put(0)
    assert begun.wait(5)
    for number in range(1, 6):
        outbox.put(number)
    gate.set()
    outbox.close(5)
    assert done == [0, 5]
    assert (outbox.dropped, outbox.failed) == (3, 1)
