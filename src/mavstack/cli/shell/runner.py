"""The runner of lines: looks commands up, expands aliases, runs scripts; a failure is a `MavstackError`.

The name of a flight mode is a command too, as in MAVProxy: `loiter` is `mode loiter`.
"""

from __future__ import annotations

import shlex
from difflib import get_close_matches
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.errors import UsageError, failure_text
from mavstack.cli.common.output import coloured, echo
from mavstack.cli.shell.console_command import AlreadyReported
from mavstack.cli.shell.parsing import split_commands
from mavstack.errors import MavstackError
from mavstack.services.modes import mode_names

if TYPE_CHECKING:
    from collections.abc import AsyncIterable, Iterable

    from mavstack.cli.shell.session import Session
    from mavstack.vehicle import Vehicle

#: Maximum nesting depth of aliases and scripts.
MAX_DEPTH: Final = 20


async def run_line(session: Session, line: str) -> None:
    """Run the commands of a line one after the other; the first failure is raised and ends the line."""
    for words in split_commands(line):
        if session.exiting:
            return
        await run_words(session, words)


async def run_words(session: Session, words: list[str]) -> None:
    """Run one command."""
    name, *rest = words
    if name in session.aliases:
        text = " ".join([session.aliases[name], *map(shlex.quote, rest)])
        await _run_nested(session, name, text)
        return
    command = session.commands.get(name.lower())
    if command is None or command.needs_vehicle:
        # also for an unknown command: it may be the name of a mode, which the vehicle knows
        await session.require_vehicle()
    if command is not None:
        await command.run(session, rest)
    elif name.lower() in known_modes(session) and not rest:
        await session.commands["mode"].run(session, [name])
    else:
        raise UsageError(_unknown(session, name))


async def run_lines(
    session: Session, lines: AsyncIterable[str], name: str = "", *, keep_going: bool = False
) -> bool:
    """Run the lines of a script and report failures; return whether all commands succeeded.

    Args:
        session: Session to run in.
        lines: Lines of the script.
        name: Name of the script for failures; empty if it has none.
        keep_going: Go on after a failure instead of ending the script.
    """
    succeeded, number = True, 0
    async for line in lines:
        number += 1
        location = f"{name}:{number}: " if name else ""
        succeeded = await _run_script_line(session, line, location, keep_going=keep_going) and succeeded
        if session.exiting or not (succeeded or keep_going):
            break
    return succeeded


async def _run_script_line(session: Session, line: str, location: str, *, keep_going: bool) -> bool:
    """Run the commands of a line and report failures; return whether all succeeded."""
    try:
        commands = split_commands(line)
    except UsageError as error:
        report_failure(error, location)
        return False
    succeeded = True
    for words in commands:
        if session.exiting or not (succeeded or keep_going):
            break
        try:
            await run_words(session, words)
        except (MavstackError, OSError) as error:
            succeeded = False
            report_failure(error, location)
    return succeeded


def report_failure(error: MavstackError | OSError, location: str = "") -> None:
    """Print on stderr why a command failed, unless the command has printed it."""
    if not isinstance(error, AlreadyReported):
        text = (
            f"{error.filename}: {error.strerror}"
            if isinstance(error, OSError) and error.filename
            else failure_text(error)
        )
        echo(coloured(f"{location}{text}", "red"), error=True)


def known_modes(session: Session) -> frozenset[str]:
    """Return the names of flight modes in lower case: of the selected vehicle, or of all before a choice.

    They are the modes that the vehicle has listed, or else those of its firmware.
    """
    selected = session.selected
    vehicles = session.connection.vehicles.values() if selected is None else (selected,)
    return frozenset(name.lower() for vehicle in vehicles for name in _mode_names(session, vehicle))


def _mode_names(session: Session, vehicle: Vehicle) -> Iterable[str]:
    listed = session.listed_modes.get(vehicle.system)
    if listed is not None:
        return listed
    info = vehicle.component.info
    return () if info is None else mode_names(info.autopilot, info.type).values()


async def _run_nested(session: Session, name: str, text: str) -> None:
    if session.depth >= MAX_DEPTH:
        raise UsageError(f"{name} calls itself without end")
    session.depth += 1
    try:
        await run_line(session, text)
    finally:
        session.depth -= 1


def _unknown(session: Session, name: str) -> str:
    near = get_close_matches(name.lower(), [*session.commands, *session.aliases], n=1)
    return f"there is no command {name!r}; " + (f"did you mean {near[0]}?" if near else "try help")
