"""A socket that the link reads itself for a moment, and the thread again afterwards."""

import asyncio

import pytest

from mavstack.links import native_reading
from mavstack.links.native_reading import MAX_TIME, MIN_TIME, NativeReading


class Link:
    """A link that records who reads its socket."""

    closed = False

    def __init__(self) -> None:
        self.reader = "link"

    def pass_socket(self) -> int:
        self.reader = "nobody"
        return 7

    def read_itself(self) -> None:
        self.reader = "link"

    def watch_socket(self, watcher) -> None: ...


class Core:
    def __init__(self, link: Link) -> None:
        self._link = link

    def add_socket(self, number: int, descriptor: int) -> None:
        assert (number, descriptor) == (3, 7)
        self._link.reader = "thread"


@pytest.fixture
def clock(monkeypatch):
    now = [1000.0]
    monkeypatch.setattr(native_reading, "monotonic", lambda: now[0])
    return now


async def time_of_a_take_over(reading, link, clock) -> float:
    """Let the link read until it returns the socket; return the seconds."""
    began = clock[0]
    reading.take_over()
    assert link.reader == "link"
    while link.reader == "link":
        clock[0] += 0.01
        reading.handled()
    assert link.reader == "nobody"
    await asyncio.sleep(0)
    assert link.reader == "thread"
    return clock[0] - began


async def test_a_link_reads_longer_each_time_that_the_program_soon_does_not_keep_up_again(clock):
    link = Link()
    reading = NativeReading(link, Core(link), 3)
    reading.start()
    times = [await time_of_a_take_over(reading, link, clock) for _ in range(7)]
    assert times == pytest.approx([0.05, 0.1, 0.2, 0.4, 0.8, 1.6, 1.6], abs=0.011)
    clock[0] += MAX_TIME
    assert await time_of_a_take_over(reading, link, clock) == pytest.approx(MIN_TIME, abs=0.011)


async def test_a_socket_is_only_due_while_the_link_reads_it(clock):
    link = Link()
    reading = NativeReading(link, Core(link), 3)
    reading.start()
    assert not reading.is_due
    reading.take_over()
    assert not reading.is_due
    clock[0] += MIN_TIME
    assert reading.is_due
    reading.handled()
    link.closed = True
    await asyncio.sleep(0)
    assert link.reader == "nobody", "the link was closed meanwhile"
