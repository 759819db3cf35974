"""The commands of `mav`: where each is defined, and its argument parser.

A command is a module with `EXAMPLES`, `add_arguments(parser)` and `run(arguments) -> int`. It is imported
when it is needed, so that `mav --help` loads none of them.
"""

from __future__ import annotations

import re
from argparse import ArgumentParser, RawDescriptionHelpFormatter, _SubParsersAction
from importlib import import_module
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, NamedTuple, Protocol, cast

from mavstack.cli.common.interrupted_imports import ended_by_sigint
from mavstack.cli.common.log_output import add_logging_options

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Mapping


class CommandEntry(NamedTuple):
    """The module of a command, and one line about it."""

    module: str
    summary: str


class CommandModule(Protocol):
    """The functions and examples that the module of a command has."""

    EXAMPLES: str

    def add_arguments(self, parser: ArgumentParser) -> None:
        """Declare the arguments that follow the name of the command."""

    def run(self, arguments: Namespace) -> int:
        """Run the command and return its exit code."""


def _entry(name: str, summary: str) -> tuple[str, CommandEntry]:
    return name, CommandEntry(f"mavstack.cli.{name}.command", summary)


COMMANDS: Final[Mapping[str, CommandEntry]] = MappingProxyType(
    dict(
        [
            _entry("sim", "simulated vehicles for any ground station, library or script"),
            _entry("demo", "a simulated fleet with a live display, without hardware"),
            _entry("watch", "messages of a link or a file: rates, values, link quality"),
            _entry("record", "record the packets of links to a file that survives a crash"),
            _entry("data", "logs on disk: facts, conversion, queries, reports, charts"),
            _entry("vehicle", "act on a vehicle: arm, takeoff, goto, mode, info and others"),
            _entry("rate", "how often a vehicle sends a message: show it, set it"),
            _entry("param", "parameters of a vehicle: list, get, set, save, load, diff"),
            _entry("mission", "missions, fences, rally points: upload, download, show, start"),
            _entry("ftp", "files on a vehicle: ls, get, put, rm, mkdir, rename, crc"),
            _entry("log", "logs on a vehicle: list, get, erase"),
            _entry("camera", "cameras of a vehicle: info, photo, video, mode, settings and others"),
            _entry("gimbal", "gimbals of a vehicle: info, point, turn, center, roi, take, release"),
            _entry("key", "signing keys: new, list, remove; install one on a vehicle, turn signing off"),
            _entry("terrain", "heights of the terrain: serve them to vehicles, check what a vehicle has"),
            _entry("shell", "interactive console: arm, mode, takeoff, wp, param, ftp, log"),
            _entry("dialect", "list, show, check, compare and import message definitions"),
            _entry("gen", "libraries in C, C++, TypeScript and other languages from a dialect"),
            _entry("completion", "print a completion script for bash, zsh or fish"),
            _entry("doctor", "check the installation"),
        ]
    )
)


def load_command(name: str) -> CommandModule:
    """Import the module of a command."""
    with ended_by_sigint():
        return cast("CommandModule", import_module(COMMANDS[name].module))


class CommandParser(ArgumentParser):
    """A parser that takes words such as -35.3,149.1 for values, not for options."""

    def __init__(self, *arguments: Any, **options: Any) -> None:  # noqa: ANN401 (those of ArgumentParser)
        super().__init__(*arguments, **options)
        self._negative_number_matcher = re.compile(r"-\.?\d")


def command_parser(name: str) -> ArgumentParser:
    """Return the argument parser of a command; this imports the command's module."""
    module, summary = load_command(name), COMMANDS[name].summary
    parser = CommandParser(
        prog=f"mav {name}",
        description=summary[0].upper() + summary[1:] + ".",
        epilog=module.EXAMPLES,
        formatter_class=RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    module.add_arguments(parser)
    for each in (parser, *(action for _, _, action in actions_of(parser))):
        add_logging_options(each)
    return parser


def actions_of(parser: ArgumentParser) -> list[tuple[str, str, ArgumentParser]]:
    """Return the actions of a command: name, summary, parser."""
    found: list[tuple[str, str, ArgumentParser]] = []
    for action in parser._actions:  # noqa: SLF001 (argparse has no public access)
        if isinstance(action, _SubParsersAction):
            summaries = {each.dest: each.help or "" for each in action._get_subactions()}  # noqa: SLF001
            found += [(name, summaries.get(name, ""), each) for name, each in action.choices.items()]
    return found
