"""The actions of a command (`mav param get`), each with a help page and examples of its own."""

from __future__ import annotations

from argparse import RawDescriptionHelpFormatter, _SubParsersAction
from functools import partial
from typing import TYPE_CHECKING, Any, TypeAlias

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Callable

    RunAction: TypeAlias = Callable[[Namespace], int]


class _WordsAction(_SubParsersAction):  # type: ignore[type-arg] # not generic at run time
    """Actions whose names may have two words, such as `zenoh config` beside `zenoh`."""

    def __call__(self, parser: Any, namespace: Any, values: Any, option_string: Any = None) -> None:  # noqa: ANN401
        """Run the parser of the longest name."""
        words = " ".join(values[:2])
        found = [words, *values[2:]] if words in self.choices else values
        super().__call__(parser, namespace, found, option_string)


class Actions:
    """The actions of one command; `run_action` of the parsed arguments runs the chosen one.

    Args:
        parser: The parser of the command.
        command: The name of the command.
        examples: The examples of all actions.
        around: Runs an action within the steps that all actions of the command share; None: there are none.
    """

    def __init__(
        self,
        parser: ArgumentParser,
        command: str,
        examples: str,
        around: Callable[[RunAction, Namespace], int] | None = None,
    ) -> None:
        self._command, self._around = command, around
        self._examples = examples.splitlines()

        self._actions = parser.add_subparsers(
            action=_WordsAction, dest="action", required=True, metavar="ACTION"
        )

    def add(self, name: str, summary: str, run: RunAction) -> ArgumentParser:
        """Add an action; its help page shows those of the command's examples that call it."""
        own = [line for line in self._examples if f"mav {self._command} {name}" in line]
        parser = self._actions.add_parser(
            name,
            help=summary,
            description=summary[0].upper() + summary[1:] + ".",
            epilog="\n".join(["examples:", *own]),
            formatter_class=RawDescriptionHelpFormatter,
            allow_abbrev=False,
        )
        run_action = run if self._around is None else partial(self._around, run)
        parser.set_defaults(run_action=run_action, command=self._command)
        return parser
