from __future__ import annotations

import io
import sys

import pytest

from mavstack.cli.common.text import duration_text, size_text
from mavstack.cli.common.transfer_progress import TransferProgress


class Clock:
    now = 100.0

    def __call__(self):
        return self.now


class Terminal(io.StringIO):
    def isatty(self):
        return True


@pytest.mark.parametrize(
    ("size", "text"),
    [
        (0, "0 B"),
        (999, "999 B"),
        (1000, "1.0 kB"),
        (1500, "1.5 kB"),
        (99_900, "99.9 kB"),
        (500_000, "500 kB"),
        (999_700, "1.0 MB"),
        (3_000_000_000, "3.0 GB"),
        (5e15, "5000 TB"),
    ],
)
def test_sizes(size, text):
    assert size_text(size) == text


@pytest.mark.parametrize(
    ("seconds", "text"), [(0.4, "0 s"), (59, "59 s"), (60, "1:00 min"), (187, "3:07 min"), (7500, "2:05 h")]
)
def test_durations(seconds, text):
    assert duration_text(seconds) == text


def test_rate_and_time_left(monkeypatch):
    clock, terminal = Clock(), Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    with TransferProgress("log 1", clock=clock) as progress:
        progress(0, 3_000_000)
        assert terminal.getvalue() == ""  # quick work leaves no trace
        clock.now += 10
        progress(1_000_000, 3_000_000)
        assert terminal.getvalue().endswith("log 1: 33 %, 1.0 MB of 3.0 MB, 100 kB/s, 20 s left")
        shown = len(terminal.getvalue())
        clock.now += 0.1
        progress(1_100_000, 3_000_000)
        assert len(terminal.getvalue()) == shown
    assert terminal.getvalue().endswith("\r\x1b[K")


def test_resumed_part_is_not_counted_in_the_rate():
    clock = Clock()
    progress = TransferProgress("a", clock=clock)
    progress(1_000_000, 2_000_000)
    clock.now += 10
    assert progress.text(1_100_000, 2_000_000) == "a: 55 %, 1.1 MB of 2.0 MB, 10.0 kB/s, 1:30 min left"


def test_without_bytes_or_total():
    clock = Clock()
    progress = TransferProgress("parameters", in_bytes=False, clock=clock)
    progress(0, 900)
    clock.now += 2
    assert progress.text(450, 900) == "parameters: 50 %, 2 s left"
    assert TransferProgress("a", clock=clock).text(500, 0) == "a: 500 B"


def test_no_output_in_a_pipe(capsys):
    clock = Clock()
    with TransferProgress("a", clock=clock) as progress:
        clock.now += 10
        progress(1, 2)
    assert capsys.readouterr().err == ""
