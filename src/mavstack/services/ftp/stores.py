"""What a server gives access to: a store of files, behind paths whose parts are separated by "/".

A store raises OSError, as the functions of the operating system do. `DirectoryStore` stands for a directory
and never leaves it: no `..`, no absolute path of the system, no NUL, no symbolic link that leads out; what
is removed or renamed is the link, not what it points to. Only regular files are opened, so that nothing
blocks. `MemoryStore` keeps files in memory and makes virtual ones when they are opened.
"""

from __future__ import annotations

import os
import stat
from errno import EINVAL, EISDIR, ENAMETOOLONG, ENOENT, ENOSPC, ENOTDIR, ENOTEMPTY, EPERM
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from mavstack.services.ftp.entries import Entry

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

LONGEST_NAME = 255
_FLAGS = getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)


class OpenFile(Protocol):
    """A file while a session holds it."""

    def size(self) -> int:
        """How long it is."""

    def read(self, offset: int, size: int) -> bytes:
        """Some of it; nothing past its end."""

    def write(self, offset: int, data: bytes) -> None:
        """Put data at a place, behind its end too."""

    def close(self) -> None:
        """Let it go."""


class FileStore(Protocol):
    """Files and directories by path; refuses by OSError."""

    def list_directory(self, path: str) -> Sequence[Entry]:
        """What is in a directory, in the same order each time."""

    def open_file(self, path: str, *, write: bool = False, truncate: bool = False) -> OpenFile:
        """Open a file; for writing it is created if need be."""

    def remove(self, path: str) -> None:
        """Remove a file."""

    def rename(self, path: str, to: str) -> None:
        """Move a file or directory."""

    def truncate(self, path: str, size: int) -> None:
        """Make a file that long."""

    def make_directory(self, path: str) -> None:
        """Make a directory."""

    def remove_directory(self, path: str) -> None:
        """Remove an empty directory."""


def parts_of(path: str) -> tuple[str, ...]:
    """The parts of a path below the root; raises for one that would lead out."""
    parts = tuple(part for part in path.split("/") if part not in ("", "."))
    for part in parts:
        if part == ".." or "\0" in part or (os.sep != "/" and any(sign in part for sign in '\\:*?"<>|')):
            raise OSError(EPERM, "not below the root")
        if len(os.fsencode(part)) > LONGEST_NAME:
            raise OSError(ENAMETOOLONG, "the name is too long")
    return parts


class _DiskFile:
    """A regular file of the system."""

    def __init__(self, descriptor: int) -> None:
        self._file = os.fdopen(descriptor, "r+b" if _may_write(descriptor) else "rb", buffering=0)

    def size(self) -> int:
        return os.fstat(self._file.fileno()).st_size

    def read(self, offset: int, size: int) -> bytes:
        self._file.seek(offset)
        return self._file.read(size) or b""

    def write(self, offset: int, data: bytes) -> None:
        self._file.seek(offset)
        rest = memoryview(data)
        while rest:
            rest = rest[self._file.write(rest) or 0 :]

    def close(self) -> None:
        self._file.close()


def _may_write(descriptor: int) -> bool:
    try:
        os.write(descriptor, b"")
    except OSError:
        return False
    return True


class DirectoryStore:
    """A directory of the system, and nothing outside of it."""

    def __init__(self, root: str | os.PathLike[str]) -> None:
        self.root = Path(root).resolve(strict=True)

    def list_directory(self, path: str) -> Sequence[Entry]:
        with os.scandir(self._inside(path)) as found:
            return [self._entry(item) for item in sorted(found, key=lambda item: item.name)]

    def open_file(self, path: str, *, write: bool = False, truncate: bool = False) -> OpenFile:
        place = self._inside(path)
        if place.exists() and not place.is_file():
            raise OSError(EISDIR, "not a file")
        flags = _FLAGS | (os.O_RDWR | os.O_CREAT if write else os.O_RDONLY)
        descriptor = os.open(place, flags, 0o666)
        try:
            if not stat.S_ISREG(os.fstat(descriptor).st_mode):
                raise OSError(EISDIR, "not a file")
            if truncate:
                os.ftruncate(descriptor, 0)
            return _DiskFile(descriptor)
        except OSError:
            os.close(descriptor)
            raise

    def remove(self, path: str) -> None:
        place = self._itself(path)
        if place.is_dir() and not place.is_symlink():
            raise OSError(EISDIR, "a directory")
        place.unlink()

    def rename(self, path: str, to: str) -> None:
        source, goal = self._itself(path), self._itself(to)
        if goal.exists() or goal.is_symlink():
            raise FileExistsError
        source.rename(goal)

    def truncate(self, path: str, size: int) -> None:
        place = self._inside(path)
        if not place.is_file():
            raise FileNotFoundError if not place.exists() else OSError(EISDIR, "not a file")
        os.truncate(place, size)

    def make_directory(self, path: str) -> None:
        self._itself(path).mkdir()

    def remove_directory(self, path: str) -> None:
        place = self._itself(path)
        if place.is_symlink():
            raise OSError(ENOTDIR, "not a directory")
        place.rmdir()

    def _inside(self, path: str) -> Path:
        """Where a path leads, links followed."""
        place = Path(os.path.realpath(self.root.joinpath(*parts_of(path))))
        if not place.is_relative_to(self.root):
            raise OSError(EPERM, "not below the root")
        return place

    def _itself(self, path: str) -> Path:
        """What a path names, links in its directories followed and itself not."""
        parts = parts_of(path)
        if not parts:
            raise OSError(EPERM, "the root itself")
        return self._inside("/".join(parts[:-1])) / parts[-1]

    def _entry(self, item: os.DirEntry[str]) -> Entry:
        """An entry; one without a name is a skip."""
        try:
            place = Path(os.path.realpath(item.path))
            known = place.stat() if place.is_relative_to(self.root) else None
        except OSError:
            known = None
        if known is None:
            return Entry("")
        if stat.S_ISDIR(known.st_mode):
            return Entry(item.name, is_directory=True, modified=int(known.st_mtime))
        return Entry(
            item.name if stat.S_ISREG(known.st_mode) else "", False, known.st_size, int(known.st_mtime)
        )


