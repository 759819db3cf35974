"""Completion of words: commands, parameters, modes, messages, local files and files on the vehicle.

A completer gets the words before the word at the cursor. Completers are combined from smaller ones:

    subcommands({"set": by_position(parameters), "load": by_position(local_files)})

Directories on the vehicle are listed when they are needed, kept in a cache for some seconds, and left out if
the vehicle does not answer in time.
"""

from __future__ import annotations

import asyncio
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Final

from mavstack.cli.shell.parsing import split_unfinished
from mavstack.cli.shell.runner import known_modes
from mavstack.cli.shell.settings import Settings
from mavstack.dialects import Dialect, ardupilotmega, common
from mavstack.errors import MavstackError
from mavstack.services.parameters.metadata import number_text

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from mavstack.cli.shell.session import Completer, Session
    from mavstack.services.parameters import Value

#: Seconds to wait for a directory listing of the vehicle, and seconds for which the listing is cached.
LISTING_TIMEOUT: Final = 2.0
CACHE_DURATION: Final = 15.0
MAX_CANDIDATES: Final = 500
#: A key of the cache that is not a directory: the metadata of parameters was requested already.
_METADATA_REQUESTED: Final = "\0metadata"


async def complete(session: Session, text: str) -> tuple[list[str], int]:
    """Return the candidates for the last word of a text, and the number of letters that they replace."""
    words, word = split_unfinished(text)
    if not words:
        found: Iterable[str] = {*session.commands, *session.aliases, *known_modes(session)}
    else:
        expanded = session.aliases.get(words[0], words[0]).split()
        command = session.commands.get(expanded[0].lower()) if expanded else None
        if command is None or command.complete is None:
            return [], 0
        found = await command.complete(session, words[1:], word)
    matching = {each for each in found if each.lower().startswith(word.lower()) and each.isprintable()}
    return sorted(matching)[:MAX_CANDIDATES], len(word)


# Combinations of completers


def choice(*choices: str) -> Completer:
    """Complete one of the given words."""

    async def completer(_: Session, __: Sequence[str], ___: str) -> Iterable[str]:
        return choices

    return completer


def by_position(*completers: Completer | None, rest: Completer | None = None) -> Completer:
    """Complete the first word with the first completer, and so on; further words with `rest`."""

    async def completer(session: Session, before: Sequence[str], word: str) -> Iterable[str]:
        position = len(before)
        chosen = completers[position] if position < len(completers) else rest
        return [] if chosen is None else await chosen(session, before, word)

    return completer


def subcommands(known: Mapping[str, Completer | None]) -> Completer:
    """Complete a subcommand, and the words after it with the completer of the subcommand."""

    async def completer(session: Session, before: Sequence[str], word: str) -> Iterable[str]:
        if not before:
            return known
        chosen = known.get(before[0].lower())
        return [] if chosen is None else await chosen(session, before[1:], word)

    return completer


# Completers of single words


class Candidate(str):
    """A candidate with a note for the user."""

    note = ""

    @classmethod
    def noted(cls, text: str, note: str) -> Candidate:
        """Return a candidate with a note."""
        found = cls(text)
        found.note = note
        return found


async def parameters(session: Session, _: Sequence[str], __: str) -> Iterable[str]:
    """Complete the names of known parameters."""
    vehicle = session.selected
    if vehicle is None:
        return ()
    metadata = vehicle.params.metadata
    names = tuple(vehicle.params.cached) or tuple(metadata)
    notes = ((name, metadata.get(name)) for name in names)
    return [Candidate.noted(name, "" if found is None else found.short_description) for name, found in notes]


async def parameter_assignments(session: Session, before: Sequence[str], word: str) -> Iterable[str]:
    """Complete names of parameters and the named values that their metadata states, in turn."""
    name, mark, _ = word.partition("=")
    if not mark and len(before) % 2 == 0:
        return await parameters(session, before, word)
    values = await _named_values(session, name if mark else before[-1])
    return [Candidate.noted(f"{name}={text}" if mark else text, note) for text, note in values]


async def _named_values(session: Session, name: str) -> list[tuple[str, str]]:
    """Return the named values of a parameter; its metadata is requested once in a session."""
    vehicle = session.selected
    if vehicle is None:
        return []
    key = (vehicle.system, _METADATA_REQUESTED)
    if not vehicle.params.metadata and key not in session.completion_cache:
        session.completion_cache[key] = session.connection.now(), ()
        with suppress(MavstackError):
            await vehicle.params.download_metadata(timeout=LISTING_TIMEOUT)
    found = vehicle.params.metadata.get(name.upper())
    if found is None:
        return []
    labels: dict[Value, str] = {1 << bit: label for bit, label in found.bitmask.items()}
    labels.update(found.values)
    return [(number_text(value), label) for value, label in labels.items()]


async def modes(session: Session, _: Sequence[str], __: str) -> Iterable[str]:
    """Complete flight modes, which the vehicle lists once."""
    vehicle = session.selected
    if vehicle is not None and vehicle.system not in session.listed_modes:
        with suppress(MavstackError, TimeoutError):
            async with asyncio.timeout(LISTING_TIMEOUT):
                await session.list_modes(vehicle)
    return known_modes(session)


async def commands(session: Session, _: Sequence[str], __: str) -> Iterable[str]:
    """Complete commands of the shell."""
    return (*session.commands, *session.aliases)


async def aliases(session: Session, _: Sequence[str], __: str) -> Iterable[str]:
    """Complete aliases of the user."""
    return tuple(session.aliases)


async def settings(_: Session, __: Sequence[str], ___: str) -> Iterable[str]:
    """Complete settings of the shell."""
    return Settings.names()


async def systems(session: Session, _: Sequence[str], __: str) -> Iterable[str]:
    """Complete system ids of vehicles."""
    return tuple(map(str, session.connection.vehicles))


async def outputs(session: Session, _: Sequence[str], __: str) -> Iterable[str]:
    """Complete URLs of outputs."""
    return tuple(output.url for output in session.forwarding.outputs)


async def mav_commands(_: Session, __: Sequence[str], ___: str) -> Iterable[str]:
    """Complete entries of MAV_CMD, without the prefix."""
    return tuple(ardupilotmega.MavCmd.__members__)


async def frames(_: Session, __: Sequence[str], ___: str) -> Iterable[str]:
    """Complete entries of MAV_FRAME, without the prefix."""
    return tuple(common.MavFrame.__members__)


async def messages(_: Session, __: Sequence[str], ___: str) -> Iterable[str]:
    """Complete names of messages."""
    return _message_names()


async def local_files(_: Session, __: Sequence[str], word: str) -> Iterable[str]:
    """Complete paths of local files."""
    return _local_paths(word)


def _local_paths(word: str) -> list[str]:
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
    """Complete paths of files on the vehicle."""
    vehicle = session.selected
    if vehicle is None:
        return ()
    directory = word[: word.rfind("/") + 1]
    key, now = (vehicle.system, directory), session.connection.now()
    known = session.completion_cache.get(key)
    if known is None or now > known[0] + CACHE_DURATION:
        try:
            async with asyncio.timeout(LISTING_TIMEOUT):
                entries = await vehicle.ftp.list(directory or "/")
        except (MavstackError, TimeoutError):
            return ()
        names = tuple(f"{directory}{each.name}{'/' if each.is_directory else ''}" for each in entries)
        session.completion_cache[key] = known = now, names
    return known[1]


@cache
def _message_names() -> tuple[str, ...]:
    return tuple(Dialect.load("all").names)
