"""`mav demo`: a scripted vehicle that speaks over UDP on this machine, and the live picture of it."""

from __future__ import annotations

import asyncio
import sys
from time import monotonic
from typing import TYPE_CHECKING, Final

from mavstack.cli.failures import UsageError
from mavstack.cli.options import seconds
from mavstack.errors import LinkError, MissingExtraError

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

    from mavstack.cli.follow import Follower
    from mavstack.cli.scripted_vehicle import ScriptedVehicle

EXAMPLES: Final = """\
examples:
  mav demo                 the live picture, until Ctrl-C
  mav demo --for 30        for half a minute
  mav demo --for 5 | cat   five seconds, the whole flight in fast motion, then a summary
  mav demo --once --json   the same as one JSON object

In another terminal, while `mav demo --out udpout://127.0.0.1:14550` runs:
  mav watch udpin://127.0.0.1:14550
"""

_SHORT: Final = 5.0
_TICK: Final = 0.01


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("--for", dest="seconds", type=seconds, metavar="SECONDS", help="end after so long")
    parser.add_argument(
        "--once", action="store_true", help="a summary at the end instead of the live picture"
    )
    parser.add_argument("--json", action="store_true", help="the summary as one JSON object")
    parser.add_argument("--out", metavar="URL", help="send to this link, and show nothing")
    parser.add_argument(
        "--sort", choices=("name", "rate", "count"), default="name", help="order of the live picture"
    )


def run(arguments: Namespace) -> int:
    """Fly."""
    arguments.heartbeat = False
    if arguments.out and (arguments.once or arguments.json):
        raise UsageError("--out shows nothing, so that --once and --json make no sense with it")
    return asyncio.run(_send_only(arguments) if arguments.out else _demo(arguments))


async def _demo(arguments: Namespace) -> int:
    from mavstack.cli.follow import Follower, beside
    from mavstack.cli.observer import Observer
    from mavstack.cli.scripted_vehicle import END, ScriptedVehicle
    from mavstack.cli.watch import follow_link, print_summary
    from mavstack.dialects import Dialect
    from mavstack.links import open_link

    _prefer_summary(arguments)
    limit = arguments.seconds or (_SHORT if arguments.once else None)
    # A summary of a few seconds is to tell of a whole flight.
    vehicle = ScriptedVehicle(max(END / limit, 1.0) if arguments.once and limit else 1.0)
    follower = Follower(Observer(Dialect.load("all")))
    async with open_link("udpin://127.0.0.1:0") as link:
        host, port = link.address or ("127.0.0.1", 0)
        title = f"a scripted vehicle on udpin://{host}:{port}"
        async with beside(_fly(vehicle, f"udpout://{host}:{port}")):
            await follow_link(link, follower, arguments, limit, title)
    if arguments.once:
        print_summary(follower.observer, arguments, title, follower.seconds)
    _require_packets(follower)
    return 0


def _prefer_summary(arguments: Namespace) -> None:
    """A summary where no live picture can be shown: in a pipe, or without the library that draws it."""
    if arguments.json or not sys.stdout.isatty():
        arguments.once = True
    if arguments.once:
        return
    try:
        import mavstack.cli.live_table  # noqa: F401
    except MissingExtraError as error:
        print(f"mav demo: {error}", file=sys.stderr)
        arguments.once = True


async def _send_only(arguments: Namespace) -> int:
    from mavstack.cli.scripted_vehicle import ScriptedVehicle

    try:
        async with asyncio.timeout(arguments.seconds) as limit:
            await _fly(ScriptedVehicle(), arguments.out)
    except TimeoutError:
        if not limit.expired():
            raise
    return 0


async def _fly(vehicle: ScriptedVehicle, url: str) -> None:
    """Send what the vehicle says, to all peers."""
    from mavstack.links import open_link
    from mavstack.wire import Encoder

    encoder = Encoder(1, 1)
    async with open_link(url) as link:
        while True:
            for message in vehicle.due(monotonic()):
                data = encoder.encode(message)
                for channel in link.channels:
                    channel.write(data)
            await asyncio.sleep(_TICK)


def _require_packets(follower: Follower) -> None:
    if follower.observer.totals().packets:
        return
    waited = f"{follower.seconds:.1f} s"
    raise LinkError(f"nothing came over UDP on this machine in {waited}; mav doctor may tell why")
