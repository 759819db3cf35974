"""The driver's timer, which may fire early and never late, and the services that it skips."""

from __future__ import annotations

import asyncio
from types import SimpleNamespace
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.links import MemoryNetwork
from mavstack.node import Node
from mavstack.node.driver import Driver
from mavstack.node.engine import Engine
from mavstack.services import Address, Service
from mavstack.services.addressing import message_ids
from mavstack.sim.virtual import run_virtually

if TYPE_CHECKING:
    from collections.abc import Callable

LOCAL = Address(255, 190)


class Alarm(Service):
    """A service with one timer, at `due`."""

    def __init__(self) -> None:
        super().__init__(LOCAL)
        self.due: float | None = None
        self.fired: list[float] = []

    def next_timeout(self) -> float | None:
        return self.due

    def handle_timeout(self, now: float) -> None:
        if self.due is not None and now >= self.due:
            self.due = None
            self.fired.append(now)


def with_alarm(work: Callable[[Driver, Alarm, list[float]], asyncio.Future | object]) -> Alarm:
    """Run a function with a driver and an alarm; the list holds the times of the timers that were set."""
    alarm = Alarm()

    async def running() -> None:
        loop = asyncio.get_running_loop()
        nothing = lambda *_: None  # noqa: E731
        driver = Driver(Engine(LOCAL), on_packet=nothing, on_event=nothing, on_channel=nothing)
        driver.engine.add(alarm)
        timers: list[float] = []
        set_at = loop.call_at

        def call_at(when, callback, *arguments, **options):
            if getattr(callback, "__self__", None) is driver:
                timers.append(when)
            return set_at(when, callback, *arguments, **options)

        loop.call_at = call_at
        await work(driver, alarm, timers)
        await driver.stop()

    run_virtually(running())
    return alarm


def set_for(driver: Driver, alarm: Alarm, due: float | None) -> None:
    alarm.due = due
    driver.engine.touch(alarm)
    driver.step()


def test_the_timer_is_not_rearmed_for_a_later_deadline_and_fires_in_time() -> None:
    dues = []

    async def work(driver: Driver, alarm: Alarm, timers: list[float]) -> None:
        start = driver.now()
        for number in range(100):
            set_for(driver, alarm, start + 1 + number / 100)
        assert len(timers) == 1
        await asyncio.sleep(5)
        assert len(timers) == 2
        dues.append(start + 1.99)

    assert abs(with_alarm(work).fired[0] - dues[0]) < 1e-6


def test_the_timer_is_rearmed_for_an_earlier_deadline() -> None:
    dues = []

    async def work(driver: Driver, alarm: Alarm, timers: list[float]) -> None:
        start = driver.now()
        for due in (3.0, 2.0, 1.0):
            set_for(driver, alarm, start + due)
        assert len(timers) == 3
        await asyncio.sleep(1.5)
        dues.append(start + 1.0)

    alarm = with_alarm(work)
    assert [round(fired - due, 6) for fired, due in zip(alarm.fired, dues, strict=True)] == [0]


def test_the_timer_is_cancelled_when_nothing_is_due() -> None:
    async def work(driver: Driver, alarm: Alarm, _timers: list[float]) -> None:
        set_for(driver, alarm, driver.now() + 1)
        set_for(driver, alarm, None)
        assert driver._timer is None

    assert with_alarm(work).fired == []


class Watcher(Service):
    """A service that receives heartbeats, and returns whether anything has changed."""

    handles = message_ids(common.Heartbeat)

    def __init__(self, changed: bool | None) -> None:
        super().__init__(LOCAL)
        self.received = self.calls = 0
        self._changed = changed

    def receive(self, packet, now) -> bool | None:
        self.received += 1
        return self._changed

    def next_timeout(self) -> float | None:
        self.calls += 1
        return None


def test_a_service_without_changes_is_skipped() -> None:
    async def work() -> None:
        network = MemoryNetwork()
        ground, vehicle = Node(network.link()), Node(network.link(), system=1, component=1)
        quiet, other = ground.serve(Watcher(changed=False)), ground.serve(Watcher(changed=None))
        async with ground:
            await asyncio.sleep(0.1)
            before = quiet.calls
            async with vehicle:
                await asyncio.sleep(5.5)
        assert quiet.received == other.received >= 5
        assert quiet.calls - before <= 1  # when the channel opened
        assert other.calls >= 5

    run_virtually(work())


def test_a_message_that_is_sent_immediately_before_the_node_closes_leaves() -> None:
    async def work() -> None:
        network = MemoryNetwork()
        ground = Node(network.link(), heartbeat=False)
        vehicle = Node(network.link(), system=1, component=1, heartbeat=False)
        received: list[int] = []
        vehicle.add_listener(common.NamedValueInt, lambda message: received.append(message.value))
        async with vehicle:
            async with ground:
                await asyncio.sleep(0.1)
                for number in range(5):
                    ground.send(common.NamedValueInt(name="n", value=number))
            await asyncio.sleep(0.1)
        assert received == list(range(5))

    run_virtually(work())


def test_messages_that_are_sent_in_one_turn_let_answers_come_without_delay() -> None:
    async def work(driver: Driver, _alarm: Alarm, _timers: list[float]) -> None:
        hurried: list[float] = []
        driver.native = SimpleNamespace(hurry=lambda: hurried.append(driver.now()), stop=lambda: None)
        driver.step_soon()
        driver.step_soon()
        assert hurried == []
        await asyncio.sleep(0)
        assert len(hurried) == 1
        driver.step_soon()
        await asyncio.sleep(0)
        assert len(hurried) == 2

    with_alarm(work)
