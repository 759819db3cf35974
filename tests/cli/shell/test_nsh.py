"""An interactive session in the shell of a vehicle, with scripted input in place of a terminal."""

from __future__ import annotations

import asyncio
import os
import signal
import sys

import pytest

from mavstack.cli.common.errors import CommandError
from mavstack.cli.shell.nsh import ShellOutput, run_session
from mavstack.cli.shell.runner import run_line
from tests.cli.shell.shell_session import COPTER, PX4_COPTER, alone, in_shell
from tests.waiting import wait_until


class FakeShell:
    """A shell that echoes lines and prints a prompt, or nothing at all."""

    def __init__(self, *, silent: bool = False) -> None:
        self.output: asyncio.Queue[str] = asyncio.Queue()
        self.received: list[bytes | str] = []
        self.silent = silent

    def write(self, data: bytes) -> None:
        self.received.append(data)

    def write_line(self, text: str) -> None:
        if not text:
            if not self.silent:
                self.output.put_nowait("\r\nnsh> ")
            return
        self.received.append(text)
        self.output.put_nowait(f"nsh> {text}\r\n")
        self.output.put_nowait(f"\x1b[2Kdid {text}\r\nnsh> ")

    def __aiter__(self):
        return self

    async def __anext__(self) -> str:
        return await self.output.get()


class Keys:
    """A reader whose lines are scripted; an exception is a key, a callable an event."""

    def __init__(self, *lines) -> None:
        self.lines = list(lines)
        self.prompts: list[str] = []
        self.history = ""

    def nested(self, history, prompt):
        self.history = history

        async def read() -> str:
            await asyncio.sleep(1)
            self.prompts.append(prompt())
            line = self.lines.pop(0) if self.lines else EOFError
            if isinstance(line, type):
                raise line
            return line

        return read


def in_session(shell, keys):
    async def scenario(session):
        session.reader = keys
        await run_session(session, shell)

    alone(scenario)


def test_lines_are_sent_and_their_output_is_shown_without_echo(capsys):
    shell, keys = FakeShell(), Keys("ver all", "ls")
    in_session(shell, keys)
    assert shell.received == ["ver all", "ls"]
    out = capsys.readouterr().out.splitlines()
    assert out == [
        "Ctrl-C interrupts the command on the vehicle, Ctrl-D leaves its shell.",
        "did ver all",
        "did ls",
    ]
    assert keys.prompts == ["nsh> "] * 3
    assert keys.history == "nsh"


def test_the_key_ctrl_c_is_passed_on_and_the_session_continues():
    shell = FakeShell()
    in_session(shell, Keys("top", KeyboardInterrupt, "ls"))
    assert shell.received == ["top", b"\x03", "ls"]


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
async def test_the_signal_of_ctrl_c_is_passed_on():
    """Without prompt_toolkit the terminal makes a signal of the key."""

    class Waiting:
        def nested(self, history, prompt):
            async def read() -> str:
                os.kill(os.getpid(), signal.SIGINT)
                await wait_until(lambda: shell.received)
                raise EOFError

            return read

    class Session:
        reader = Waiting()

        def print(self, *lines: str) -> None: ...

    shell = FakeShell()
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        await run_session(Session(), shell)
    finally:
        signal.signal(signal.SIGINT, before)
    assert shell.received == [b"\x03"]


def test_a_vehicle_without_a_shell_is_reported():
    with pytest.raises(CommandError, match="no shell answered; only PX4 has one"):
        in_session(FakeShell(silent=True), Keys())


def test_output_in_any_pieces():
    output = ShellOutput()
    output.sent("free")
    text = "nsh> free\r\n  total\tused\r\n\x1b[31m12\x1b[0m\r\nnsh> "
    lines = [line for letter in text for line in output.feed(letter)]
    assert lines == ["  total used", "12"]
    assert output.prompt == "nsh> "
    assert ShellOutput().feed("free\nfree\n") == ["free", "free"]


def test_control_characters_of_the_vehicle_do_not_reach_the_terminal():
    assert "\x07" not in ShellOutput().feed("bell \x07\n")[0]


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("kind", [PX4_COPTER, COPTER], ids=["PX4", "ArduPilot"])
def test_a_session_with_a_simulated_vehicle(kind, capsys):
    async def scenario(session, world):
        session.reader = Keys("ver all", KeyboardInterrupt, "param show SYS_AUTOSTART")
        if kind == COPTER:
            with pytest.raises(CommandError, match="no shell answered"):
                await run_line(session, "nsh")
        else:
            await run_line(session, "nsh")

    in_shell(kind, scenario)
    if kind == PX4_COPTER:
        out = capsys.readouterr().out
        assert "PX4" in out
        assert "SYS_AUTOSTART" in out
        assert "nsh> ver all" not in out
