"""The actions of a command (`mav param get`), each with a help page of its own and its own examples."""

from __future__ import annotations

from argparse import RawDescriptionHelpFormatter
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Callable


class Actions:
    """Declares actions; `run_action` of the parsed arguments is what carries the chosen one out."""

    def __init__(self, parser: ArgumentParser, command: str, examples: str) -> None:
        self._command = command
        self._examples = examples.splitlines()
        self._actions = parser.add_subparsers(dest="action", required=True, metavar="ACTION")

    def add(self, name: str, summary: str, run: Callable[[Namespace], int]) -> ArgumentParser:
        """An action; the lines of the command's examples that are of it stand on its page."""
        mine = [line for line in self._examples if f"mav {self._command} {name}" in line]
        parser = self._actions.add_parser(
            name,
            help=summary,
            description=summary[0].upper() + summary[1:] + ".",
            epilog="\n".join(["examples:", *mine]),
            formatter_class=RawDescriptionHelpFormatter,
            allow_abbrev=False,
        )
        parser.set_defaults(run_action=run)
        return parser
