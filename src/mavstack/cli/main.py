"""The entry point of `mav`: runs a command and turns its outcome into an exit code.

Exit codes: 0 success, 1 a failure told in one line on stderr, 2 wrong usage, 130 ended by Ctrl-C. A reader
that closes the pipe (`mav … | head`) has read enough: that is no failure.
"""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from typing import TYPE_CHECKING, Final

from mavstack import __version__
from mavstack.cli.common.errors import UsageError, failure_text
from mavstack.cli.common.log_output import logging_to_outputs, warnings_as_lines
from mavstack.cli.common.output import echo, echo_text
from mavstack.cli.registry import COMMANDS, command_parser
from mavstack.errors import LinkURLError, MavstackError, UnknownDialectError

if TYPE_CHECKING:
    from collections.abc import Sequence

EXIT_INTERRUPTED: Final = 130

_HELP = """\
Mavstack: the whole MAVLink system as one Python package.

usage: mav COMMAND …

{commands}

`mav COMMAND --help` shows options and examples, `mav --version` the version.
Every command takes -v (-vv: debug) for a log on stderr, and --log-file FILE.

examples:
  mav demo
  mav sim
  mav vehicle info --url udpin://0.0.0.0:14550
  mav shell udpin://0.0.0.0:14550
  mav watch flight.tlog --once
  mav dialect show common ATTITUDE
"""


def main(argv: Sequence[str] | None = None) -> int:
    """Run `mav`.

    Args:
        argv: The words after `mav`; None takes those of the process.

    Returns:
        The exit code.
    """
    words = sys.argv[1:] if argv is None else list(argv)
    for stream in (sys.stdout, sys.stderr):
        with suppress(AttributeError):  # a stream that replaces stdout may lack `reconfigure`
            stream.reconfigure(errors="replace")  # type: ignore[union-attr]
    try:
        code = _dispatch(words)
        sys.stdout.flush()
    except KeyboardInterrupt:
        code = EXIT_INTERRUPTED
    except BrokenPipeError:
        _abandon_stdout()
        code = 0
    except (UsageError, LinkURLError, UnknownDialectError) as error:
        code = _fail(words, failure_text(error), 2)
    except MavstackError as error:
        code = _fail(words, failure_text(error), 1)
    except OSError as error:
        where = f"{error.filename}: " if error.filename else ""
        code = _fail(words, f"{where}{error.strerror or failure_text(error)}", 1)
    return code


def _dispatch(words: Sequence[str]) -> int:
    first, *rest = words or ("--help",)
    if first in ("-h", "--help", "help"):
        echo_text(_help_text())
        return 0
    if first in ("-V", "--version"):
        echo(f"mavstack {__version__}")
        return 0
    if first not in COMMANDS:
        raise UsageError(_unknown(first))
    return _run(first, rest)


def _run(name: str, words: Sequence[str]) -> int:
    parser = command_parser(name)
    parse = parser.parse_intermixed_args if COMMANDS[name].mixed else parser.parse_args
    try:
        arguments = parse(words)
    except SystemExit as leaving:  # argparse has printed its help or the error
        return leaving.code if isinstance(leaving.code, int) else 0
    with logging_to_outputs(arguments, quiet=not COMMANDS[name].logs), warnings_as_lines(f"mav {name}"):
        code: int = arguments.run_action(arguments)
        return code


def _help_text() -> str:
    width = max(map(len, COMMANDS))
    return _HELP.format(
        commands="\n".join(f"  {name:{width}}  {entry.summary}" for name, entry in COMMANDS.items())
    )


def _unknown(name: str) -> str:
    if name.startswith("-"):
        return f"there is no option {name}; try mav --help"
    from difflib import get_close_matches

    near = get_close_matches(name, COMMANDS, n=1)
    return f"there is no command {name!r}; " + (f"did you mean {near[0]}?" if near else "try mav --help")


def _fail(words: Sequence[str], problem: str, code: int) -> int:
    name = f"mav {words[0]}" if words and words[0] in COMMANDS else "mav"
    echo(f"{name}: {problem}", error=True)
    return code


def _abandon_stdout() -> None:
    """Redirect stdout to the null device: the interpreter flushes it at exit, and the reader is gone."""
    with suppress(OSError, ValueError, AttributeError):
        null = os.open(os.devnull, os.O_WRONLY)
        os.dup2(null, sys.stdout.fileno())
        os.close(null)
