"""How commands reach a vehicle: `--url`, `--system`, `--timeout`, and what is done with it.

The URL is taken from MAVSTACK_URL where it is not given, so that a session of commands names it once. A
command waits for the vehicle's first heartbeat, does its work, and leaves; what fails is told in one line.

Where a vehicle is at hand already, as in `mav shell`, the same commands are parsed by `AtHand`: no connection
is offered, and their work is handed over instead of being done on a connection of its own.
"""

from __future__ import annotations

import asyncio
import os
from argparse import ArgumentParser
from typing import TYPE_CHECKING, NoReturn

from mavstack.cli.common.options import seconds, system_id
from mavstack.cli.common.usage_error import UsageError
from mavstack.vehicle import connect

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Awaitable, Callable

    from mavstack.vehicle import Connection, Vehicle

DEFAULT_URL = "udpin://0.0.0.0:14550"
#: How long to wait for a first heartbeat, in seconds.
PATIENCE = 10.0


class AtHand(ArgumentParser):
    """Parses the words of a command for a vehicle that is at hand; `hand_over` is given the work.

    What is wrong with the words is raised, and ends nothing but the command.
    """

    def error(self, message: str) -> NoReturn:
        """Say what is wrong."""
        raise UsageError(message)


def add_connection(parser: ArgumentParser) -> None:
    """Offer what says which vehicle is meant, and how long to wait for it."""
    if isinstance(parser, AtHand):
        return
    group = parser.add_argument_group("the vehicle")
    group.add_argument(
        "--url",
        action="append",
        metavar="URL",
        help=f"where it is heard; may be given several times (default: $MAVSTACK_URL or {DEFAULT_URL})",
    )
    group.add_argument(
        "--system", type=system_id, metavar="ID", help="its system id (default: the first vehicle heard)"
    )
    group.add_argument(
        "--timeout",
        type=seconds,
        default=PATIENCE,
        metavar="SECONDS",
        help=f"how long to wait for its first heartbeat (default: {PATIENCE:g})",
    )


def urls_of(arguments: Namespace) -> list[str]:
    """The URLs to connect to."""
    return arguments.url or [os.environ.get("MAVSTACK_URL") or DEFAULT_URL]


def on_vehicle(arguments: Namespace, work: Callable[[Vehicle], Awaitable[int]]) -> int:
    """Connect, wait for the vehicle, do the work; the exit code that it gives."""
    hand_over = getattr(arguments, "hand_over", None)
    if hand_over is not None:
        hand_over(work)
        return 0

    async def whole(node: Connection) -> int:
        return await work(await node.wait_for_vehicle(arguments.system, timeout=arguments.timeout))

    return on_connection(arguments, whole)


def on_connection(arguments: Namespace, work: Callable[[Connection], Awaitable[int]]) -> int:
    """Connect and do the work; the exit code that it gives."""

    async def whole() -> int:
        async with connect(*urls_of(arguments)) as node:
            return await work(node)

    return asyncio.run(whole())
