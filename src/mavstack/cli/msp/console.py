"""`mav msp cli`: the command line interface of a flight controller, by lines or interactively."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.errors import CommandError, UsageError
from mavstack.cli.common.output import echo, echo_json, echo_question, echo_text
from mavstack.cli.common.stdin_lines import stdin_lines
from mavstack.cli.msp.connection import run_on_controller
from mavstack.errors import InvalidArgumentError
from mavstack.msp.cli import check_line, errors_in, is_leaving

if TYPE_CHECKING:
    from argparse import Namespace

    from mavstack.bridges.msp.cli_session import CliSession
    from mavstack.bridges.msp.flight_controller import FlightController

_PROMPT: Final = "# "
_RESTARTS: Final = "the controller restarts …"


def cli(arguments: Namespace) -> int:
    """Run `mav msp cli`."""
    try:
        for line in arguments.lines:
            check_line(line)
    except InvalidArgumentError as error:
        raise UsageError(str(error)) from None
    if arguments.json and not arguments.lines:
        raise UsageError("--json needs lines to send")

    async def work(controller: FlightController) -> int:
        async with controller.cli() as session:
            if arguments.lines:
                await _run_lines(session, arguments)
            else:
                await _converse(session)
            if arguments.save and not session.closed:
                await session.save()
            echo(_RESTARTS, error=True)
        return 0

    return run_on_controller(arguments, work)


async def _run_lines(session: CliSession, arguments: Namespace) -> None:
    replies: dict[str, str] = {}
    for line in arguments.lines:
        replies[line] = reply = await session.run(line)
        if not arguments.json and reply:
            echo_text(reply + "\n")
        if errors := errors_in(reply):
            if arguments.json:
                echo_json(replies)
            not_saved = "; nothing was saved" if arguments.save else ""
            raise CommandError(f"{line!r} failed: {'; '.join(errors)}{not_saved}")
        if is_leaving(line):
            break
    if arguments.json:
        echo_json(replies)


async def _converse(session: CliSession) -> None:
    """Send the lines of standard input, until it ends or a line closes the CLI."""
    is_terminal = sys.stdin is not None and sys.stdin.isatty()
    if is_terminal:
        echo("`save` keeps changes; `exit` and Ctrl-D drop them; both restart the controller", error=True)
        echo_question(_PROMPT)
    async for line in stdin_lines():
        try:
            reply = await session.run(line.strip())
        except InvalidArgumentError as error:
            if not is_terminal:
                raise
            reply = str(error)
        if reply:
            echo_text(reply + "\n")
        if session.closed:
            return
        if not is_terminal and errors_in(reply):
            raise CommandError(f"{line.strip()!r} failed: {'; '.join(errors_in(reply))}; nothing was saved")
        if is_terminal:
            echo_question(_PROMPT)
    if is_terminal:
        echo("")
