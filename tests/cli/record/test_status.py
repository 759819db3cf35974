"""The status line of a recording."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

from mavstack.cli.record.status import RecordingStatus


def test_the_line_shows_packets_size_rate_and_time():
    recorder = SimpleNamespace(packets=0, bytes=0, path=Path("flight.tlog"))
    status = RecordingStatus(SimpleNamespace(recorder=recorder))
    start = status._started
    recorder.packets, recorder.bytes = 500, 20_000
    assert status.text(start + 2) == "flight.tlog: 500 packets, 20.0 kB, 250.0 packets/s, 2.0 s · Ctrl-C ends"
    recorder.packets = 600
    assert "100.0 packets/s" in status.text(start + 3)


def test_nothing_is_drawn_in_a_pipe(capsys):
    with RecordingStatus(SimpleNamespace(recorder=None)):
        pass
    assert capsys.readouterr().err == ""
