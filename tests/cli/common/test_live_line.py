"""A line on a terminal that tells how long work gets on."""

from __future__ import annotations

import asyncio
import io

import pytest

from mavstack.cli.common.live_line import SHOW_DELAY, SHOW_INTERVAL, LiveLine
from mavstack.sim.virtual import run_virtually


class Terminal(io.StringIO):
    def isatty(self):
        return True


async def work(seconds: float) -> None:
    texts = iter(["one", "two", "three"])
    async with LiveLine(lambda: next(texts)):
        await asyncio.sleep(seconds)


def test_the_line_follows_the_text_and_is_erased(monkeypatch):
    terminal = Terminal()
    monkeypatch.setattr("sys.stderr", terminal)
    run_virtually(work(SHOW_DELAY + 1.5 * SHOW_INTERVAL))
    assert terminal.getvalue() == "\r\x1b[Kone\r\x1b[Ktwo\r\x1b[K"


def test_short_work_leaves_no_trace(monkeypatch):
    terminal = Terminal()
    monkeypatch.setattr("sys.stderr", terminal)
    run_virtually(work(0.9 * SHOW_DELAY))
    assert terminal.getvalue() == ""


def test_the_line_is_erased_by_an_error(monkeypatch):
    terminal = Terminal()
    monkeypatch.setattr("sys.stderr", terminal)

    async def failing() -> None:
        async with LiveLine(lambda: "one"):
            await asyncio.sleep(2 * SHOW_DELAY)
            raise ValueError("broken")

    with pytest.raises(ValueError, match="broken"):
        run_virtually(failing())
    assert terminal.getvalue().endswith("\r\x1b[K")


def test_nothing_in_a_pipe(capsys):
    run_virtually(work(2.0))
    assert capsys.readouterr().err == ""
