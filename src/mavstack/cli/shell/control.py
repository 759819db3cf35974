"""Commands for the shell itself: help, set, alias, script, output, sleep, exit."""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.errors import CommandError
from mavstack.cli.common.errors import UsageError
from mavstack.cli.common.output import align_columns
from mavstack.cli.shell import completion
from mavstack.cli.shell.console_command import AlreadyReported, Command, expect, number_of
from mavstack.cli.shell.parsing import commands_of
from mavstack.cli.shell.runner import DEEPEST, run_lines
from mavstack.errors import MavstackError

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Sequence

    from mavstack.cli.shell.session import Session


async def help_me(session: Session, words: list[str]) -> None:
    """`help`, `help takeoff`."""
    expect(words, 0, 1, "help [COMMAND]")
    if words:
        session.say(*_help_of(session, words[0]))
        return
    unique = dict.fromkeys(session.commands.values())
    rows = [(f"  {each.name}", each.summary) for each in unique]
    session.say(
        *align_columns(rows), "", "help COMMAND tells more; Tab completes; Ctrl-C ends a command, Ctrl-D all."
    )


async def settings(session: Session, words: list[str]) -> None:
    """`set`, `set wait`, `set wait off`."""
    expect(words, 0, 2, "set [NAME [VALUE]]")
    if len(words) == 2:
        session.settings.change(words[0].lower(), words[1])
        return
    names = (words[0].lower(),) if words else session.settings.names()
    session.say(*align_columns([(name, session.settings.text(name)) for name in names]))


async def alias(session: Session, words: list[str]) -> None:
    """`alias`, `alias add up "takeoff 10"`, `alias remove up`."""
    match [words[0].lower() if words else "list", *words[1:]]:
        case ["list"]:
            rows = sorted(session.aliases.items())
            session.say(*(align_columns(rows) if rows else ["there are no aliases"]))
        case ["add", name, *meaning] if meaning:
            text = " ".join(meaning)
            commands_of(text)  # raises if it cannot be a line
            if not name.isidentifier() or name.lower() == "alias":
                raise UsageError(f"{name!r} cannot be an alias")
            session.aliases[name] = text
        case ["remove", name]:
            if session.aliases.pop(name, None) is None:
                raise UsageError(f"there is no alias {name!r}")
        case _:
            raise UsageError("usage: alias [list], alias add NAME LINE, or alias remove NAME")


async def script(session: Session, words: list[str]) -> None:
    """`script FILE`."""
    expect(words, 1, 1, "script FILE")
    if session.depth >= DEEPEST:
        raise UsageError(f"{words[0]} runs itself again and again")
    session.depth += 1
    try:
        if not await run_lines(session, script_lines(words[0]), words[0]):
            raise AlreadyReported(f"{words[0]} failed")
    finally:
        session.depth -= 1


async def output(session: Session, words: list[str]) -> None:
    """`output add URL`, `output list`, `output remove URL`."""
    forwarding = session.forwarding
    match [words[0].lower() if words else "list", *words[1:]]:
        case ["list"]:
            rows = [
                (str(place), each.url, f"{each.peers} there", f"{each.sent} out, {each.received} in")
                for place, each in enumerate(forwarding.outputs)
            ]
            session.say(*(align_columns(rows) if rows else ["nothing is forwarded"]))
        case ["add", url]:
            await forwarding.add(url)
        case ["remove", which]:
            known = which.isascii() and which.isdecimal() and len(which) < 4
            await forwarding.remove(int(which) if known else which)
        case _:
            raise UsageError("usage: output [list], output add URL, or output remove URL|NUMBER")


async def sleep(session: Session, words: list[str]) -> None:
    """`sleep 2.5`."""
    expect(words, 1, 1, "sleep SECONDS")
    seconds = number_of(words[0], "the time")
    if seconds < 0:
        raise UsageError("nothing sleeps for less than no time")
    await asyncio.sleep(seconds)


async def leave(session: Session, words: list[str]) -> None:
    """`exit`."""
    expect(words, 0, 0, "exit")
    session.leaving = True


async def script_lines(path: str) -> AsyncIterator[str]:
    """The lines of a script file."""
    for line in _read(path).splitlines():
        yield line


def _read(path: str) -> str:
    try:
        return Path(path).expanduser().read_text(encoding="utf-8")
    except UnicodeDecodeError:
        raise CommandError(f"{path} is not a text file") from None


def _help_of(session: Session, name: str) -> Sequence[str]:
    if name in session.aliases:
        return [f"{name} is an alias of: {session.aliases[name]}"]
    command = session.commands.get(name.lower())
    if command is None:
        raise UsageError(f"there is no command {name!r}; help lists them")
    summary = command.summary[0].upper() + command.summary[1:]
    lines = [command.synopsis, "", f"  {summary}."]
    lines += [f"  {command.details}"] if command.details else []
    lines += [f"  Also called {', '.join(command.aliases)}."] if command.aliases else []
    lines += ["", "examples:", *(f"  {example}" for example in command.examples)] if command.examples else []
    return lines


COMMANDS: Final = (
    Command(
        "help", "[COMMAND]", "list the commands, or tell more about one", help_me, aliases=("?",),
        examples=("help", "help takeoff"), complete=completion.in_turn(completion.commands),
    ),
    Command(
        "set", "[NAME [VALUE]]", "settings of the shell", settings, examples=("set", "set wait off"),
        details="wait: commands that fly wait until it is done. limit: for so many seconds at most. "
        "severity: the least important texts that are shown. rate: what `watch` asks for.",
        complete=completion.in_turn(completion.settings, completion.one_of("on", "off")),
    ),
    Command(
        "alias", "[list | add NAME LINE | remove NAME]", "lines under a name of your own", alias,
        examples=('alias add up "mode guided; arm throttle; takeoff 10"', "alias list", "alias remove up"),
        complete=completion.subcommands(
            {"list": None, "add": None, "remove": completion.in_turn(completion.aliases)}
        ),
    ),
    Command(
        "script", "FILE", "run the lines of a file; the first that fails ends it", script, aliases=("run",),
        complete=completion.in_turn(completion.local_files),
    ),
    Command(
        "output", "[list | add URL | remove URL|NUMBER]", "forward everything to other programs and back",
        output, examples=("output add udpout://127.0.0.1:14551", "output list", "output remove 0"),
        details="A ground station can sit behind the shell: all that is heard goes there, and what comes "
        "from there goes to the vehicle, byte for byte.",
        complete=completion.subcommands(
            {"list": None, "add": None, "remove": completion.in_turn(completion.outputs)}
        ),
    ),
    Command("sleep", "SECONDS", "wait, in scripts", sleep, aliases=("delay",), examples=("sleep 2",)),
    Command("exit", "", "leave the shell", leave, aliases=("quit", "bye"), examples=("exit",)),
)  # fmt: skip
