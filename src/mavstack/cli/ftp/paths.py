"""Paths on a vehicle: patterns, directory trees, and local names.

The names come from the remote end of a link. A name that would lead out of the target directory, or that is
not allowed on this machine, is never used for a local file.
"""

from __future__ import annotations

from fnmatch import fnmatchcase
from typing import TYPE_CHECKING, NamedTuple

from mavstack.cli.common.errors import CommandError
from mavstack.errors import FileDenied
from mavstack.services.ftp import Entry

if TYPE_CHECKING:
    from collections.abc import AsyncIterator

    from mavstack.cli.ftp.limited import LimitedFtp

#: Maximum depth of a directory tree; only a directory that contains itself is deeper.
MAX_DEPTH = 32
_WILD = frozenset("*?[")
_FORBIDDEN = frozenset('/\\:*?"<>|')


class RemotePath(NamedTuple):
    """A file or a directory on the vehicle with its path."""

    path: str
    entry: Entry


def join(directory: str, name: str) -> str:
    """Return the path of an entry of a directory."""
    return f"{directory.rstrip('/')}/{name}"


def split(path: str) -> tuple[str, str]:
    """Return the directory of a path and its last name."""
    directory, slash, name = path.rstrip("/").rpartition("/")
    return directory or ("/" if slash else ""), name


def is_pattern(path: str) -> bool:
    """Return whether a path holds `*`, `?` or `[`; in a virtual file (@…) a `?` begins the query."""
    return not path.startswith("@") and not _WILD.isdisjoint(path)


async def find(ftp: LimitedFtp, path: str) -> list[RemotePath]:
    """List the files and directories that a path or a pattern matches; a pattern may match none."""
    if not is_pattern(path):
        return [RemotePath(path, await look_up(ftp, path))]
    directory, name = split(path)
    directories = [directory]
    if is_pattern(directory):
        directories = [each.path for each in await find(ftp, directory) if each.entry.is_directory]
    found = []
    for parent in directories:
        entries = sorted(await ftp.list(parent or "/"), key=lambda entry: entry.name)
        found += [
            RemotePath(join(parent, each.name), each) for each in entries if fnmatchcase(each.name, name)
        ]
    return found


async def look_up(ftp: LimitedFtp, path: str) -> Entry:
    """Return the entry of a path. A virtual file (@…) has no size yet.

    Raises:
        FileDenied: There is no such file or directory.
    """
    directory, name = split(path)
    if not name:
        return Entry("/", is_directory=True)
    if not path.startswith("@"):
        for entry in await ftp.list(directory or "/"):
            if entry.name == name:
                return entry
    try:
        await ftp.list(path)
    except FileDenied:
        if path.startswith("@"):
            return Entry(name.partition("?")[0])
        raise
    return Entry(name, is_directory=True)


async def walk(ftp: LimitedFtp, top: RemotePath) -> AsyncIterator[RemotePath]:
    """Yield an entry and all entries below it, each directory before its contents.

    Raises:
        CommandError: There are more entries than `--max-entries`, or the directories are nested too deeply.
    """
    waiting, count = [(top, 0)], 0
    while waiting:
        found, depth = waiting.pop()
        count += 1
        if count > ftp.max_entries:
            raise CommandError(
                f"{top.path} has more than the {ftp.max_entries} entries allowed; --max-entries allows more"
            )
        yield found
        if found.entry.is_directory:
            if depth >= MAX_DEPTH:
                raise CommandError(f"{found.path}: the directories are nested too deeply")
            entries = [RemotePath(join(found.path, each.name), each) for each in await ftp.list(found.path)]
            waiting += [(each, depth + 1) for each in reversed(entries)]


def local_name(name: str) -> str:
    """Return a name if a local file may have it; raise `CommandError` otherwise."""
    bad = name in ("", ".", "..") or name[-1] in ". " or not _FORBIDDEN.isdisjoint(name)
    if bad or any(letter < " " for letter in name):
        raise CommandError(f"{name!r} cannot be the name of a local file; name the local file yourself")
    return name
