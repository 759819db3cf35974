"""The interactive loop, with scripted input in place of a terminal."""

from __future__ import annotations

import asyncio
import signal
from contextlib import nullcontext

import pytest

from mavstack.cli.shell.interactive import line_reader, run_interactive
from mavstack.cli.shell.plain_input import PlainReader
from mavstack.cli.shell.state import history_file, state_directory
from tests.cli.shell.shell_session import COPTER, alone, in_shell
from tests.waiting import wait_until


class ScriptedInput:
    """Gives lines, or raises what a key does."""

    def __init__(self, *lines):
        self.lines = list(lines)

    async def read(self):
        if not self.lines:
            raise EOFError
        line = self.lines.pop(0)
        if isinstance(line, type):
            raise line
        return line

    async def ask(self, question):
        raise EOFError

    def busy(self):
        return nullcontext()


def test_failures_are_reported_and_the_shell_continues(capsys):
    async def scenario(session):
        await run_interactive(
            session, ScriptedInput("bad", KeyboardInterrupt, "", "'", "set timeout 4", "set timeout")
        )

    alone(scenario)
    captured = capsys.readouterr()
    assert "there is no command 'bad'" in captured.err
    assert "no closing quotation" in captured.err
    assert captured.out == "timeout  4\n"


def test_exit(capsys):
    scripted = ScriptedInput("exit", "set timeout")
    alone(lambda session: run_interactive(session, scripted))
    assert scripted.lines == ["set timeout"]


def test_unexpected_error_is_reported_and_the_shell_continues(capsys):
    async def scenario(session):
        session.forwarding = None
        await run_interactive(session, ScriptedInput("output list", "set timeout"))

    alone(scenario)
    captured = capsys.readouterr()
    assert "unexpected error: AttributeError" in captured.err
    assert captured.out == "timeout  0\n"


@pytest.mark.nightly
def test_ctrl_c_cancels_only_the_command(capsys):
    async def scenario(session, world):
        loop = asyncio.get_running_loop()
        loop.call_later(5.0, signal.raise_signal, signal.SIGINT)
        before = signal.getsignal(signal.SIGINT)
        began = session.connection.now()
        await run_interactive(session, ScriptedInput("mode guided; arm; takeoff 80", "set timeout"))
        assert session.connection.now() < began + 7
        assert signal.getsignal(signal.SIGINT) == before

    in_shell(COPTER, scenario)
    captured = capsys.readouterr()
    assert "cancelled" in captured.err
    assert captured.out == "mode GUIDED\narmed\ntimeout  0\n"


@pytest.mark.flight
def test_question_without_answer_is_refused(capsys):
    async def scenario(session, world):
        scripted = ScriptedInput("log erase", "set timeout")
        session.ask = scripted.ask
        await run_interactive(session, scripted)

    in_shell(COPTER, scenario)
    assert "no answer" in capsys.readouterr().err


def test_history_is_private(tmp_path, monkeypatch):
    monkeypatch.setattr("sys.platform", "linux")
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    assert state_directory() == tmp_path / "mavstack"
    path = history_file()
    assert path == tmp_path / "mavstack" / "shell_history"
    assert path.stat().st_mode & 0o077 == 0


def test_history_file_cannot_be_made(tmp_path, monkeypatch):
    monkeypatch.setattr("sys.platform", "linux")
    (tmp_path / "file").touch()
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "file"))
    assert history_file() is None


@pytest.mark.flight
def test_prompt_with_completion_and_history(tmp_path, monkeypatch):
    from prompt_toolkit.application import create_app_session
    from prompt_toolkit.input import create_pipe_input
    from prompt_toolkit.output import DummyOutput

    monkeypatch.setattr("sys.platform", "linux")
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))

    async def scenario(session):
        with create_pipe_input() as keys, create_app_session(input=keys, output=DummyOutput()):
            line = line_reader(session)
            reading = asyncio.create_task(line.read())
            keys.send_text("arm thr\t")
            await wait_until(lambda: line._prompt.default_buffer.text == "arm throttle")
            keys.send_text("\n")
            assert await reading == "arm throttle"
            keys.send_text("\x1b[A\n")
            assert await line.read() == "arm throttle"
            keys.send_text("yes\n")
            assert await line.ask("sure? ") == "yes"
            with line.busy():
                pass

    async def whole():
        from mavstack.cli.shell.registry import COMMANDS
        from mavstack.cli.shell.session import Session
        from mavstack.links import MemoryNetwork
        from mavstack.vehicle import connect

        async with connect(MemoryNetwork().link()) as node, Session(node, COMMANDS) as session:
            await scenario(session)

    asyncio.run(whole())
    assert "+arm throttle" in (tmp_path / "mavstack" / "shell_history").read_text()


def test_plain_input_without_prompt_toolkit(monkeypatch, capsys):
    import builtins
    import sys

    monkeypatch.setitem(sys.modules, "prompt_toolkit", None)
    monkeypatch.delitem(sys.modules, "mavstack.cli.shell.prompt_input", raising=False)
    asked = []

    def typed(prompt):
        asked.append(prompt)
        if len(asked) > 1:
            raise EOFError
        return "set timeout"

    monkeypatch.setattr(builtins, "input", typed)

    async def whole():
        from mavstack.cli.shell.registry import COMMANDS
        from mavstack.cli.shell.session import Session
        from mavstack.links import MemoryNetwork
        from mavstack.vehicle import connect

        async with connect(MemoryNetwork().link()) as node, Session(node, COMMANDS) as session:
            line = line_reader(session)
            assert isinstance(line, PlainReader)
            await run_interactive(session, line)

    asyncio.run(whole())
    captured = capsys.readouterr()
    assert "pip install 'mavstack[cli]'" in captured.err
    assert captured.out == "timeout  0\n"
    assert asked == ["no vehicle> "] * 2
