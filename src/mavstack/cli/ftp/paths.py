"""Paths on a vehicle: patterns, whole trees, and what their names may become on this machine.

Names come from the other end of a link. One that would lead out of the directory that was asked for, or that
this machine cannot have, is never used for a local file.
"""

from __future__ import annotations

from fnmatch import fnmatchcase
from typing import TYPE_CHECKING, NamedTuple

from mavstack.errors import FileDenied, MavstackError
from mavstack.services.ftp import Entry

if TYPE_CHECKING:
    from collections.abc import AsyncIterator

    from mavstack.node.ftp import Ftp

#: No file system of a vehicle is deeper; a directory that holds itself is.
DEEPEST = 32
_WILD = frozenset("*?[")
_FORBIDDEN = frozenset('/\\:*?"<>|')


class Found(NamedTuple):
    """An entry of the vehicle and where it lies."""

    path: str
    entry: Entry


def join(directory: str, name: str) -> str:
    """The path of an entry."""
    return f"{directory.rstrip('/')}/{name}"


def split(path: str) -> tuple[str, str]:
    """The directory of a path and its last name."""
    directory, slash, name = path.rstrip("/").rpartition("/")
    return directory or ("/" if slash else ""), name


def is_pattern(path: str) -> bool:
    """Whether a path holds `*`, `?` or `[`; behind a virtual file (@…) a `?` begins what is asked of it."""
    return not path.startswith("@") and not _WILD.isdisjoint(path)


async def find(files: Ftp, path: str) -> list[Found]:
    """What a path or a pattern stands for; a pattern may stand for nothing."""
    if not is_pattern(path):
        return [Found(path, await look_up(files, path))]
    directory, name = split(path)
    places = [directory]
    if is_pattern(directory):
        places = [each.path for each in await find(files, directory) if each.entry.is_directory]
    found = []
    for place in places:
        entries = sorted(await files.list(place or "/"), key=lambda entry: entry.name)
        found += [Found(join(place, each.name), each) for each in entries if fnmatchcase(each.name, name)]
    return found


async def look_up(files: Ftp, path: str) -> Entry:
    """A file or a directory by its path; raises `FileDenied`. A virtual file (@…) has no size yet."""
    directory, name = split(path)
    if not name:
        return Entry("/", is_directory=True)
    if not path.startswith("@"):
        for entry in await files.list(directory or "/"):
            if entry.name == name:
                return entry
    try:
        await files.list(path)
    except FileDenied:
        if path.startswith("@"):
            return Entry(name.partition("?")[0])
        raise
    return Entry(name, is_directory=True)


async def walk(files: Ftp, top: Found, depth: int = 0) -> AsyncIterator[Found]:
    """An entry and all below it, a directory before what is in it."""
    yield top
    if top.entry.is_directory:
        if depth >= DEEPEST:
            raise MavstackError(f"{top.path}: directories lie too deep in each other")
        for entry in await files.list(top.path):
            async for found in walk(files, Found(join(top.path, entry.name), entry), depth + 1):
                yield found


def local_name(name: str) -> str:
    """A name as a local file may have it; raises if it cannot."""
    bad = name in ("", ".", "..") or name[-1] in ". " or not _FORBIDDEN.isdisjoint(name)
    if bad or any(letter < " " for letter in name):
        raise MavstackError(f"{name!r} cannot be the name of a local file; give one")
    return name
