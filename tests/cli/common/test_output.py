"""Lines on stderr: whole in a pipe, broken between words on a terminal."""

from __future__ import annotations

import os
from io import StringIO

import pytest

from mavstack.cli.common.output import coloured, echo, terminal_width

LONG = "mav vehicle: going to 47.0, 8.0 with 1/1 failed: DENIED (the target is 19,321 km away)"


class Terminal(StringIO):
    def isatty(self):
        return True


def terminal_of_50_columns(monkeypatch):
    """Replace stderr; return a function that returns the printed text."""
    monkeypatch.setenv("COLUMNS", "50")
    terminal = Terminal()
    monkeypatch.setattr("sys.stderr", terminal)
    return terminal.getvalue


def test_a_long_error_breaks_between_words_on_a_terminal(monkeypatch):
    stderr = terminal_of_50_columns(monkeypatch)
    echo(LONG, "short", error=True)
    lines = stderr().splitlines()
    assert all(len(line) <= 50 for line in lines)
    assert " ".join(line.strip() for line in lines) == f"{LONG} short"
    assert [line.startswith("  ") for line in lines] == [False, True, False]


def test_the_indentation_of_a_broken_line_stays(monkeypatch):
    stderr = terminal_of_50_columns(monkeypatch)
    echo(f"    {LONG}", error=True)
    assert [len(line) - len(line.lstrip()) for line in stderr().splitlines()] == [4, 6, 6]


def test_colours_have_no_width(monkeypatch):
    stderr = terminal_of_50_columns(monkeypatch)
    monkeypatch.delenv("NO_COLOR", raising=False)
    echo(coloured("x" * 50, "red"), error=True)
    assert stderr() == f"\x1b[31m{'x' * 50}\x1b[0m\n"


def test_a_pipe_gets_one_line(capsys):
    echo(LONG, error=True)
    assert capsys.readouterr().err == f"{LONG}\n"


def test_the_width_is_that_of_the_terminal_of_stderr(monkeypatch):
    stderr = terminal_of_50_columns(monkeypatch)
    monkeypatch.setattr("sys.stderr.fileno", lambda: 2, raising=False)
    monkeypatch.setattr(os, "get_terminal_size", lambda descriptor: os.terminal_size((120, 24)))
    echo(LONG, error=True)
    assert stderr() == f"{LONG}\n"


@pytest.mark.parametrize(("chosen", "width"), [("61", 61), ("0", 120), ("wide", 120), (None, 120)])
def test_the_width_is_chosen_or_that_of_the_terminal_of_stdout(monkeypatch, chosen, width):
    monkeypatch.setattr("sys.stdout", Terminal())
    monkeypatch.setattr("sys.stdout.fileno", lambda: 1, raising=False)
    monkeypatch.setattr(os, "get_terminal_size", lambda descriptor: os.terminal_size((120, 24)))
    monkeypatch.delenv("COLUMNS", raising=False)
    if chosen is not None:
        monkeypatch.setenv("COLUMNS", chosen)
    assert terminal_width() == width


def test_a_pipe_has_80_columns(monkeypatch):
    monkeypatch.delenv("COLUMNS", raising=False)
    monkeypatch.setattr("sys.stdout", StringIO())
    assert terminal_width() == 80
