"""Packets that come fast are taken together; those that come seldom, or as answers, at once."""

from __future__ import annotations

import asyncio
import os

import pytest

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.node import Node
from mavstack.node.input_interval import InputInterval
from mavstack.sim.virtual import run_virtually
from tests.node.test_native_input import granted, native, vehicle_on
from tests.waiting import wait_until

INTERVAL = 0.002


class Sockets:
    """Sockets of a program: the times when packets came, and when they were handled."""

    def __init__(self, seconds: float = INTERVAL) -> None:
        self.loop = asyncio.get_running_loop()
        self.interval = InputInterval(seconds, self.look, self.watch)
        self.is_watched = True
        self.waiting: list[float] = []
        self.delays: list[float] = []
        self.looks = 0

    def look(self) -> bool:
        found, self.waiting = self.waiting, []
        self.delays += [self.loop.time() - came for came in found]
        self.looks += 1
        return bool(found)

    def watch(self, is_watched: bool) -> None:
        self.is_watched = is_watched
        if is_watched and self.waiting:
            self.wake()

    def wake(self) -> None:
        self.look()
        self.interval.begin()

    def receive(self) -> None:
        self.waiting.append(self.loop.time())
        if self.is_watched:
            self.wake()

    async def receive_many(self, count: int, gap: float) -> None:
        for _ in range(count):
            await asyncio.sleep(gap)
            self.receive()


def test_packets_that_come_fast_cost_few_looks_and_none_waits_longer_than_an_interval():
    async def scenario() -> None:
        sockets = Sockets()
        await sockets.receive_many(1000, 0.0002)
        await asyncio.sleep(0.01)
        assert len(sockets.delays) == 1000
        assert sockets.looks < 130
        assert max(sockets.delays) <= INTERVAL + 1e-6
        assert sockets.is_watched

    run_virtually(scenario())


def test_packets_that_come_seldom_are_handled_at_once():
    async def scenario() -> None:
        sockets = Sockets()
        await sockets.receive_many(100, 0.005)
        assert sockets.delays == [0.0] * 100

    run_virtually(scenario())


def test_without_an_interval_each_packet_is_handled_at_once():
    async def scenario() -> None:
        sockets = Sockets(0.0)
        sockets.interval.hurry(1.0)
        await sockets.receive_many(100, 0.0001)
        assert sockets.delays == [0.0] * 100

    run_virtually(scenario())


def test_an_answer_that_is_awaited_ends_the_wait_for_others():
    async def scenario() -> None:
        sockets = Sockets()
        await sockets.receive_many(3, 0.0001)
        assert len(sockets.delays) == 2
        sockets.interval.hurry(0.1)
        assert len(sockets.delays) == 3
        await sockets.receive_many(500, 0.0001)
        assert sockets.delays[3:] == [0.0] * 500
        await sockets.receive_many(1000, 0.0001)
        assert sockets.delays[-1] > 0.0

    run_virtually(scenario())


def test_an_end_leaves_the_sockets_to_the_caller():
    async def scenario() -> None:
        sockets = Sockets()
        await sockets.receive_many(3, 0.0001)
        sockets.interval.end()
        await asyncio.sleep(0.1)
        assert (len(sockets.delays), sockets.is_watched) == (2, False)

    run_virtually(scenario())


def test_a_look_may_leave_the_sockets_to_the_thread():
    async def scenario() -> None:
        sockets = Sockets()
        await sockets.receive_many(3, 0.0001)
        look, sockets.waiting = sockets.look, []

        def ending() -> bool:
            sockets.interval.end()
            return look()

        sockets.interval._look = ending
        await asyncio.sleep(0.1)
        assert not sockets.is_watched

    run_virtually(scenario())


@pytest.mark.skipif(os.name != "posix", reason="the event loop waits for no descriptor")
async def test_packets_that_come_fast_are_taken_together_if_the_program_allows_that():
    async with vehicle_on(input_interval=0.002) as (node, sender):
        await granted(node, sender)
        received: list[int] = []
        node.add_listener(common.VfrHud, lambda message: received.append(message.heading))
        sent, is_rested = iter(range(1, 20_000)), False
        async with asyncio.timeout(20):
            while not is_rested:
                sender.send(common.VfrHud(heading=next(sent)))
                await asyncio.sleep(0.0005)
                is_rested = native(node)._is_direct and native(node).interval._timer is not None
        last = next(sent)
        sender.send(common.VfrHud(heading=last))
        await wait_until(lambda: received[-1] == last)
        assert received == list(range(1, last + 1))
        await wait_until(lambda: native(node).interval._timer is None)


def test_an_interval_is_a_short_time():
    with pytest.raises(InvalidArgumentError, match="input_interval must be 0 to 1 s, got nan"):
        Node(input_interval=float("nan"))
