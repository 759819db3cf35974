"""The commands of `mav`: where each is defined, and its argument parser.

A command is a module with `EXAMPLES` and `add_arguments(parser)`, which sets the default `run_action` of the
arguments: the function that runs the command, or its chosen action, and returns the exit code. It is imported
when it is needed, so that `mav --help` loads none of them.
"""

from __future__ import annotations

import re
import sys
from argparse import ArgumentParser, HelpFormatter, RawDescriptionHelpFormatter, _SubParsersAction
from functools import partial
from importlib import import_module
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, NamedTuple, NoReturn, Protocol, cast

from mavstack.cli.common.collection import no_collection
from mavstack.cli.common.interrupted_imports import ended_by_sigint
from mavstack.cli.common.log_output import add_logging_options
from mavstack.cli.common.output import terminal_width
from mavstack.cli.common.wrapping import UNLIMITED, example_that_fits, terminal_columns

if TYPE_CHECKING:
    from collections.abc import Mapping


class CommandEntry(NamedTuple):
    """The module of a command and one line about it.

    Attributes:
        module: Name of the module.
        summary: The line.
        logs: False if nothing that the command runs writes to the log.
        mixed: True if options may stand between its words.
        lean: True if its memory matters: large modules that few of its runs need are loaded on use.
    """

    module: str
    summary: str
    logs: bool = True
    mixed: bool = False
    lean: bool = False


class CommandModule(Protocol):
    """The function and examples that the module of a command has."""

    EXAMPLES: str

    def add_arguments(self, parser: ArgumentParser) -> None:
        """Declare the arguments that follow the name of the command, and the function that runs it."""


def _entry(name: str, summary: str, **options: bool) -> tuple[str, CommandEntry]:
    return name, CommandEntry(f"mavstack.cli.{name}.command", summary, **options)


COMMANDS: Final[Mapping[str, CommandEntry]] = MappingProxyType(
    dict(
        [
            _entry("sim", "simulated vehicles for any ground station, library or script"),
            _entry("simulator", "the world in which real PX4 or ArduPilot flies, by any physics"),
            _entry("demo", "a simulated fleet with a live display, without hardware"),
            _entry("watch", "messages of a link or a file: rates, values, link quality"),
            _entry("record", "record the packets of links to a file that survives a crash"),
            _entry(
                "route",
                "join links: forward, filter, record; control a running router",
                mixed=True,
                lean=True,
            ),
            _entry("relay", "a meeting place for vehicles and stations that both dial out: serve, invite"),
            _entry("web", "ground station in the browser, with an HTTP and WebSocket API"),
            _entry("data", "logs on disk: facts, conversion, queries, reports, charts"),
            _entry("vehicle", "act on a vehicle: arm, takeoff, goto, mode, info and others"),
            _entry("swarm", "many vehicles as one: takeoff, formation, move, follow, search, land, stop"),
            _entry("rate", "how often a vehicle sends a message: show it, set it"),
            _entry("param", "parameters of a vehicle: list, get, set, save, load, diff"),
            _entry("mission", "missions, fences, rally points: upload, download, show, start"),
            _entry("ftp", "files on a vehicle: ls, get, put, rm, mkdir, rename, crc"),
            _entry("log", "logs on a vehicle: list, get, erase"),
            _entry("camera", "cameras of a vehicle: info, photo, video, mode, settings and others"),
            _entry("gimbal", "gimbals of a vehicle: info, point, turn, center, roi, take, release"),
            _entry("radio", "SiK telemetry radios: show, get, set, save, load, signal; both ends together"),
            _entry("firmware", "firmware of autopilots and radios: info, list, flash"),
            _entry("msp", "Betaflight and iNav: info, get, set, osd, vtx, cli, dump, restore, passthrough"),
            _entry("bridge", "vehicles on the buses of robotics: ROS 2, Zenoh; the mapping table"),
            _entry("key", "signing keys: new, list, remove; install one on a vehicle, turn signing off"),
            _entry("rtk", "corrections for satellite navigation, from a caster or a base to vehicles"),
            _entry("external", "measurements of a companion computer to a vehicle, from lines of text"),
            _entry("serial", "serial ports of a vehicle, and its position as NMEA, for other programs"),
            _entry("traffic", "aircraft of an ADS-B receiver to vehicles, with alarms"),
            _entry("rid", "Remote ID: may a vehicle arm, and why not; the messages of its operator"),
            _entry("terrain", "heights of the terrain: serve them to vehicles, check what a vehicle has"),
            _entry("map", "maps for places without network: download an area, list, info, remove"),
            _entry("shell", "interactive console: arm, mode, takeoff, wp, param, ftp, log"),
            _entry("dialect", "list, show, check, compare and import message definitions"),
            _entry("gen", "libraries in C, C++, TypeScript and other languages from a dialect", logs=False),
            _entry("completion", "print a completion script for bash, zsh or fish"),
            _entry("doctor", "check the installation"),
        ]
    )
)


def load_command(name: str) -> CommandModule:
    """Import the module of a command."""
    module = COMMANDS[name].module
    with ended_by_sigint():
        if COMMANDS[name].lean:
            from mavstack.cli.common.modules_on_use import load_modules_on_use

            load_modules_on_use()
        if module in sys.modules:
            return cast("CommandModule", sys.modules[module])
        with no_collection():  # it would take up to a sixth of the time
            return cast("CommandModule", import_module(module))


class CommandParser(ArgumentParser):
    """A parser that takes words such as -35.3,149.1 for values, not for options."""

    def __init__(self, *arguments: Any, **options: Any) -> None:  # noqa: ANN401 (those of ArgumentParser)
        # Without `width`, argparse would import `shutil`, which is slow, when the first argument is added.
        formatter = options.get("formatter_class", HelpFormatter)
        options["formatter_class"] = partial(formatter, width=terminal_width() - 2)
        super().__init__(*arguments, **options)
        self._negative_number_matcher = re.compile(r"-\.?\d")

    def format_help(self) -> str:
        """Return the help page; in a narrow terminal the comments of long examples are above them."""
        columns = terminal_columns(UNLIMITED)
        lines = super().format_help().split("\n")
        return "\n".join(part for line in lines for part in example_that_fits(line, columns))

    def error(self, message: str) -> NoReturn:
        """End with the problem that argparse found, and name `--url` if a link is too much."""
        if message.startswith("unrecognized arguments") and "://" in message and _takes_url(self):
            message += "; give the link with --url URL"
        super().error(message)


def _takes_url(parser: ArgumentParser) -> bool:
    """Return whether a parser or one of its actions has the option `--url`."""
    for action in parser._actions:  # noqa: SLF001 (argparse has no other list of its options)
        if "--url" in action.option_strings:
            return True
        if isinstance(action.choices, dict) and any(map(_takes_url, action.choices.values())):
            return True
    return False


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
