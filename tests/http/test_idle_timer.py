"""Unused connections are closed; used ones are not."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.http.idle_timer import IDLE_TIMEOUT, IdleTimer
from mavstack.sim.virtual import run_virtually


class Transport(asyncio.Transport):
    """Notes the time at which it is closed."""

    closed_at: float | None = None

    def close(self) -> None:
        self.closed_at = asyncio.get_running_loop().time()


@pytest.fixture(autouse=True)
def virtual_clock(monkeypatch):
    monkeypatch.setattr("mavstack.http.idle_timer.monotonic", lambda: asyncio.get_running_loop().time())


def closing_time(*steps: tuple[float, str]) -> float | None:
    """Return the seconds until a connection is closed; None: it stays open for a minute."""

    async def run() -> float | None:
        timer, transport = IdleTimer(), Transport()
        begun = asyncio.get_running_loop().time()
        for time, step in steps:
            await asyncio.sleep(begun + time - asyncio.get_running_loop().time())
            timer.begin(transport) if step == "begin" else getattr(timer, step)()
        await asyncio.sleep(60)
        return None if transport.closed_at is None else transport.closed_at - begun

    return run_virtually(run())


def test_an_unused_connection_is_closed() -> None:
    assert closing_time((1, "begin")) == pytest.approx(1 + IDLE_TIMEOUT)


def test_requests_begin_the_time_again() -> None:
    assert closing_time((1, "begin"), (3, "end"), (4, "begin")) == pytest.approx(4 + IDLE_TIMEOUT)


@pytest.mark.parametrize("last", ["end", "stop"])
def test_a_connection_in_use_or_lost_is_not_closed(last) -> None:
    assert closing_time((1, "begin"), (2, last)) is None
