"""`mav` in its own process: exit codes, Ctrl-C, a closed pipe, a terminal."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from contextlib import contextmanager
from typing import TYPE_CHECKING

import pytest

from tests.cli.conftest import flight, stamped

if TYPE_CHECKING:
    from collections.abc import Iterator

MAV = [sys.executable, "-m", "mavstack"]
#: Seconds after which a command has started, also on a busy machine.
START_TIME = 4.0


def run(*words: object) -> subprocess.CompletedProcess:
    return subprocess.run([*MAV, *map(str, words)], capture_output=True, text=True, timeout=60, check=False)


@contextmanager
def running(words, **options) -> Iterator[subprocess.Popen]:
    """Start a command, and kill it if the test ends before it."""
    process = subprocess.Popen([*MAV, *words], **options)
    try:
        yield process
    finally:
        process.kill()
        process.wait()


@pytest.mark.flight
def test_exit_codes():
    assert run("--version").returncode == 0
    assert run("nonsense").returncode == 2
    failed = run("watch", "missing.tlog")
    assert failed.returncode == 1
    assert failed.stderr.count("\n") == 1


@pytest.mark.fast_cases(1)
@pytest.mark.skipif(sys.platform == "win32", reason="there are no such signals")
@pytest.mark.parametrize(
    "words", [["watch", "udpin://127.0.0.1:0", "--json"], ["demo", "--out", "udpout://127.0.0.1:9"]]
)
def test_ctrl_c_ends_the_command(words):
    with running(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        try:
            process.communicate(timeout=START_TIME)
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=20)
    assert (process.returncode, out, err) == (130, "", "")


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("option", ["--json", "--for=1000"])
def test_closed_pipe_is_no_failure(tmp_path, option):
    path = tmp_path / "long.tlog"
    path.write_bytes(stamped(flight(20_000)))
    process = subprocess.Popen(
        [*MAV, "watch", str(path), option], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    process.stdout.readline()
    process.stdout.close()
    assert process.wait(20) == 0
    assert process.stderr.read() == ""
    process.stderr.close()


@pytest.mark.fast_cases(1)
@pytest.mark.skipif(sys.platform == "win32", reason="there are no pseudo terminals")
@pytest.mark.parametrize("ending", [None, signal.SIGINT, signal.SIGTERM])
def test_live_display_restores_the_terminal(ending):
    check_live_display(ending)


@pytest.mark.skipif(sys.platform == "win32", reason="there are no pseudo terminals")
def test_live_display_ends_by_sigterm_in_a_background_job():
    """A shell ignores SIGINT in background jobs."""
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        check_live_display(signal.SIGTERM)
    finally:
        signal.signal(signal.SIGINT, before)


@pytest.mark.skipif(sys.platform == "win32", reason="there are no pseudo terminals")
def test_live_display_ends_when_its_terminal_vanishes_and_sighup_is_ignored():
    """Before: it went on for ever without output."""
    import pty

    def ignore_signals():
        signal.signal(signal.SIGHUP, signal.SIG_IGN)
        signal.signal(signal.SIGINT, signal.SIG_IGN)

    terminal, side = pty.openpty()
    environment = {**os.environ, "TERM": "xterm-256color", "COLUMNS": "100", "LINES": "30"}
    options = {"stdin": side, "stdout": side, "stderr": side, "env": environment}
    seen = b""
    with running(["demo"], preexec_fn=ignore_signals, **options) as process:
        os.close(side)
        while b"quadrotor" not in seen:
            seen += os.read(terminal, 65536)
        os.close(terminal)
        assert process.wait(60) == 129


def check_live_display(ending):
    """Run `mav demo` on a terminal until it ends, or is ended by a signal."""
    import pty

    terminal, side = pty.openpty()
    words = ["demo", "--for", "1.2"] if ending is None else ["demo"]
    environment = {**os.environ, "TERM": "xterm-256color", "COLUMNS": "100", "LINES": "30"}
    seen = b""
    sent = ending is None
    with running(words, stdin=side, stdout=side, stderr=side, env=environment) as process:
        os.close(side)
        while True:
            try:
                data = os.read(terminal, 65536)
            except OSError:  # the other side is closed
                break
            if not data:
                break
            seen += data
            if not sent and b"quadrotor" in seen:
                sent = True
                process.send_signal(ending)
        os.close(terminal)
        assert process.wait(20) == {None: 0, signal.SIGINT: 130, signal.SIGTERM: 143}[ending]
    assert b"\x1b[?1049h" in seen
    left = seen.rpartition(b"\x1b[?1049l")
    assert left[1], "the alternate screen was not left"
    assert b"quadrotor" in left[2]
    assert b"Traceback" not in seen
