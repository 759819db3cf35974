"""What a word that is being typed may become: commands, parameters, modes, messages, files here and there.

A completer is given the words before the one at the cursor; completers are put together from smaller ones:

    subcommands({"set": in_turn(parameters), "load": in_turn(local_files)})

What lies on the vehicle is asked for, remembered for a while, and left out if there is no answer soon.
"""

from __future__ import annotations

import asyncio
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Final

from mavstack.cli.shell.parsing import unfinished_of
from mavstack.cli.shell.runner import modes_known
from mavstack.cli.shell.settings import Settings
from mavstack.dialects import Dialect, ardupilotmega, common
from mavstack.errors import MavstackError

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from mavstack.cli.shell.console_command import Completer
    from mavstack.cli.shell.session import Session

#: How long to wait for the vehicle to list a directory, and how long to remember it, in seconds.
PATIENCE: Final = 2.0
MEMORY: Final = 15.0
#: Fields of messages cannot be completed, and so many names are offered at most.
MOST: Final = 500


async def complete(session: Session, text: str) -> tuple[list[str], int]:
    """What the word at the end of a text may become, and how many letters of it that replaces."""
    words, word = unfinished_of(text)
    if not words:
        found: Iterable[str] = {*session.commands, *session.aliases, *modes_known(session)}
    else:
        meant = session.aliases.get(words[0], words[0]).split()
        command = session.commands.get(meant[0].lower()) if meant else None
        if command is None or command.complete is None:
            return [], 0
        found = await command.complete(session, words[1:], word)
    fitting = {each for each in found if each.lower().startswith(word.lower())}
    return sorted(fitting)[:MOST], len(word)


# How completers are put together


def one_of(*choices: str) -> Completer:
    """One of some words."""

    async def completer(_: Session, __: Sequence[str], ___: str) -> Iterable[str]:
        return choices

    return completer


def in_turn(*completers: Completer | None, rest: Completer | None = None) -> Completer:
    """The first word by the first of them, and so on; all words behind by `rest`."""

    async def completer(session: Session, before: Sequence[str], word: str) -> Iterable[str]:
        place = len(before)
        mine = completers[place] if place < len(completers) else rest
        return [] if mine is None else await mine(session, before, word)

    return completer


def subcommands(known: Mapping[str, Completer | None]) -> Completer:
    """A word that says what is meant, and what follows it."""

    async def completer(session: Session, before: Sequence[str], word: str) -> Iterable[str]:
        if not before:
            return known
        mine = known.get(before[0].lower())
        return [] if mine is None else await mine(session, before[1:], word)

    return completer


# What words may be


async def parameters(session: Session, _: Sequence[str], __: str) -> Iterable[str]:
    """Parameters that were heard of."""
    vehicle = session.chosen
    return () if vehicle is None else tuple(vehicle.params.cached)


async def modes(session: Session, _: Sequence[str], __: str) -> Iterable[str]:
    """Flight modes."""
    return modes_known(session)


async def commands(session: Session, _: Sequence[str], __: str) -> Iterable[str]:
    """Commands of the shell."""
    return (*session.commands, *session.aliases)


async def aliases(session: Session, _: Sequence[str], __: str) -> Iterable[str]:
    """Aliases of the user."""
    return tuple(session.aliases)


async def settings(_: Session, __: Sequence[str], ___: str) -> Iterable[str]:
    """Settings."""
    return Settings.names()


async def systems(session: Session, _: Sequence[str], __: str) -> Iterable[str]:
    """Vehicles, by system id."""
    return tuple(map(str, session.node.vehicles))


async def outputs(session: Session, _: Sequence[str], __: str) -> Iterable[str]:
    """What is forwarded to."""
    return tuple(output.url for output in session.forwarding.outputs)


async def mav_commands(_: Session, __: Sequence[str], ___: str) -> Iterable[str]:
    """MAV_CMD, without what all begin with."""
    return tuple(ardupilotmega.MavCmd.__members__)


async def frames(_: Session, __: Sequence[str], ___: str) -> Iterable[str]:
    """MAV_FRAME, without what all begin with."""
    return tuple(common.MavFrame.__members__)


async def messages(_: Session, __: Sequence[str], ___: str) -> Iterable[str]:
    """Messages."""
    return _message_names()


async def local_files(_: Session, __: Sequence[str], word: str) -> Iterable[str]:
    """Files here."""
    return _files_here(word)


def _files_here(word: str) -> list[str]:
    path = Path(word).expanduser()
    directory = path if word.endswith(("/", "\\")) or not word else path.parent
    hidden = path.name.startswith(".")
    typed = word[: len(word) - (0 if directory == path else len(path.name))]
    try:
        entries = [entry for entry in directory.iterdir() if hidden or not entry.name.startswith(".")]
        return [f"{typed}{entry.name}{'/' if entry.is_dir() else ''}" for entry in entries]
    except OSError:
        return []


async def remote_files(session: Session, _: Sequence[str], word: str) -> Iterable[str]:
    """Files on the vehicle."""
    vehicle = session.chosen
    if vehicle is None:
        return ()
    directory = word[: word.rfind("/") + 1]
    key, now = (vehicle.system, directory), session.node.now()
    known = session.remembered.get(key)
    if known is None or now > known[0] + MEMORY:
        try:
            async with asyncio.timeout(PATIENCE):
                entries = await vehicle.ftp.list(directory or "/")
        except (MavstackError, TimeoutError):
            return ()
        names = tuple(f"{directory}{each.name}{'/' if each.is_directory else ''}" for each in entries)
        session.remembered[key] = known = now, names
    return known[1]


@cache
def _message_names() -> tuple[str, ...]:
    return tuple(Dialect.load("all").names)
