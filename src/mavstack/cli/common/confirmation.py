"""The confirmation of actions that cannot be undone: a question on the terminal, or `--yes`."""

from __future__ import annotations

import sys
from contextlib import contextmanager
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.errors import UsageError
from mavstack.cli.common.output import echo, echo_question
from mavstack.cli.common.stdin_lines import stdin_lines

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Iterator

_NOTHING_SENT: Final = "nothing was sent"


def add_yes_option(parser: ArgumentParser) -> None:
    """Declare `--yes`."""
    parser.add_argument("-y", "--yes", action="store_true", help="do not ask for confirmation")


def is_confirmed(arguments: Namespace, question: str, action: str, *, refused: str = _NOTHING_SENT) -> bool:
    """Return whether the user agrees to an action; say so if not.

    Args:
        arguments: The parsed arguments, with `yes`.
        question: What happens, as a question without question mark.
        action: The action, an infinitive for the error.
        refused: The outcome if the user does not agree.

    Raises:
        UsageError: No terminal is there to ask, and `--yes` is not given.
    """
    if arguments.yes:
        return True
    _ask(question, action)
    with _ended_line():
        answer = sys.stdin.readline()
    return _is_yes(answer, refused)


async def is_confirmed_while_connected(arguments: Namespace, question: str, action: str) -> bool:
    """Ask as `is_confirmed` does, while the event loop goes on and Ctrl-C ends the command."""
    if arguments.yes:
        return True
    _ask(question, action)
    with _ended_line():
        answer = await anext(stdin_lines(), "")
    return _is_yes(answer, _NOTHING_SENT)


@contextmanager
def _ended_line() -> Iterator[None]:
    """End the line of the question if it is interrupted instead of answered."""
    try:
        yield
    except BaseException:
        echo("")
        raise


def _ask(question: str, action: str) -> None:
    if sys.stdin is None or not sys.stdin.isatty():
        raise UsageError(f"add --yes to {action} without confirmation")
    echo_question(f"{question}? [y/N] ")


def _is_yes(answer: str, refused: str) -> bool:
    if answer.strip().lower() in ("y", "yes"):
        return True
    echo(refused, error=True)
    return False
