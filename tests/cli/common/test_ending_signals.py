"""Signals that end a command leave no name of a pseudo terminal behind."""

from __future__ import annotations

import asyncio
import signal
import subprocess
import sys
from contextlib import contextmanager
from time import monotonic, sleep

import pytest

from mavstack.cli.common.ending_signals import run_until_signal

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="there are no pseudo terminals")
#: Seconds in which a command ends; a busy machine takes long.
LIMIT = 60
COMMANDS = {
    "sim": ("sim", "--out", "pty://{}/name"),
    "radio": ("radio", "sim", "--near", "{}/name"),
}
#: Other commands that open links; they print nothing before the name exists.
OTHERS = {
    "route": ("route", "-e", "pty://{}/name", "-e", "udpin://127.0.0.1:0", "--json"),
    "watch": ("watch", "pty://{}/name", "--json"),
    "record": ("record", "pty://{}/name", "{}.tlog"),
    "vehicle": ("vehicle", "info", "--url", "pty://{}/name"),
    "web": ("web", "pty://{}/name", "--port", "0", "--no-browser"),
    "demo": ("demo", "--out", "pty://{}/name"),
}


@contextmanager
def running(folder, command, *, ignores_sigint=False):
    """Run a command until its name exists; shells ignore SIGINT for background jobs, nohup SIGHUP."""
    words = [word.format(folder) for word in COMMANDS[command]]
    hangup = signal.signal(signal.SIGHUP, signal.SIG_DFL)
    before = signal.signal(signal.SIGINT, signal.SIG_IGN) if ignores_sigint else None
    process = subprocess.Popen(
        [sys.executable, "-m", "mavstack", *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    signal.signal(signal.SIGHUP, hangup)
    if before is not None:
        signal.signal(signal.SIGINT, before)
    with process:
        try:
            process.stdout.readline()
            assert (folder / "name").is_symlink()
            yield process
        finally:
            process.kill()


@pytest.mark.parametrize("ignores_sigint", [False, True])
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP], ids=lambda number: number.name)
@pytest.mark.parametrize("command", COMMANDS)
def test_a_signal_removes_the_name(tmp_path, command, number, ignores_sigint):
    with running(tmp_path, command, ignores_sigint=ignores_sigint) as process:
        process.send_signal(number)
        assert process.wait(LIMIT) == 128 + number
        assert "Traceback" not in process.stderr.read()
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("command", OTHERS)
def test_a_closed_terminal_removes_the_name_of_every_link(tmp_path, command):
    """Before: commands other than simulators were ended at once, and the name stayed."""
    folder = tmp_path / "links"
    folder.mkdir()
    words = [word.format(folder) for word in OTHERS[command]]
    hangup = signal.signal(signal.SIGHUP, signal.SIG_DFL)
    with subprocess.Popen(
        [sys.executable, "-m", "mavstack", *words],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        signal.signal(signal.SIGHUP, hangup)
        end = monotonic() + LIMIT
        while not (folder / "name").is_symlink() and monotonic() < end:
            sleep(0.05)
        process.send_signal(signal.SIGHUP)
        assert process.wait(LIMIT) == 128 + signal.SIGHUP
        assert "Traceback" not in process.stderr.read()
    assert not list(folder.iterdir())


@pytest.mark.parametrize("command", COMMANDS)
def test_a_name_that_a_killed_program_left_is_replaced(tmp_path, command):
    with running(tmp_path, command) as process:
        process.kill()
        process.wait(LIMIT)
    assert (tmp_path / "name").is_symlink()
    with running(tmp_path, command) as process:
        process.send_signal(signal.SIGTERM)
        process.wait(LIMIT)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("command", COMMANDS)
def test_the_name_of_a_program_that_runs_is_not_replaced(tmp_path, command):
    """Before: the second program took the name over, and the first one went on without its client."""
    words = [word.format(tmp_path) for word in COMMANDS[command]]
    with running(tmp_path, command) as process:
        terminal = (tmp_path / "name").readlink()
        done = subprocess.run(
            [sys.executable, "-m", "mavstack", *words],
            capture_output=True,
            text=True,
            check=False,
            timeout=LIMIT,
        )
        assert (done.returncode, done.stderr.count("\n")) == (1, 1)
        assert "another program that runs has this name" in done.stderr
        assert (tmp_path / "name").readlink() == terminal
        assert process.poll() is None


@pytest.mark.parametrize("command", COMMANDS)
def test_a_file_is_never_replaced(tmp_path, command):
    (tmp_path / "name").write_text("mine")
    words = [word.format(tmp_path) for word in COMMANDS[command]]
    done = subprocess.run(
        [sys.executable, "-m", "mavstack", *words], capture_output=True, text=True, check=False, timeout=LIMIT
    )
    assert done.returncode == 1
    assert done.stderr.count("\n") == 1
    assert (tmp_path / "name").read_text() == "mine"


async def signalled(ended):
    """Send SIGTERM to this process, and note an orderly end."""
    try:
        signal.raise_signal(signal.SIGTERM)
        await asyncio.sleep(LIMIT)
    finally:
        ended.append(True)


def test_the_work_ends_in_order_and_signals_are_as_before():
    before, ended = signal.getsignal(signal.SIGTERM), []
    with pytest.raises(SystemExit) as caught:
        run_until_signal(signalled(ended))
    assert caught.value.code == 143
    assert ended == [True]
    assert signal.getsignal(signal.SIGTERM) is before


def test_work_that_ends_before_has_its_result():
    async def work():
        return 7

    assert run_until_signal(work()) == 7


def test_a_handler_of_the_program_stays():
    received = []

    async def work():
        signal.raise_signal(signal.SIGTERM)

    before = signal.signal(signal.SIGTERM, lambda *_: received.append(1))
    try:
        run_until_signal(work())
    finally:
        signal.signal(signal.SIGTERM, before)
    assert received == [1]
