"""`mav shell`: an interactive console, or the commands of a script, for the vehicles on some links."""

from __future__ import annotations

import sys
from functools import partial
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.connection import DEFAULT_URL, add_heartbeat_timeout, connection_urls
from mavstack.cli.common.ending_signals import run_until_signal
from mavstack.cli.common.exposure import announce_exposure
from mavstack.cli.common.link_options import add_link_options
from mavstack.cli.common.options import system_id
from mavstack.cli.common.selection import require_one_vehicle, several_vehicles
from mavstack.cli.common.stdin_lines import stdin_lines
from mavstack.cli.shell.control import add_output, script_lines
from mavstack.cli.shell.interactive import line_reader, run_interactive
from mavstack.cli.shell.notifications import Notifications, print_notification
from mavstack.cli.shell.plugins import with_plugins
from mavstack.cli.shell.registry import COMMANDS
from mavstack.cli.shell.runner import report_failure, run_lines
from mavstack.cli.shell.session import Session
from mavstack.errors import RemoteTimeout
from mavstack.vehicle import connect

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import AsyncIterator

    from mavstack.vehicle import Connection

EXAMPLES: Final = """\
examples:
  mav shell                                       # vehicles on UDP port 14550
  mav shell udpin://0.0.0.0:14550 --out udpout://127.0.0.1:14551   # and a ground station
  mav shell /dev/ttyACM0,57600 --key fleet        # signed
  mav shell --command "mode guided; arm throttle; takeoff 10"
  mav shell --script flight.txt
  echo "param show RTL*" | mav shell

In the shell, `help` lists the commands and `help takeoff` shows the help of one; Tab completes. The commands
of MAVProxy work: arm throttle, mode guided, takeoff 20, wp load, param set, fence list, rc 3 1500.

Other packages add commands: entry points of the group mavstack.console_commands.

A script has one command per line, or several separated by `;`; # begins a comment. A failure ends the script.
"""


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments."""
    parser.set_defaults(run_action=run)
    add = parser.add_argument
    add(
        "url",
        nargs="*",
        metavar="URL",
        help=f"link to the vehicles; may be repeated (default: $MAVSTACK_URL or {DEFAULT_URL})",
    )
    add("--system", type=system_id, metavar="ID", help="vehicle to select (needed if several are heard)")
    add("--out", action="append", default=[], metavar="URL", help="forward all packets to this link and back")
    group = parser.add_mutually_exclusive_group()
    group.add_argument("--script", metavar="FILE", help="run the lines of a file, and exit")
    group.add_argument("--command", metavar="LINE", help="run a line, and exit")
    add("--keep-going", action="store_true", help="go on with a script after a failure")
    add_heartbeat_timeout(parser)
    add_link_options(parser.add_argument_group("links"))


def run(arguments: Namespace) -> int:
    """Run the shell."""
    return run_until_signal(_connect_and_run(arguments))


async def _connect_and_run(arguments: Namespace) -> int:
    channel = getattr(arguments, "channel", None)
    async with connect(*connection_urls(arguments), channel=channel) as connection:
        announce_exposure("shell", connection.links)
        return await run_shell(connection, arguments)


async def run_shell(connection: Connection, arguments: Namespace) -> int:
    """Run the shell, a script or a line on an open connection; return the exit code."""
    lines = _lines(arguments)
    commands = with_plugins(COMMANDS, report_failure)
    async with Session(connection, commands) as session, Notifications(session):
        for url in arguments.out:
            await add_output(session, url)
        if lines is None:
            reader = line_reader(session)
            session.ask, session.reader = reader.ask, reader
            await _look_for_vehicle(session, arguments)
            await run_interactive(session, reader)
            return 0
        session.wait_for_vehicle = partial(_require_vehicle, session, arguments)
        name = arguments.script or ""
        return 0 if await run_lines(session, lines, name, keep_going=arguments.keep_going) else 1


def _lines(arguments: Namespace) -> AsyncIterator[str] | None:
    """Return the lines of a script; None if the shell is interactive."""
    if arguments.script is not None:
        return script_lines(arguments.script)
    if arguments.command is not None:
        return _one_line(arguments.command)
    return None if sys.stdin is not None and sys.stdin.isatty() else stdin_lines()


async def _one_line(line: str) -> AsyncIterator[str]:
    yield line


async def _require_vehicle(session: Session, arguments: Namespace) -> None:
    """Wait for the vehicle of a script and select it.

    Raises:
        RemoteTimeout: No vehicle is heard in time.
        UsageError: Several vehicles are heard, and none was selected.
    """
    connection = session.connection
    vehicle = await connection.wait_for_vehicle(arguments.system, timeout=arguments.timeout)
    if arguments.system is not None:
        session.select(vehicle.system)
    elif not session.has_selection:
        await require_one_vehicle(connection, "select one with --system ID, or `vehicle ID` in the script")


async def _look_for_vehicle(session: Session, arguments: Namespace) -> None:
    """Wait for vehicles before the first prompt; an interactive shell goes on without them."""
    connection = session.connection
    try:
        vehicle = await connection.wait_for_vehicle(arguments.system, timeout=arguments.timeout)
    except RemoteTimeout as error:
        report_failure(error)
        return
    if arguments.system is not None:
        session.select(vehicle.system)
    elif await several_vehicles(connection):
        print_notification(session.choice_text(), "yellow")
