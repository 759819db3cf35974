"""The options with which the actions of `mav data` open logs, and the exit code about damage."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.cli.common.options import add_dialect_option, seconds_from_start, system_id
from mavstack.cli.common.output import echo
from mavstack.cli.data.remote import is_remote
from mavstack.dialects.lookup import find_dialect
from mavstack.logs import open_log

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

    from mavstack.logs import Log


def add_log_options(parser: ArgumentParser, *, several: bool = False) -> None:
    """Declare the file and the options that open it.

    Args:
        parser: Parser of the action.
        several: The action takes several files.
    """
    if several:
        parser.add_argument("files", nargs="+", metavar="FILE", help="logs of any format, or their URLs")
    else:
        parser.add_argument("file", metavar="FILE", help="log of any format, or its URL")
    parser.add_argument(
        "--format", metavar="NAME", help="format of the log (default: recognised by its content)"
    )
    parser.add_argument("--strict", action="store_true", help="fail (exit code 1) if anything was skipped")
    add_dialect_option(parser)


def add_raw_text(parser: ArgumentParser) -> None:
    """Declare the option that keeps texts in CSV as they are."""
    parser.add_argument(
        "--raw-text",
        action="store_true",
        help="keep texts in CSV that spreadsheets run as formulas (default: an apostrophe before them)",
    )


def add_selection_options(parser: ArgumentParser) -> None:
    """Declare the options that select rows."""
    group = parser.add_argument_group("selection")
    group.add_argument("--system", type=system_id, metavar="ID", help="only this system")
    group.add_argument(
        "--start", type=seconds_from_start, metavar="SECONDS", help="from this time after the beginning"
    )
    group.add_argument(
        "--end", type=seconds_from_start, metavar="SECONDS", help="until this time after the beginning"
    )


def open_file(path: str, arguments: Namespace) -> Log:
    """Open a log with the options of the command line, and the rows that they select."""
    log = open_log(local_file(path, arguments), find_dialect(arguments.dialect), format=arguments.format)
    system, start, end = (getattr(arguments, name, None) for name in ("system", "start", "end"))
    if system is None and start is None and end is None:
        return log
    return log.select(system=system, start=start, end=end)


def local_file(path: str, arguments: Namespace) -> str:
    """Return the path of a log; that of a URL is a copy, which is kept until the command ends."""
    if not is_remote(path):
        return path
    copy: str = arguments.copies.path_of(path)
    return copy


def name_of(log: Log, arguments: Namespace) -> str:
    """Return what the user called a log: its path or its URL."""
    name: str = arguments.copies.names.get(str(log.path), str(log.path))
    return name


def report_damage(log: Log, arguments: Namespace) -> int:
    """Tell on stderr what was skipped, and return the exit code."""
    damage = log.skipped
    if damage:
        echo(f"mav data: {name_of(log, arguments)}: skipped {damage.describe()}", error=True)
    return 1 if damage and arguments.strict else 0
