"""The run of `mav watch --tui`."""

from __future__ import annotations

import asyncio
import os
import signal
import sys

import pytest

from mavstack.cli.watch.inspector import running
from mavstack.cli.watch.inspector.window import InspectorWindow
from tests.cli.conftest import flight, stamped


def test_the_window_needs_a_terminal(mav, tlog):
    result = mav("watch", tlog, "--tui")
    assert (result.code, result.err) == (
        2,
        "mav watch: --tui needs a terminal; in a pipe use --once, --json or no option\n",
    )


@pytest.mark.parametrize("option", ["--once", "--json"])
def test_options_that_print_do_not_fit(mav, tlog, option):
    result = mav("watch", tlog, "--tui", option)
    assert result.code == 2
    assert "--tui shows a window in the terminal: leave out --once and --json" in result.err


def test_standard_input_is_not_inspected(mav):
    result = mav("watch", "-", "--tui")
    assert result.code == 2
    assert "standard input" in result.err


def test_without_textual_the_extra_is_named(mav, tlog, monkeypatch):
    monkeypatch.delitem(sys.modules, "mavstack.cli.watch.inspector.running")
    monkeypatch.setitem(sys.modules, "mavstack.cli.watch.inspector.window", None)
    result = mav("watch", tlog, "--tui")
    assert "pip install 'mavstack[tui]'" in result.err


class HeadlessWindow(InspectorWindow):
    """A window without a terminal, which is left alone."""

    async def run_async(self, **options: object) -> int | None:
        async with asyncio.TaskGroup() as group:
            task = group.create_task(super().run_async(headless=True, size=(100, 30)))
        return task.result()


@pytest.mark.flight
def test_a_recording_is_replayed_into_the_window(mav, tmp_path, monkeypatch):
    windows: list[InspectorWindow] = []

    def make(*words) -> InspectorWindow:
        windows.append(HeadlessWindow(*words))
        return windows[0]

    for stream in (sys.stdin, sys.stdout, sys.stderr):
        monkeypatch.setattr(stream, "isatty", lambda: True, raising=False)
    monkeypatch.setattr(running, "InspectorWindow", make)
    path = tmp_path / "flight.tlog"
    path.write_bytes(stamped(flight(5)))
    result = mav("watch", path, "--tui", "--speed", "max", "--for", "20", "--trend", "ATTITUDE.roll")
    assert result.code == 0
    inspector = windows[0].inspector
    assert inspector.has_ended
    inspector.update(1e9)
    assert [(row.name, row.count) for row in inspector.messages] == [
        ("ATTITUDE", 5),
        ("HEARTBEAT", 1),
        ("HEARTBEAT", 1),
    ]
    (series,) = inspector.plot
    assert len(series.points) == 5
    assert series.end == inspector.packets[0].time  # the clock of a recording stands still at its end


@pytest.mark.flight
@pytest.mark.skipif(sys.platform == "win32", reason="there are no pseudo terminals")
@pytest.mark.parametrize(
    ("ending", "code"), [("q", 0), ("\x03", 0), (signal.SIGTERM, 143), (signal.SIGINT, 130)]
)
def test_the_terminal_is_left_as_it_was(tlog, ending, code):
    import pty

    from tests.cli.test_process import running as running_process

    terminal, side = pty.openpty()
    environment = {**os.environ, "TERM": "xterm-256color", "COLUMNS": "100", "LINES": "30"}
    options = {"stdin": side, "stdout": side, "stderr": side, "env": environment}
    seen, sent = b"", False
    with running_process(["watch", str(tlog), "--tui"], **options) as process:
        os.close(side)
        while True:
            try:
                data = os.read(terminal, 65536)
            except OSError:  # the other side is closed
                break
            seen += data
            if not data:
                break
            if not sent and b"ATTITUDE" in seen:
                sent = True
                if isinstance(ending, str):
                    os.write(terminal, ending.encode())
                else:
                    process.send_signal(ending)
        os.close(terminal)
        assert process.wait(20) == code
    assert b"\x1b[?1049h" in seen
    assert b"\x1b[?1049l" in seen
    assert b"Traceback" not in seen
