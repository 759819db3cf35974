"""`mav watch`: the messages of links and recordings, as a live display, as lines, or as a summary."""

from __future__ import annotations

import sys
from enum import Enum, auto
from functools import partial
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.ending_signals import run_until_signal
from mavstack.cli.common.errors import UsageError
from mavstack.cli.common.link_options import add_link_options
from mavstack.cli.common.options import add_dialect_option, message_ids, seconds, system_id
from mavstack.cli.common.output import echo, echo_json, terminal_width
from mavstack.cli.watch.observer import Selection
from mavstack.cli.watch.packet_lines import json_line, text_line
from mavstack.cli.watch.recording import STDIN, read_recording
from mavstack.cli.watch.sources import open_sources, take_picture, take_summary
from mavstack.cli.watch.summary import summary_text
from mavstack.dialects.lookup import find_dialect
from mavstack.errors import LogError

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Callable, Sequence

    from mavstack.cli.watch.live_table import LiveTable
    from mavstack.cli.watch.observation import Observation
    from mavstack.cli.watch.sources import WatchedSource
    from mavstack.cli.watch.trend import FieldPatterns
    from mavstack.dialects import Dialect
    from mavstack.wire import Packet

EXAMPLES: Final = """\
examples:
  mav watch udpin://0.0.0.0:14550              # live display of UDP port 14550
  mav watch /dev/ttyACM0,57600 --sort rate     # of a serial port, the highest rate first
  mav watch /dev/ttyACM0,57600 udpin://0.0.0.0:14550       # two links, compared in one display
  mav watch udpin://0.0.0.0:14550 --trend ATTITUDE.roll    # with the course of a field
  mav watch udpin://0.0.0.0:14550 --tui        # choose messages, fields and plots in a window
  mav watch udpin://0.0.0.0:14550 --record new.tlog        # and record all packets
  mav watch udpin://0.0.0.0:14550 --json       # one JSON object per packet, until Ctrl-C
  mav watch tcp:127.0.0.1:5760 --once          # a summary of 3 s
  mav watch flight.tlog                        # a summary of a recording
  mav watch flight.tlog --once --json          # the summary as one JSON object
  mav watch flight.tlog --speed 10             # replay a recording, ten times as fast
  mav watch flight.tlog --to udpout://127.0.0.1:14550   # replay it for a ground station
  mav watch fleet.tlog --to 'udpout://127.0.0.1:1455{system}'   # each vehicle onto a link of its own
  mav watch flight.tlog --json --filter 'GPS*,ATTITUDE' --system 1 | head

In a pipe, without --once and --json, a link gives one line of text per packet. Keys and passwords are never
shown, and blanked in a recording.
"""

_TO_HELP: Final = (
    "replay a recording onto this link, as fast as recorded or --speed; with {system} in the URL each "
    "vehicle has a link of its own"
)
#: Seconds of a link's traffic that a summary covers.
_SUMMARY_DURATION: Final = 3.0


