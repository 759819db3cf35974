"""`mav watch`: the messages of a link or a recording, as a live display, as lines, or as a summary."""

from __future__ import annotations

import asyncio
import sys
from enum import Enum, auto
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.exposure import announce_exposure
from mavstack.cli.common.options import add_dialect_option, load_dialect, message_ids, seconds, system_id
from mavstack.cli.common.output import echo
from mavstack.cli.watch.observer import Observer, Selection
from mavstack.cli.watch.packet_lines import json_line, text_line
from mavstack.cli.watch.recording import STDIN, read_recording
from mavstack.cli.watch.snapshot import take_snapshot
from mavstack.cli.watch.summary import summary_json, summary_text
from mavstack.errors import LinkError, LinkURLError, LogError

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Callable, Sequence

    from mavstack.cli.watch.follower import Follower
    from mavstack.links import Link
    from mavstack.wire import Packet

EXAMPLES: Final = """\
examples:
  mav watch udpin://0.0.0.0:14550              # live display of UDP port 14550
  mav watch /dev/ttyACM0,57600 --sort rate     # of a serial port, the highest rate first
  mav watch udpin://0.0.0.0:14550 --json       # one JSON object per packet, until Ctrl-C
  mav watch tcp:127.0.0.1:5760 --once          # a summary of 3 s
  mav watch flight.tlog                        # a summary of a recording
  mav watch flight.tlog --once --json          # the summary as one JSON object
  mav watch flight.tlog --speed 10             # replay a recording, ten times as fast
  mav watch flight.tlog --json --filter 'GPS*,ATTITUDE' --system 1 | head

In a pipe, without --once and --json, a link gives one line of text per packet. Keys and passwords are never
shown.
"""

#: Seconds of a link that a summary covers.
_SUMMARY_DURATION: Final = 3.0


class Mode(Enum):
    """The form of the output."""

    SUMMARY = auto()
    LINES = auto()
    LIVE = auto()


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument(
        "source", metavar="URL|FILE", help="link, tlog, file of raw packets, or - for standard input"
    )
    parser.add_argument(
        "--json", action="store_true", help="print one JSON object per packet; with --once, one summary"
    )
    parser.add_argument(
        "--once", action="store_true", help="print a summary (of a link: after 3 s, or --for)"
    )
    parser.add_argument(
        "--for",
        dest="seconds",
        type=seconds,
        metavar="SECONDS",
        help="end after this time; of a file, after this recorded time",
    )
    parser.add_argument(
        "--filter", metavar="NAME,…", help="only these messages: names, patterns (GPS*) or ids"
    )
    parser.add_argument("--system", type=system_id, metavar="ID", help="only this system")
    parser.add_argument(
        "--sort", choices=("name", "rate", "count"), default="name", help="order of the live display"
    )
    parser.add_argument("--speed", metavar="X", help="replay a tlog X times as fast as recorded, or max")
    parser.add_argument(
        "--heartbeat", action="store_true", help="send the HEARTBEAT of a ground station at 1 Hz"
    )
    add_dialect_option(parser)


def run(arguments: Namespace) -> int:
    """Run `mav watch`."""
    dialect = load_dialect(arguments.dialect)
    ids = message_ids(dialect, arguments.filter) if arguments.filter else None
    observer = Observer(dialect, Selection(ids, arguments.system))
    path = recording_path(arguments.source)
    if path is not None and arguments.speed is None:
        return _watch_file(path, observer, arguments)
    return asyncio.run(_watch_link(observer, arguments))


def recording_path(source: str) -> str | None:
    """Return the path of a source that is a file to read; None for a link to follow."""
    if source == STDIN or Path(source).is_file():
        return source
    from mavstack.links import parse_url

    try:
        url = parse_url(source)
    except LinkURLError:
        if "://" not in source and Path(source).exists():
            raise LogError(f"{source}: it is not a file") from None
        return None
    return url.path if url.scheme == "file" and not url.options else None


# files


