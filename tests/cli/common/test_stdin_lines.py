"""Lines of standard input from a pipe, and from a terminal in the background and in the foreground."""

from __future__ import annotations

import asyncio
import os
import subprocess
import sys
from contextlib import suppress
from textwrap import dedent

import pytest

from mavstack.cli.common.stdin_lines import stdin_lines

#: Prints whether it is in the background, each pause after a read in the background, and the lines of
#: standard input until `end`.
READER = dedent(
    """
    import asyncio, time
    from mavstack.cli.common import stdin_lines as module
    from mavstack.cli.common.stdin_lines import is_in_background, stdin_lines

    def pause(seconds):
        print("waiting", flush=True)
        time.sleep(seconds)

    module.sleep = pause

    async def main():
        print("background" if is_in_background() else "foreground", flush=True)
        async for line in stdin_lines():
            print("read", line, flush=True)
            if line == "end":
                return

    asyncio.run(main())
    """
)
#: A shell with job control: it starts the reader in the background of the terminal, and brings it to the
#: foreground when a line arrives on descriptor 3.
SHELL = dedent(
    """
    import os, signal, subprocess, sys, threading

    def wait():
        status = os.waitpid(reader.pid, os.WUNTRACED)[1]
        if os.WIFSTOPPED(status):
            print("stopped", flush=True)
            reader.kill()
        os._exit(os.waitstatus_to_exitcode(status) if os.WIFEXITED(status) else 1)

    signal.signal(signal.SIGTTOU, signal.SIG_IGN)
    terminal = os.open(sys.argv[1], os.O_RDWR)  # the first terminal of a session controls it
    commands = os.fdopen(int(sys.argv[2]))
    reader = subprocess.Popen(
        [sys.executable, "-c", sys.argv[3]], stdin=terminal, process_group=0, close_fds=True
    )
    threading.Thread(target=wait, daemon=True).start()
    commands.readline()
    os.tcsetpgrp(terminal, reader.pid)
    threading.Event().wait()
    """
)


def test_lines_of_a_pipe() -> None:
    done = subprocess.run(
        [sys.executable, "-c", READER],
        input="one\ntwo",
        capture_output=True,
        text=True,
        timeout=60,
        check=True,
    )
    assert done.stdout.splitlines() == ["foreground", "read one", "read two"]


@pytest.fixture
def writing(monkeypatch):
    """The other end of standard input."""
    ours, theirs = os.pipe()
    os.set_blocking(theirs, False)
    with os.fdopen(ours, "rb") as stdin:
        monkeypatch.setattr(sys, "stdin", stdin)
        yield theirs


async def test_a_program_that_writes_faster_than_lines_are_handled_waits(writing):
    lines = stdin_lines()
    os.write(writing, b"first\n")
    assert await anext(lines) == "first"
    written = 0
    for _ in range(100):
        with suppress(BlockingIOError):
            while written < 1 << 20:
                written += os.write(writing, b"\n" * 1000)
        await asyncio.sleep(0.001)
    os.close(writing)
    assert written < 1 << 20
    assert len([line async for line in lines]) == written


async def test_a_line_without_an_end_is_cut(writing, monkeypatch):
    monkeypatch.setattr("mavstack.cli.common.stdin_lines._MAX_LINE", 5000)
    os.write(writing, b"a" * 20_000)
    os.close(writing)
    assert [len(line) async for line in stdin_lines()] == [8192, 8192, 3616]


@pytest.mark.skipif(sys.platform == "win32", reason="terminals of POSIX")
def test_a_process_in_the_background_is_not_stopped_and_reads_in_the_foreground() -> None:
    import pty

    ours, theirs = pty.openpty()
    reading, writing = os.pipe()
    shell = subprocess.Popen(
        [sys.executable, "-c", SHELL, os.ttyname(theirs), str(reading), READER],
        stdout=subprocess.PIPE,
        text=True,
        start_new_session=True,
        pass_fds=[reading],
    )
    try:
        assert shell.stdout is not None
        os.close(reading)
        assert shell.stdout.readline() == "background\n"
        assert shell.stdout.readline() == "waiting\n"
        os.write(writing, b"foreground\n")
        os.write(ours, b"fault\n")
        while (line := shell.stdout.readline()) == "waiting\n":
            pass
        assert line == "read fault\n"
        os.write(ours, b"end\n")
        assert shell.stdout.readline() == "read end\n"
        assert shell.wait(60) == 0
    finally:
        shell.kill()
        shell.communicate()
        for descriptor in (ours, theirs, writing):
            os.close(descriptor)
