"""The confirmation of actions that cannot be undone: a question on the terminal, or `--yes`."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from mavstack.cli.common.errors import UsageError
from mavstack.cli.common.output import echo, echo_question

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace


def add_yes_option(parser: ArgumentParser) -> None:
    """Declare `--yes`."""
    parser.add_argument("-y", "--yes", action="store_true", help="do not ask for confirmation")


def is_confirmed(arguments: Namespace, question: str, action: str) -> bool:
    """Return whether the user agrees to an action; say so if not.

    Args:
        arguments: The parsed arguments, with `yes`.
        question: What happens, as a question without question mark.
        action: The action, an infinitive for the error.

    Raises:
        UsageError: Nobody can be asked, and `--yes` is not given.
    """
    if arguments.yes:
        return True
    if not sys.stdin.isatty():
        raise UsageError(f"add --yes to {action} without confirmation")
    echo_question(f"{question}? [y/N] ")
    if sys.stdin.readline().strip().lower() in ("y", "yes"):
        return True
    echo("nothing was sent", error=True)
    return False
