"""The words that can follow `mav`, its commands and their actions, from the argument parsers."""

# ruff: noqa: SLF001 (argparse has no public access to the options of a parser)

from __future__ import annotations

from argparse import SUPPRESS, ArgumentParser, _SubParsersAction
from typing import TYPE_CHECKING, Final, NamedTuple

from mavstack.cli.registry import COMMANDS, actions_of, command_parser

if TYPE_CHECKING:
    from argparse import Action
    from collections.abc import Iterator

#: Argument names (as in help texts) whose values are files or directories on this machine.
_FILES: Final = frozenset(
    {"FILE", "FILE.xml", "OFFICIAL.xml", "NAME|FILE.xml", "FILE|NAME", "URL|FILE", "FOLDER", "DIR", "LOCAL"}
    | {"IN", "OUT", "OLD", "NEW"}
)
PROGRAM: Final = "mav"


class OptionWords(NamedTuple):
    """An option: its names and one line about it, and the values that can follow it."""

    names: tuple[str, ...]
    summary: str
    takes_value: bool
    choices: tuple[str, ...]
    files: bool


class CommandWords(NamedTuple):
    """The words that can follow a path such as `mav param load`."""

    path: str
    #: Commands, actions or choices of an argument, with one line about each.
    words: tuple[tuple[str, str], ...]
    #: True if the argument is a file or a directory.
    files: bool
    options: tuple[OptionWords, ...]


def all_words() -> tuple[CommandWords, ...]:
    """Return the words after `mav`, after each command and after each action."""
    help_option = OptionWords(("-h", "--help"), "show the help", False, (), False)
    version = OptionWords(("-V", "--version"), "show the version", False, (), False)
    commands = tuple((name, entry.summary) for name, entry in COMMANDS.items())
    found = [CommandWords(PROGRAM, commands, files=False, options=(help_option, version))]
    for name in COMMANDS:
        parser = command_parser(name)
        actions = actions_of(parser)
        path = f"{PROGRAM} {name}"
        found.append(_words_of(path, parser, tuple((action, summary) for action, summary, _ in actions)))
        found += [_words_of(f"{path} {action}", each) for action, _, each in actions]
    return tuple(found)


def _words_of(path: str, parser: ArgumentParser, actions: tuple[tuple[str, str], ...] = ()) -> CommandWords:
    arguments = [
        each
        for each in parser._actions
        if not each.option_strings and not isinstance(each, _SubParsersAction)
    ]
    choices = tuple((word, "") for each in arguments for word in _choices(each))
    files = any(_is_file(each) for each in arguments)
    return CommandWords(path, actions or choices, files, tuple(_options(parser)))


def _options(parser: ArgumentParser) -> Iterator[OptionWords]:
    for action in parser._actions:
        if action.option_strings and action.help != SUPPRESS:
            yield OptionWords(
                tuple(action.option_strings),
                _summary(action),
                action.nargs != 0,
                _choices(action),
                _is_file(action),
            )


def _choices(action: Action) -> tuple[str, ...]:
    return tuple(map(str, action.choices or ()))


def _is_file(action: Action) -> bool:
    return isinstance(action.metavar, str) and action.metavar in _FILES


def _summary(action: Action) -> str:
    """Return the help of an option up to its default and its examples."""
    return " ".join((action.help or "").partition(" (")[0].partition(";")[0].split())
