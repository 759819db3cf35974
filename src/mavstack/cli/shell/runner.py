"""Runs lines: looks a command up, expands aliases, runs scripts; what fails is a `MavstackError`.

The name of a flight mode is a command too, as users of MAVProxy are used to: `loiter` is `mode loiter`.
"""

from __future__ import annotations

import shlex
import sys
from difflib import get_close_matches
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.output import coloured
from mavstack.cli.common.errors import UsageError
from mavstack.cli.shell.console_command import AlreadyReported
from mavstack.cli.shell.parsing import commands_of
from mavstack.errors import MavstackError
from mavstack.services.modes import mode_names

if TYPE_CHECKING:
    from collections.abc import AsyncIterable

    from mavstack.cli.shell.session import Session

#: Aliases and scripts may call each other so deep.
DEEPEST: Final = 20


async def run_line(session: Session, line: str) -> None:
    """Run the commands of a line, one after the other; the first that fails ends it."""
    for words in commands_of(line):
        if session.leaving:
            return
        await run_words(session, words)


async def run_words(session: Session, words: list[str]) -> None:
    """Run one command."""
    name, *rest = words
    if name in session.aliases:
        text = " ".join([session.aliases[name], *map(shlex.quote, rest)])
        await _deeper(session, name, text)
        return
    command = session.commands.get(name.lower())
    if command is not None:
        await command.run(session, rest)
    elif name.lower() in modes_known(session) and not rest:
        await session.commands["mode"].run(session, [name])
    else:
        raise UsageError(_unknown(session, name))


async def run_lines(
    session: Session, lines: AsyncIterable[str], name: str = "", *, keep_going: bool = False
) -> bool:
    """Run the lines of a script, which what fails ends unless it is to keep going; whether all went well."""
    went_well, number = True, 0
    async for line in lines:
        number += 1
        where = f"{name}:{number}: " if name else ""
        went_well = await _run_each(session, line, where, keep_going=keep_going) and went_well
        if session.leaving or not (went_well or keep_going):
            break
    return went_well


async def _run_each(session: Session, line: str, where: str, *, keep_going: bool) -> bool:
    """Run the commands of a line, telling what fails; whether all went well."""
    try:
        commands = commands_of(line)
    except UsageError as error:
        tell_failure(error, where)
        return False
    went_well = True
    for words in commands:
        if session.leaving or not (went_well or keep_going):
            break
        try:
            await run_words(session, words)
        except (MavstackError, OSError) as error:
            went_well = False
            tell_failure(error, where)
    return went_well


def tell_failure(error: MavstackError | OSError, where: str = "") -> None:
    """Say on stderr why a command failed, unless it has."""
    if not isinstance(error, AlreadyReported):
        text = (
            f"{error.filename}: {error.strerror}" if isinstance(error, OSError) and error.filename else error
        )
        print(
            coloured(f"{where}{' '.join(str(text).split())}", "red", sys.stderr), file=sys.stderr, flush=True
        )


def modes_known(session: Session) -> frozenset[str]:
    """The names of the modes that the vehicle's firmware is known to have, in lower case."""
    vehicle = session.chosen
    info = None if vehicle is None else vehicle.component.info
    if info is None:
        return frozenset()
    return frozenset(name.lower() for name in mode_names(info.autopilot, info.type).values())


async def _deeper(session: Session, name: str, text: str) -> None:
    if session.depth >= DEEPEST:
        raise UsageError(f"{name} calls itself again and again")
    session.depth += 1
    try:
        await run_line(session, text)
    finally:
        session.depth -= 1


def _unknown(session: Session, name: str) -> str:
    near = get_close_matches(name.lower(), [*session.commands, *session.aliases], n=1)
    return f"there is no command {name!r}; " + (f"did you mean {near[0]}?" if near else "try help")
