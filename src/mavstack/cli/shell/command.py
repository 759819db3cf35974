"""`mav shell`: an interactive console, or the commands of a script, for the vehicles on some links."""

from __future__ import annotations

import asyncio
import sys
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.connection import DEFAULT_URL, add_heartbeat_timeout, connection_urls
from mavstack.cli.common.options import system_id
from mavstack.cli.common.stdin_lines import stdin_lines
from mavstack.cli.shell.control import script_lines
from mavstack.cli.shell.interactive import interact, line_for
from mavstack.cli.shell.notifications import News
from mavstack.cli.shell.registry import COMMANDS
from mavstack.cli.shell.runner import run_lines, tell_failure
from mavstack.cli.shell.session import Session
from mavstack.errors import RemoteTimeout
from mavstack.vehicle import connect

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import AsyncIterator

    from mavstack.vehicle import Connection

EXAMPLES: Final = """\
examples:
  mav shell                                                 hears vehicles on UDP port 14550
  mav shell udpin://0.0.0.0:14550 --out udpout://127.0.0.1:14551      with a ground station behind it
  mav shell /dev/ttyACM0,57600
  mav shell --command "mode guided; arm throttle; takeoff 10"
  mav shell --script flight.txt
  echo "param show RTL*" | mav shell

In the shell, `help` lists the commands, `help takeoff` tells more about one; Tab completes. What users of
MAVProxy type works: arm throttle, mode guided, takeoff 20, wp load, param set, fence list, rc 3 1500.

Scripts have a command a line, or several with `;` between; # begins a comment. The first that fails ends it.
"""


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments."""
    add = parser.add_argument
    add("url", nargs="*", metavar="URL", help=f"where vehicles are (default: $MAVSTACK_URL or {DEFAULT_URL})")
    add("--system", type=system_id, metavar="ID", help="the vehicle that is meant (default: the first heard)")
    add("--out", action="append", default=[], metavar="URL", help="forward all that is heard there, and back")
    what = parser.add_mutually_exclusive_group()
    what.add_argument("--script", metavar="FILE", help="run the lines of a file, and leave")
    what.add_argument("--command", metavar="LINE", help="run a line, and leave")
    add("--keep-going", action="store_true", help="do not end a script at the first command that fails")
    add_heartbeat_timeout(parser)


def run(arguments: Namespace) -> int:
    """Run the shell."""
    return asyncio.run(_connected(arguments))


async def _connected(arguments: Namespace) -> int:
    async with connect(*connection_urls(arguments)) as node:
        return await run_shell(node, arguments)


async def run_shell(node: Connection, arguments: Namespace) -> int:
    """Run the shell, a script or a line on an open connection; the exit code."""
    lines = _lines(arguments)
    async with Session(node, COMMANDS) as session, News(session):
        for url in arguments.out:
            await session.forwarding.add(url)
        if lines is None:
            line = line_for(session)
            session.ask = line.ask
            await _wait_for_vehicle(session, arguments, quietly=True)
            await interact(session, line)
            return 0
        await _wait_for_vehicle(session, arguments)
        name = arguments.script or ""
        return 0 if await run_lines(session, lines, name, keep_going=arguments.keep_going) else 1


def _lines(arguments: Namespace) -> AsyncIterator[str] | None:
    """The lines of a script, whatever it is; None if somebody types."""
    if arguments.script is not None:
        return script_lines(arguments.script)
    if arguments.command is not None:
        return _one_line(arguments.command)
    return None if sys.stdin is not None and sys.stdin.isatty() else stdin_lines()


async def _one_line(line: str) -> AsyncIterator[str]:
    yield line


async def _wait_for_vehicle(session: Session, arguments: Namespace, *, quietly: bool = False) -> None:
    """Wait for the vehicle; somebody who types may go on without it."""
    try:
        vehicle = await session.node.wait_for_vehicle(arguments.system, timeout=arguments.timeout)
    except RemoteTimeout as error:
        if not quietly:
            raise
        tell_failure(error)
        return
    if arguments.system is not None:
        session.choose(vehicle.system)
