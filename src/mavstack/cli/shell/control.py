"""Commands that control the shell: help, set, alias, script, output, sleep, exit."""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.errors import CommandError, UsageError
from mavstack.cli.common.exposure import announce_exposure
from mavstack.cli.common.output import align_columns
from mavstack.cli.shell import completion
from mavstack.cli.shell.console_command import AlreadyReported, expect_words, parse_number
from mavstack.cli.shell.parsing import split_commands
from mavstack.cli.shell.runner import MAX_DEPTH, run_lines
from mavstack.cli.shell.session import Command

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Sequence

    from mavstack.cli.shell.session import Session


async def show_help(session: Session, words: list[str]) -> None:
    """Run `help` or `help takeoff`."""
    expect_words(words, 0, 1, "help [COMMAND]")
    if words:
        session.print(*_help_of(session, words[0]))
        return
    unique = dict.fromkeys(session.commands.values())
    rows = [(f"  {each.name}", each.summary) for each in unique]
    session.print(
        *align_columns(rows),
        "",
        "help COMMAND shows details; Tab completes; Ctrl-C cancels a command, Ctrl-D leaves the shell.",
    )


async def settings(session: Session, words: list[str]) -> None:
    """Run `set`, `set wait` or `set wait off`."""
    expect_words(words, 0, 2, "set [NAME [VALUE]]")
    if len(words) == 2:
        session.settings.change(words[0].lower(), words[1])
        return
    names = (words[0].lower(),) if words else session.settings.names()
    session.print(*align_columns([(name, session.settings.text(name)) for name in names]))


async def alias(session: Session, words: list[str]) -> None:
    """Run `alias`, `alias add up "takeoff 10"` or `alias remove up`."""
    match [words[0].lower() if words else "list", *words[1:]]:
        case ["list"]:
            rows = sorted(session.aliases.items())
            session.print(*(align_columns(rows) if rows else ["there are no aliases"]))
        case ["add", name, *meaning] if meaning:
            text = " ".join(meaning)
            split_commands(text)  # raises if the text is not a valid command line
            if not name.isidentifier() or name.lower() == "alias":
                raise UsageError(f"{name!r} cannot be an alias")
            session.aliases[name] = text
        case ["remove", name]:
            if session.aliases.pop(name, None) is None:
                raise UsageError(f"there is no alias {name!r}")
        case _:
            raise UsageError("usage: alias [list], alias add NAME LINE, or alias remove NAME")


async def script(session: Session, words: list[str]) -> None:
    """Run `script FILE`."""
    expect_words(words, 1, 1, "script FILE")
    if session.depth >= MAX_DEPTH:
        raise UsageError(f"{words[0]} runs itself without end")
    session.depth += 1
    try:
        if not await run_lines(session, script_lines(words[0]), words[0]):
            raise AlreadyReported(f"{words[0]} failed")
    finally:
        session.depth -= 1


async def output(session: Session, words: list[str]) -> None:
    """Run `output add URL`, `output list` or `output remove URL`."""
    forwarding = session.forwarding
    match [words[0].lower() if words else "list", *words[1:]]:
        case ["list"]:
            rows = [
                (str(index), each.url, f"{each.peers} peers", f"{each.sent} out, {each.received} in")
                for index, each in enumerate(forwarding.outputs)
            ]
            session.print(*(align_columns(rows) if rows else ["there are no outputs"]))
        case ["add", url]:
            await add_output(session, url)
        case ["remove", which]:
            known = which.isascii() and which.isdecimal() and len(which) < 4
            await forwarding.remove(int(which) if known else which)
        case _:
            raise UsageError("usage: output [list], output add URL, or output remove URL|NUMBER")


async def add_output(session: Session, url: str) -> None:
    """Forward packets to a link; say on stderr if other hosts can reach it."""
    added = await session.forwarding.add(url)
    announce_exposure("shell", [added.link])


async def sleep(session: Session, words: list[str]) -> None:
    """Run `sleep 2.5`."""
    expect_words(words, 1, 1, "sleep SECONDS")
    seconds = parse_number(words[0], "the time")
    if seconds < 0:
        raise UsageError(f"the time must not be negative, got {seconds:g} s")
    await asyncio.sleep(seconds)


async def exit_shell(session: Session, words: list[str]) -> None:
    """Run `exit`."""
    expect_words(words, 0, 0, "exit")
    session.exiting = True


async def script_lines(path: str) -> AsyncIterator[str]:
    """Yield the lines of a script file."""
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
    lines += [f"  Other names: {', '.join(command.aliases)}."] if command.aliases else []
    lines += ["", "examples:", *(f"  {example}" for example in command.examples)] if command.examples else []
    return lines


COMMANDS: Final = (
    Command(
        "help", "[COMMAND]", "list the commands, or show the help of one", show_help, aliases=("?",),
        needs_vehicle=False,
        examples=("help", "help takeoff"), complete=completion.by_position(completion.commands),
    ),
    Command(
        "set", "[NAME [VALUE]]", "show or change the settings of the shell", settings,
        needs_vehicle=False,
        examples=("set", "set wait off"),
        details="wait: commands that fly wait until the vehicle has finished. timeout: of commands that fly, "
        "in seconds, 0 for none. severity: status texts of lower severity are hidden. rate: of messages that "
        "`watch` requests, in hertz, 0 for the rate of the vehicle.",
        complete=completion.by_position(completion.settings, completion.choice("on", "off")),
    ),
    Command(
        "alias", "[list | add NAME LINE | remove NAME]", "give a name to a line of commands", alias,
        needs_vehicle=False,
        examples=('alias add up "mode guided; arm throttle; takeoff 10"', "alias list", "alias remove up"),
        complete=completion.subcommands(
            {"list": None, "add": None, "remove": completion.by_position(completion.aliases)}
        ),
    ),
    Command(
        "script", "FILE", "run the lines of a file until a command fails", script, aliases=("run",),
        needs_vehicle=False,
        complete=completion.by_position(completion.local_files),
    ),
    Command(
        "output", "[list | add URL | remove URL|NUMBER]", "forward all packets to other programs and back",
        output, needs_vehicle=False,
        examples=("output add udpout://127.0.0.1:14551", "output list", "output remove 0"),
        details="A ground station can be connected through the shell: packets are forwarded unchanged in "
        "both directions.",
        complete=completion.subcommands(
            {"list": None, "add": None, "remove": completion.by_position(completion.outputs)}
        ),
    ),
    Command(
        "sleep", "SECONDS", "wait in a script", sleep, aliases=("delay",), examples=("sleep 2",),
        needs_vehicle=False,
    ),
    Command(
        "exit", "", "leave the shell", exit_shell, aliases=("quit", "bye"), examples=("exit",),
        needs_vehicle=False,
    ),
)  # fmt: skip