def _watch_file(path: str, observer: Observer, arguments: Namespace) -> int:
    if arguments.once or (not arguments.json and sys.stdout.isatty()):
        read_recording(path, observer, None, arguments.seconds)
        print_summary(observer, arguments, path, observer.recorded_seconds)
    else:
        line = json_line if arguments.json else text_line

        def show(packets: Sequence[Packet]) -> None:
            echo(*(line(packet, _recorded(packet)) for packet in packets), flush=False)

        read_recording(path, observer, show, arguments.seconds)
    # The JSON summary itself shows that there are no packets; in all other cases this is a failure.
    if not observer.totals().packets and not (arguments.once and arguments.json):
        raise LogError(f"{path}: it contains no MAVLink packet")
    return 0


def _recorded(packet: Packet) -> float | None:
    return None if packet.timestamp is None else packet.timestamp / 1e6


# links


async def _watch_link(observer: Observer, arguments: Namespace) -> int:
    from mavstack.cli.watch.follower import Follower
    from mavstack.links import open_link

    mode = _mode(arguments)
    options = {} if arguments.speed is None else {"speed": arguments.speed}
    duration = arguments.seconds or (_SUMMARY_DURATION if mode is Mode.SUMMARY else None)
    link = open_link(arguments.source, **options)
    follower = Follower(observer, _printer(arguments) if mode is Mode.LINES else None)
    async with link:
        announce_exposure("watch", [link])
        await follow_link(link, follower, arguments, duration, link.url.redacted)
    if mode is Mode.SUMMARY:
        print_summary(observer, arguments, link.url.redacted, follower.seconds, follower.note)
    _require_packets(follower, link)
    return 0


async def follow_link(
    link: Link, follower: Follower, arguments: Namespace, duration: float | None, title: str
) -> None:
    """Follow an open link for `duration` seconds, None until it ends, with the live display if wanted."""
    from mavstack.cli.watch.follower import background_tasks, send_heartbeats

    jobs = [send_heartbeats(link)] if arguments.heartbeat else []
    if _mode(arguments) is not Mode.LIVE:
        async with background_tasks(*jobs):
            await follower.follow(link, duration)
        return
    from mavstack.cli.watch.live_table import LiveTable

    with LiveTable(title, follower, arguments.sort) as table:
        async with background_tasks(*jobs, table.run()):
            await follower.follow(link, duration)


def _mode(arguments: Namespace) -> Mode:
    if arguments.once:
        return Mode.SUMMARY
    return Mode.LINES if arguments.json or not sys.stdout.isatty() else Mode.LIVE


def _require_packets(follower: Follower, link: Link) -> None:
    if follower.observer.totals().packets:
        return
    waited = f"in {follower.seconds:.1f} s"
    if follower.bytes:
        problem = f"{follower.bytes} bytes received {waited}, but no MAVLink packet"
        raise LinkError(
            f"{link.url.redacted}: {problem}; check that the sender uses MAVLink, and the baud rate"
        )
    hint = f"; {follower.note}" if follower.note else "; some vehicles send only after --heartbeat"
    raise LinkError(f"{link.url.redacted}: no data received {waited}{hint}")


# output of files and links


def print_summary(
    observer: Observer, arguments: Namespace, title: str, duration: float | None, note: str = ""
) -> None:
    """Print the summary as text or, with `--json`, as JSON."""
    if arguments.json:
        echo(summary_json(observer, duration))
        return
    snapshot = take_snapshot(observer, title, monotonic(), duration, note)
    echo(*summary_text(snapshot, _terminal_columns()).split("\n"))


def _terminal_columns() -> int | None:
    """Return the width of the terminal; None in a pipe."""
    if not sys.stdout.isatty():
        return None
    from shutil import get_terminal_size

    return get_terminal_size().columns


def _printer(arguments: Namespace) -> Callable[[Sequence[Packet], float], None]:
    line = json_line if arguments.json else text_line

    def show(packets: Sequence[Packet], time: float) -> None:
        echo(*(line(packet, time) for packet in packets), flush=False)

    return show
