from __future__ import annotations

import asyncio
from argparse import Namespace

import pytest

from mavstack.cli.common import confirmation
from mavstack.cli.common.confirmation import is_confirmed, is_confirmed_while_connected
from mavstack.cli.common.errors import UsageError


class Terminal:
    def __init__(self, is_terminal: bool = True) -> None:
        self.isatty = lambda: is_terminal


async def ask(monkeypatch, *answers: str, yes: bool = False, stdin: Terminal | None = None) -> bool:
    async def typed():
        for answer in answers:
            yield answer

    monkeypatch.setattr(confirmation, "stdin_lines", typed)
    monkeypatch.setattr("sys.stdin", stdin)
    return await is_confirmed_while_connected(Namespace(yes=yes), "send the key", "send a key")


@pytest.mark.parametrize(("answer", "agreed"), [("y", True), (" YES ", True), ("n", False), ("", False)])
async def test_a_question_is_answered_while_the_event_loop_runs(monkeypatch, capsys, answer, agreed):
    assert await ask(monkeypatch, answer, stdin=Terminal()) is agreed
    captured = capsys.readouterr()
    assert captured.out == "send the key? [y/N] "
    assert captured.err == ("" if agreed else "nothing was sent\n")


async def test_the_end_of_the_input_is_no(monkeypatch):
    assert not await ask(monkeypatch, stdin=Terminal())


@pytest.mark.parametrize("stdin", [None, Terminal(False)])
async def test_without_a_terminal_only_the_option_agrees(monkeypatch, stdin):
    with pytest.raises(UsageError, match="add --yes to send a key without confirmation"):
        await ask(monkeypatch, "y", stdin=stdin)
    assert await ask(monkeypatch, yes=True, stdin=stdin)


async def test_an_interrupted_question_ends_its_line(monkeypatch, capsys):
    async def interrupted():
        raise asyncio.CancelledError
        yield ""

    monkeypatch.setattr(confirmation, "stdin_lines", interrupted)
    monkeypatch.setattr("sys.stdin", Terminal())
    with pytest.raises(asyncio.CancelledError):
        await is_confirmed_while_connected(Namespace(yes=False), "send the key", "send a key")
    assert capsys.readouterr().out == "send the key? [y/N] \n"


def test_ctrl_c_at_a_question_ends_its_line(monkeypatch, capsys):
    terminal = Terminal()

    def interrupt():
        raise KeyboardInterrupt

    monkeypatch.setattr(terminal, "readline", interrupt, raising=False)
    monkeypatch.setattr("sys.stdin", terminal)
    with pytest.raises(KeyboardInterrupt):
        is_confirmed(Namespace(yes=False), "remove the key", "remove a key")
    assert capsys.readouterr().out == "remove the key? [y/N] \n"