class Mode(Enum):
    """The form of the output."""

    SUMMARY = auto()
    LINES = auto()
    LIVE = auto()
    WINDOW = auto()


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments."""
    parser.set_defaults(run_action=run)
    add = parser.add_argument
    add(
        "sources",
        nargs="+",
        metavar="URL|FILE",
        help="link, tlog, file of raw packets, or - for standard input; several are shown together",
    )
    add("--json", action="store_true", help="print one JSON object per packet; with --once, one summary")
    add("--once", action="store_true", help="print a summary (of a link: after 3 s, or --for)")
    add(
        "--for",
        dest="seconds",
        type=seconds,
        metavar="SECONDS",
        help="end after this time; of a file, after this recorded time",
    )
    add("--tui", action="store_true", help="inspect messages, fields and plots in a window on the terminal")
    add("--filter", metavar="NAME,…", help="only these messages: names, patterns (GPS*) or ids")
    add("--system", type=system_id, metavar="ID", help="only this system")
    add("--sort", choices=("name", "rate", "count"), default="name", help="order of the live display")
    add(
        "--trend",
        metavar="MESSAGE[.FIELD],…",
        help="show the course of these fields in the live display; * is a wildcard",
    )
    add("--heartbeat", action="store_true", help="send the HEARTBEAT of a ground station")
    add("--record", metavar="FILE", help="write all packets of the links to a new tlog")
    add("--speed", metavar="X", help="replay a tlog X times as fast as recorded, or max")
    add("--to", metavar="URL", help=_TO_HELP)
    add_link_options(parser.add_argument_group("links"))
    add_dialect_option(parser)
    parser.set_defaults(command="watch")


def run(arguments: Namespace) -> int:
    """Run `mav watch`."""
    dialect = find_dialect(arguments.dialect)
    ids = message_ids(dialect, arguments.filter) if arguments.filter else None
    mode = _mode(arguments)
    patterns = _patterns(arguments, dialect, mode)
    sources = open_sources(arguments.sources, dialect, Selection(ids, arguments.system))
    if mode is Mode.WINDOW:
        return _inspect(sources, arguments, patterns)
    if _is_read(sources, arguments):
        return _read_files(sources, arguments)
    return run_until_signal(_follow_links(sources, arguments, mode, patterns))


def _mode(arguments: Namespace) -> Mode:
    if arguments.tui:
        if arguments.once or arguments.json:
            raise UsageError("--tui shows a window in the terminal: leave out --once and --json")
        return Mode.WINDOW
    if arguments.once:
        return Mode.SUMMARY
    return Mode.LINES if arguments.json or not sys.stdout.isatty() else Mode.LIVE


def _patterns(arguments: Namespace, dialect: Dialect, mode: Mode) -> FieldPatterns | None:
    if arguments.trend is None:
        return None
    if mode not in (Mode.LIVE, Mode.WINDOW):
        raise UsageError("--trend needs the live display: a terminal, without --once and --json")
    from mavstack.cli.watch.trend import FieldPatterns

    return FieldPatterns(arguments.trend, dialect)


def _inspect(sources: Sequence[WatchedSource], arguments: Namespace, patterns: FieldPatterns | None) -> int:
    """Open the window; recordings are replayed as fast as recorded, or `--speed`."""
    if any(source.path is not None for source in sources):
        arguments.speed = arguments.speed or "1"
    _is_read(sources, arguments)
    from mavstack.cli.watch.inspector.running import inspect_sources

    return run_until_signal(inspect_sources(sources, arguments, patterns))


def _is_read(sources: Sequence[WatchedSource], arguments: Namespace) -> bool:
    """Return whether the sources are files to read, not links; refuse options that do not fit."""
    files = [source for source in sources if source.path is not None]
    if arguments.to is not None and (len(sources) > 1 or not files or files[0].path == STDIN):
        raise UsageError("--to replays one recording: mav watch FILE --to URL")
    if len(files) == len(sources) and arguments.speed is None and arguments.to is None:
        if arguments.record is not None:
            raise UsageError(f"--record records links, and {files[0].text} is a recording")
        if arguments.signing_key is None:
            return True
        # replay the file: a replay checks each signature against the time of its packet
        arguments.speed = "max"
    if any(source.path == STDIN for source in files):
        raise UsageError("standard input is read as a file: without links, --key, --speed and --to")
    for source in files:
        source.path = None
    return False


# files


def _read_files(sources: Sequence[WatchedSource], arguments: Namespace) -> int:
    summary = arguments.once or (not arguments.json and sys.stdout.isatty())
    for source in sources:
        path = source.path or ""
        show = None if summary else partial(_print_recorded, _printer(arguments, source))
        read_recording(path, source.observer, show, arguments.seconds)
    if summary:
        print_summary(sources, arguments)
    # A JSON summary with zero packets is not an error; in all other cases a file without packets is one.
    empty = [source for source in sources if not source.observer.totals().packets]
    if empty and not (arguments.once and arguments.json):
        raise LogError(f"{empty[0].title}: it contains no MAVLink packet")
    return 0


def _print_recorded(
    show: Callable[[Sequence[Packet], float | None], None], packets: Sequence[Packet]
) -> None:
    for packet in packets:
        show([packet], None if packet.timestamp is None else packet.timestamp / 1e6)


# links


async def _follow_links(
    sources: Sequence[WatchedSource], arguments: Namespace, mode: Mode, patterns: FieldPatterns | None
) -> int:
    from mavstack.cli.watch.observation import follow_sources

    if mode is Mode.LINES:
        for source in sources:
            source.follower.show = _printer(arguments, source)
    is_limited = mode is Mode.SUMMARY and arguments.to is None
    duration = arguments.seconds or (_SUMMARY_DURATION if is_limited else None)

    def display(observation: Observation) -> LiveTable:
        from mavstack.cli.watch.live_table import LiveTable
        from mavstack.cli.watch.trend import Trends

        trends = None if patterns is None else Trends(patterns)
        return LiveTable(sources, arguments.sort, trends, lambda: observation.activity)

    await follow_sources(
        sources,
        arguments,
        duration,
        display if mode is Mode.LIVE else None,
        (lambda: print_summary(sources, arguments)) if mode is Mode.SUMMARY else None,
    )
    return 0


# output of files and links


def print_summary(sources: Sequence[WatchedSource], arguments: Namespace) -> None:
    """Print the summary as text or, with `--json`, as JSON."""
    if arguments.json:
        echo_json(take_summary(sources))
    else:
        echo(*summary_text(take_picture(sources), _terminal_columns()).split("\n"))


def _terminal_columns() -> int | None:
    """Return the width of the terminal; None in a pipe."""
    return terminal_width() if sys.stdout.isatty() else None


def _printer(arguments: Namespace, source: WatchedSource) -> Callable[[Sequence[Packet], float | None], None]:
    title = source.title if source.label else ""

    def show(packets: Sequence[Packet], time: float | None) -> None:
        if arguments.json:
            lines = [json_line(packet, time, title) for packet in packets]
        else:
            lines = [text_line(packet, time, source.label) for packet in packets]
        echo(*lines, flush=False)

    return show
