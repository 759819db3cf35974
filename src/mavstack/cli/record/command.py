"""`mav record`: the packets of links to a file that survives a crash."""

from __future__ import annotations

from argparse import ArgumentTypeError
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.ending_signals import run_until_signal
from mavstack.cli.common.errors import UsageError
from mavstack.cli.common.link_options import add_link_options
from mavstack.cli.common.options import add_dialect_option, byte_size, message_ids, seconds, system_id
from mavstack.cli.record.observer import RecordingObserver
from mavstack.cli.record.status import RecordingStatus
from mavstack.cli.watch.observation import follow_sources
from mavstack.cli.watch.observer import Selection
from mavstack.cli.watch.sources import open_sources
from mavstack.dialects.lookup import find_dialect

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

EXAMPLES: Final = """\
examples:
  mav record udpin://0.0.0.0:14550 flight.tlog
  mav record /dev/ttyACM0,57600 udpin://0.0.0.0:14550 flight.tlog   # two links, one file
  mav record udpin://0.0.0.0:14550 flight.tlog --for 60
  mav record tcp:127.0.0.1:5760 flight.tlog --heartbeat   # for a vehicle that waits for a ground station
  mav record udpin://0.0.0.0:14550 logs/flight.tlog --max-size 100M --keep 20
  mav record udpin://0.0.0.0:14550 flight.tlog --max-time 600
  mav record udpin://0.0.0.0:14550 flight.pcap            # for Wireshark
  mav record udpin://0.0.0.0:14550 - --format pcap | wireshark -k -i -

A packet is in the file as soon as it was received: a recorder that is killed loses none, and a loss of power
costs at most the last second. An existing file is never overwritten. With --max-size and --max-time the files
have numbers: flight-0001.tlog, flight-0002.tlog … Signatures are removed, passwords blanked, SETUP_SIGNING,
which carries a signing key, is left out. Ctrl-C ends the recording.
"""


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments."""
    parser.set_defaults(run_action=run)
    add = parser.add_argument
    add("sources", nargs="+", metavar="URL", help="link to record; several are recorded into one file")
    add("record", metavar="FILE", help="new tlog or .pcap; - for standard output")
    add("--format", choices=("tlog", "pcap"), help="format of the file (default: by its name, else tlog)")
    add("--for", dest="seconds", type=seconds, metavar="SECONDS", help="end after this time")
    add("--max-size", type=byte_size, metavar="BYTES", help="begin a new file before this size, such as 100M")
    add(
        "--max-time",
        dest="max_duration",
        type=seconds,
        metavar="SECONDS",
        help="begin a new file after this time",
    )
    add("--keep", type=_count, metavar="N", help="keep only the newest N numbered files")
    add("--filter", metavar="NAME,…", help="only these messages: names, patterns (GPS*) or ids")
    add("--system", type=system_id, metavar="ID", help="only this system")
    add("--heartbeat", action="store_true", help="send the HEARTBEAT of a ground station")
    add_link_options(parser.add_argument_group("links"))
    add_dialect_option(parser)
    parser.set_defaults(command="record", speed=None, to=None)


def run(arguments: Namespace) -> int:
    """Run `mav record`."""
    if arguments.keep is not None and arguments.max_size is None and arguments.max_duration is None:
        raise UsageError("--keep needs --max-size or --max-time")
    dialect = find_dialect(arguments.dialect)
    ids = message_ids(dialect, arguments.filter) if arguments.filter else None
    sources = open_sources(arguments.sources, dialect, Selection(ids, arguments.system), RecordingObserver)
    for source in sources:
        if source.path is not None:
            raise UsageError(f"{source.text} is a file; mav record records links")
    run_until_signal(follow_sources(sources, arguments, arguments.seconds, RecordingStatus))
    return 0


def _count(text: str) -> int:
    if not text.isdecimal() or int(text) < 1:
        raise ArgumentTypeError(f"{text!r} is not a number of files")
    return int(text)
