"""The connection of a command to a vehicle: `--url`, `--system`, `--timeout`, and the options of links.

The URL comes from MAVSTACK_URL if it is not given, so that a session of commands names it once. A command
waits for the vehicle's first heartbeat, does its work, and closes the connection. A failure is printed in one
line.

Inside `mav shell` the vehicle of the session is used: `SessionParser` offers no connection, and a command
hands its work over instead of connecting.
"""

from __future__ import annotations

import os
from functools import wraps
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.ending_signals import run_until_signal
from mavstack.cli.common.errors import failure_text
from mavstack.cli.common.exposure import announce_exposure
from mavstack.cli.common.link_options import add_link_options, with_link_options
from mavstack.cli.common.options import seconds
from mavstack.cli.common.output import echo
from mavstack.cli.common.selection import (
    add_system_option,
    mention_conflict,
    mention_other_vehicles,
    of_vehicle,
    selected_vehicles,
    selects_several,
)
from mavstack.cli.common.session_parser import SessionParser
from mavstack.errors import MavstackError
from mavstack.vehicle import connect

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace, _ActionsContainer
    from collections.abc import Awaitable, Callable

    from mavstack.cli.common.actions import Actions
    from mavstack.vehicle import Connection, Group, Vehicle

DEFAULT_URL: Final = "udpin://0.0.0.0:14550"
#: Seconds that a command waits for the first heartbeat of its vehicle.
DEFAULT_HEARTBEAT_TIMEOUT: Final = 10.0


def add_connection_options(parser: ArgumentParser, *, fleet: bool = False, changes: bool = False) -> None:
    """Declare the options that select the vehicle; none in a session.

    Args:
        parser: Parser of the action.
        fleet: The action works on several vehicles, with `--systems` and `--all`.
        changes: The action changes something on the vehicle.
    """
    parser.set_defaults(changes=changes)
    if isinstance(parser, SessionParser):
        return
    group = parser.add_argument_group("vehicle")
    group.add_argument(
        "--url",
        action="append",
        metavar="URL",
        help=f"link to the vehicle; may be repeated (default: $MAVSTACK_URL or {DEFAULT_URL})",
    )
    add_system_option(group, fleet=fleet, changes=changes)
    group.add_argument(
        "--channel",
        metavar="NAME|ADDRESS",
        help="use only the vehicle on this channel, such as 192.168.1.20:14550, where two have one system id",
    )
    add_heartbeat_timeout(group)
    add_link_options(parser.add_argument_group("links"))


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
    actions: Actions,
    name: str,
    summary: str,
    run: Callable[[Namespace], int],
    *,
    fleet: bool = False,
    changes: bool = False,
) -> ArgumentParser:
    """Add an action on a vehicle, with `--json` and the options that select the vehicle."""
    parser = actions.add(name, summary, run)
    parser.add_argument("--json", action="store_true", help="print JSON")
    add_connection_options(parser, fleet=fleet, changes=changes)
    return parser


def connection_urls(arguments: Namespace) -> list[str]:
    """Return the URLs to connect to, with the options of links that the command line gives."""
    urls = arguments.url or [os.environ.get("MAVSTACK_URL") or DEFAULT_URL]
    return with_link_options(urls, arguments)


def run_on_vehicle(arguments: Namespace, work: Callable[[Vehicle], Awaitable[int]]) -> int:
    """Connect, wait for the selected vehicles, run the work on each and return the exit code.

    One vehicle that fails does not stop the others. In a session the work is handed to the session instead,
    and 0 is returned.
    """
    session_work = getattr(arguments, "session_work", None)
    if session_work is not None:
        session_work(work)
        return 0

    async def connected(connection: Connection) -> int:
        group = await selected_vehicles(connection, arguments)
        if selects_several(arguments):
            return await _run_on_each(group, arguments, work)
        vehicle = next(iter(group))
        code = await work(vehicle)
        await mention_conflict(vehicle, arguments)
        mention_other_vehicles(connection, vehicle, arguments)
        return code

    return run_on_connection(arguments, connected)


def on_vehicle(work: Callable[[Vehicle, Namespace], Awaitable[int]]) -> Callable[[Namespace], int]:
    """Return the function of an action that does work on the selected vehicles (`run_on_vehicle`)."""

    @wraps(work)
    def run(arguments: Namespace) -> int:
        return run_on_vehicle(arguments, lambda vehicle: work(vehicle, arguments))

    return run


async def _run_on_each(group: Group, arguments: Namespace, work: Callable[[Vehicle], Awaitable[int]]) -> int:
    outcomes = await group.each(work)
    for vehicle, error in outcomes.errors.items():
        if not isinstance(error, MavstackError | OSError):
            raise error
        text = of_vehicle(vehicle, failure_text(error))
        echo(f"mav {arguments.command}: {text}", error=True)
    return 1 if outcomes.errors or any(outcomes.succeeded.values()) else 0


def run_on_connection(
    arguments: Namespace, work: Callable[[Connection], Awaitable[int]], *, announce: bool = True
) -> int:
    """Connect, run the work and return its exit code.

    Args:
        arguments: The parsed arguments.
        work: The work of the command.
        announce: Say on stderr which links accept data from other hosts.
    """

    async def connected() -> int:
        channel = getattr(arguments, "channel", None)
        async with connect(*connection_urls(arguments), channel=channel) as connection:
            if announce:
                announce_exposure(arguments.command, connection.links)
            return await work(connection)

    return run_until_signal(connected())
