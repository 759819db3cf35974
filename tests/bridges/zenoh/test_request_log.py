from __future__ import annotations

import asyncio

from mavstack.bridges.zenoh.request_log import RequestLog
from mavstack.sim.virtual import run_virtually


class Work:
    """Work that takes a second, and counts how often it was done."""

    def __init__(self) -> None:
        self.done = 0

    async def __call__(self) -> bytes:
        await asyncio.sleep(1)
        self.done += 1
        return str(self.done).encode()


def test_a_request_with_an_id_is_carried_out_once() -> None:
    async def scenario() -> None:
        log, work = RequestLog(), Work()
        first, second = await asyncio.gather(log.answer("a", work), log.answer("a", work))
        assert first == second == await log.answer("a", work) == b"1"
        assert await log.answer("b", work) == b"2"
        assert (log.repeated, work.done) == (2, 2)

    run_virtually(scenario())


def test_a_request_without_an_id_is_carried_out_each_time() -> None:
    async def scenario() -> None:
        log, work = RequestLog(), Work()
        assert [await log.answer("", work) for _ in range(2)] == [b"1", b"2"]

    run_virtually(scenario())


def test_a_client_that_leaves_cancels_nothing() -> None:
    async def scenario() -> None:
        log, work = RequestLog(), Work()
        task = asyncio.create_task(log.answer("a", work))
        await asyncio.sleep(0.5)
        task.cancel()
        assert await log.answer("a", work) == b"1"

    run_virtually(scenario())


def test_old_requests_are_forgotten_and_running_ones_are_not() -> None:
    async def scenario() -> None:
        log, work = RequestLog(limit=3), Work()
        running = [asyncio.create_task(log.answer(str(number), work)) for number in range(6)]
        await asyncio.sleep(0.5)
        assert len(log._known) == 6
        await asyncio.gather(*running)
        await log.answer("new", work)
        assert len(log._known) == 3
        assert "new" in log._known
        await log.close()

    run_virtually(scenario())