class BytesFile:
    """A file in memory."""

    def __init__(self, data: bytearray, room: Callable[[int], None] = lambda growth: None) -> None:
        self._data = data
        self._room = room

    def size(self) -> int:
        return len(self._data)

    def read(self, offset: int, size: int) -> bytes:
        return bytes(self._data[offset : offset + size])

    def write(self, offset: int, data: bytes) -> None:
        self._room(max(offset + len(data) - len(self._data), 0))
        resize(self._data, max(len(self._data), offset))
        self._data[offset : offset + len(data)] = data

    def close(self) -> None:
        """Nothing is held."""


#: A file in memory is not made longer than this by others.
LONGEST_IN_MEMORY = 64 << 20


def resize(data: bytearray, size: int) -> None:
    """Cut or fill with zeros."""
    if size > LONGEST_IN_MEMORY:
        raise OSError(EINVAL, "too long")
    del data[size:]
    data.extend(bytes(size - len(data)))


#: A store of limited capacity holds so many files and directories.
MOST_ENTRIES = 4096


class MemoryStore:
    """Files in memory by path ("logs/1.bin"), and virtual ones, made when opened and for reading only.

    With a `capacity` it can be full, as a memory card can: all its files together hold so many bytes.
    """

    def __init__(
        self,
        files: Mapping[str, bytes] | None = None,
        virtual: Mapping[str, Callable[[], bytes]] | None = None,
        *,
        capacity: int | None = None,
    ) -> None:
        self.capacity = capacity
        self._files: dict[tuple[str, ...], bytearray] = {}
        self._virtual = {parts_of(path): make for path, make in (virtual or {}).items()}
        self._directories: set[tuple[str, ...]] = {()}
        for place in self._virtual:
            self._make_parents(place)
        for path, data in (files or {}).items():
            self[path] = data

    def __getitem__(self, path: str) -> bytes:
        return bytes(self._files[parts_of(path)])

    def __setitem__(self, path: str, data: bytes) -> None:
        place = parts_of(path)
        self._make_parents(place)
        self._files[place] = bytearray(data)

    def __contains__(self, path: str) -> bool:
        return parts_of(path) in self._files

    def list_directory(self, path: str) -> Sequence[Entry]:
        place = parts_of(path)
        if place not in self._directories:
            raise FileNotFoundError
        inside = [Entry(known[-1], True) for known in self._directories if known and known[:-1] == place]
        inside += [
            Entry(known[-1], size=len(data)) for known, data in self._files.items() if known[:-1] == place
        ]
        inside += [
            Entry(known[-1], size=len(make())) for known, make in self._virtual.items() if known[:-1] == place
        ]
        return sorted(inside, key=lambda entry: entry.name)

    def open_file(self, path: str, *, write: bool = False, truncate: bool = False) -> OpenFile:
        place = parts_of(path)
        if place in self._virtual:
            if write:
                raise PermissionError
            return BytesFile(bytearray(self._virtual[place]()))
        if place in self._directories:
            raise OSError(EISDIR, "not a file")
        if write and place[:-1] in self._directories and place not in self._files:
            self._make_room()
            self._files[place] = bytearray()
        data = self._file(place)
        if truncate:
            data.clear()
        return BytesFile(data, self._make_room)

    def remove(self, path: str) -> None:
        place = parts_of(path)
        self._file(place)
        del self._files[place]

    def rename(self, path: str, to: str) -> None:
        source, goal = parts_of(path), parts_of(to)
        if goal in self._files or goal in self._directories or goal in self._virtual:
            raise FileExistsError
        if source in self._directories or goal[:-1] not in self._directories:
            raise OSError(EINVAL if source in self._directories else ENOENT, "cannot be moved there")
        self._file(source)
        self._files[goal] = self._files.pop(source)

    def truncate(self, path: str, size: int) -> None:
        data = self._file(parts_of(path))
        self._make_room(max(size - len(data), 0))
        resize(data, size)

    def make_directory(self, path: str) -> None:
        place = parts_of(path)
        if place in self._directories or place in self._files:
            raise FileExistsError
        if place[:-1] not in self._directories:
            raise FileNotFoundError
        self._make_room()
        self._directories.add(place)

    def remove_directory(self, path: str) -> None:
        place = parts_of(path)
        if not place or place not in self._directories:
            raise OSError(EPERM, "the root") if not place else FileNotFoundError
        if any(known[:-1] == place for known in (*self._files, *self._directories, *self._virtual) if known):
            raise OSError(ENOTEMPTY, "not empty")
        self._directories.discard(place)

    def _file(self, place: tuple[str, ...]) -> bytearray:
        if place not in self._files:
            raise PermissionError if place in self._virtual else FileNotFoundError
        return self._files[place]

    def _make_room(self, growth: int = 0) -> None:
        if self.capacity is None:
            return
        used = sum(map(len, self._files.values()))
        if growth > self.capacity - used or len(self._files) + len(self._directories) >= MOST_ENTRIES:
            raise OSError(ENOSPC, "the store is full")

    def _make_parents(self, place: tuple[str, ...]) -> None:
        self._directories.update(place[:length] for length in range(len(place)))
