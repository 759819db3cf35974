"""`mav`: finds the subcommand, runs it, and turns how it ended into an exit code.

A subcommand is a module with `EXAMPLES`, `add_arguments(parser)` and `run(arguments) -> int`; it is imported
when it is asked for, so that `mav --help` loads none of them. Exit codes: 0 success, 1 a failure told in one
line on stderr, 2 wrong usage, 130 ended by Ctrl-C. A reader that closes the pipe (`mav … | head`) has what
it wanted: that is no failure.
"""

from __future__ import annotations

import os
import sys
from argparse import ArgumentParser, RawDescriptionHelpFormatter
from contextlib import suppress
from difflib import get_close_matches
from importlib import import_module
from types import MappingProxyType
from typing import TYPE_CHECKING, Final, NamedTuple, Protocol, cast

from mavstack import __version__
from mavstack.cli.common.usage_error import UsageError
from mavstack.errors import LinkURLError, MavstackError, UnknownDialectError

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Mapping, Sequence

INTERRUPTED = 130


class Entry(NamedTuple):
    """A subcommand: where it is, and one line about it."""

    module: str
    summary: str


class Command(Protocol):
    """What the module of a subcommand offers."""

    EXAMPLES: str

    def add_arguments(self, parser: ArgumentParser) -> None:
        """Declare what follows the subcommand's name."""

    def run(self, arguments: Namespace) -> int:
        """Do it; the exit code."""


COMMANDS: Final[Mapping[str, Entry]] = MappingProxyType(
    {
        "sim": Entry(
            "mavstack.cli.sim.command", "simulated vehicles that any ground station or script can fly"
        ),
        "demo": Entry(
            "mavstack.cli.demo.command", "a simulated fleet and its live picture, with no hardware"
        ),
        "watch": Entry(
            "mavstack.cli.watch.command", "live messages of a link or a file: rates, values, link quality"
        ),
        "vehicle": Entry(
            "mavstack.cli.vehicle.command", "one thing asked of a vehicle: arm, takeoff, goto, mode, info …"
        ),
        "param": Entry(
            "mavstack.cli.param.command", "a vehicle's parameters: list, get, set, save, load, diff"
        ),
        "mission": Entry(
            "mavstack.cli.mission.command",
            "missions, fences, rally points: upload, download, show, convert, start",
        ),
        "ftp": Entry(
            "mavstack.cli.ftp.command", "the files on a vehicle: ls, get, put, rm, mkdir, rename, crc"
        ),
        "log": Entry("mavstack.cli.log.command", "the logs on a vehicle: list, get, erase"),
        "shell": Entry(
            "mavstack.cli.shell.command",
            "interactive console: mode, arm, takeoff, wp, param, fence, ftp, log …",
        ),
        "dialect": Entry(
            "mavstack.cli.dialect.command", "list, show, check, compare and import message definitions"
        ),
        "doctor": Entry("mavstack.cli.doctor.command", "what is installed and working"),
    }
)

_HELP = """\
Mavstack: the whole MAVLink system as one Python package.

usage: mav COMMAND …

{commands}

`mav COMMAND --help` tells more about one, with examples; `mav --version` tells the version.

examples:
  mav demo
  mav sim
  mav vehicle info --url udpin://0.0.0.0:14550
  mav shell udpin://0.0.0.0:14550
  mav watch flight.tlog --once
  mav dialect show common ATTITUDE
"""


def main(argv: Sequence[str] | None = None) -> int:
    """Run `mav` with the given arguments, or those of the process; the exit code."""
    words = sys.argv[1:] if argv is None else list(argv)
    for stream in (sys.stdout, sys.stderr):
        with suppress(AttributeError):  # a captured stream may be anything
            stream.reconfigure(errors="replace")  # type: ignore[union-attr]
    try:
        code = _dispatch(words)
        sys.stdout.flush()
    except KeyboardInterrupt:
        code = INTERRUPTED
    except BrokenPipeError:
        _abandon_stdout()
        code = 0
    except (UsageError, LinkURLError, UnknownDialectError) as error:
        code = _fail(words, str(error), 2)
    except MavstackError as error:
        code = _fail(words, str(error), 1)
    except OSError as error:
        where = f"{error.filename}: " if error.filename else ""
        code = _fail(words, f"{where}{error.strerror or error}", 1)
    return code


def _dispatch(words: Sequence[str]) -> int:
    first, *rest = words or ("--help",)
    if first in ("-h", "--help", "help"):
        print(_help_text(), end="")
        return 0
    if first in ("-V", "--version"):
        print(f"mavstack {__version__}")
        return 0
    if first not in COMMANDS:
        raise UsageError(_unknown(first))
    return _run(first, rest)


def _run(name: str, words: Sequence[str]) -> int:
    entry = COMMANDS[name]
    module = cast("Command", import_module(entry.module))
    parser = ArgumentParser(
        prog=f"mav {name}",
        description=entry.summary[0].upper() + entry.summary[1:] + ".",
        epilog=module.EXAMPLES,
        formatter_class=RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    module.add_arguments(parser)
    try:
        arguments = parser.parse_args(words)
    except SystemExit as leaving:  # argparse has printed its help, or what is wrong
        return leaving.code if isinstance(leaving.code, int) else 0
    return module.run(arguments)


def _help_text() -> str:
    width = max(map(len, COMMANDS))
    return _HELP.format(
        commands="\n".join(f"  {name:{width}}  {entry.summary}" for name, entry in COMMANDS.items())
    )


def _unknown(name: str) -> str:
    if name.startswith("-"):
        return f"there is no option {name}; try mav --help"
    near = get_close_matches(name, COMMANDS, n=1)
    return f"there is no command {name!r}; " + (f"did you mean {near[0]}?" if near else "try mav --help")


def _fail(words: Sequence[str], problem: str, code: int) -> int:
    name = f"mav {words[0]}" if words and words[0] in COMMANDS else "mav"
    print(f"{name}: {' '.join(problem.split())}", file=sys.stderr)
    return code


def _abandon_stdout() -> None:
    """Let the interpreter's last flush go nowhere: the reader is gone."""
    with suppress(OSError, ValueError, AttributeError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, sys.stdout.fileno())
        os.close(nowhere)
