"""The connection of a command to a vehicle: `--url`, `--system`, `--timeout`.

The URL comes from MAVSTACK_URL if it is not given, so that a session of commands names it once. A command
waits for the vehicle's first heartbeat, does its work, and closes the connection. A failure is told in one
line.

Inside `mav shell` the vehicle of the session is used: `SessionParser` offers no connection, and a command
hands its work over instead of connecting.
"""

from __future__ import annotations

import asyncio
import os
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.options import seconds, system_id
from mavstack.cli.common.session_parser import SessionParser
from mavstack.vehicle import connect

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace, _ActionsContainer
    from collections.abc import Awaitable, Callable

    from mavstack.cli.common.actions import Actions
    from mavstack.vehicle import Connection, Vehicle

DEFAULT_URL: Final = "udpin://0.0.0.0:14550"
#: Seconds that a command waits for the first heartbeat of its vehicle.
DEFAULT_HEARTBEAT_TIMEOUT: Final = 10.0


def add_connection_options(parser: ArgumentParser) -> None:
    """Declare the options that select the vehicle; none in a session."""
    if isinstance(parser, SessionParser):
        return
    group = parser.add_argument_group("vehicle")
    group.add_argument(
        "--url",
        action="append",
        metavar="URL",
        help=f"link to the vehicle; may be repeated (default: $MAVSTACK_URL or {DEFAULT_URL})",
    )
    group.add_argument(
        "--system", type=system_id, metavar="ID", help="system id (default: the first vehicle heard)"
    )
    add_heartbeat_timeout(group)


def add_heartbeat_timeout(group: _ActionsContainer) -> None:
    """Declare `--timeout`, the time to wait for the first heartbeat."""
    group.add_argument(
        "--timeout",
        type=seconds,
        default=DEFAULT_HEARTBEAT_TIMEOUT,
        metavar="SECONDS",
        help=f"wait this long for the vehicle's first heartbeat (default: {DEFAULT_HEARTBEAT_TIMEOUT:g})",
    )


def add_vehicle_action(
    actions: Actions, name: str, summary: str, run: Callable[[Namespace], int]
) -> ArgumentParser:
    """Add an action on a vehicle, with `--json` and the options that select the vehicle."""
    parser = actions.add(name, summary, run)
    parser.add_argument("--json", action="store_true", help="print JSON")
    add_connection_options(parser)
    return parser


def connection_urls(arguments: Namespace) -> list[str]:
    """Return the URLs to connect to."""
    return arguments.url or [os.environ.get("MAVSTACK_URL") or DEFAULT_URL]


def run_on_vehicle(arguments: Namespace, work: Callable[[Vehicle], Awaitable[int]]) -> int:
    """Connect, wait for the vehicle, run the work and return its exit code.

    In a session the work is handed to the session instead, and 0 is returned.
    """
    session_work = getattr(arguments, "session_work", None)
    if session_work is not None:
        session_work(work)
        return 0

    async def connected(connection: Connection) -> int:
        vehicle = await connection.wait_for_vehicle(arguments.system, timeout=arguments.timeout)
        return await work(vehicle)

    return run_on_connection(arguments, connected)


def run_on_connection(arguments: Namespace, work: Callable[[Connection], Awaitable[int]]) -> int:
    """Connect, run the work and return its exit code."""

    async def connected() -> int:
        async with connect(*connection_urls(arguments)) as connection:
            return await work(connection)

    return asyncio.run(connected())
