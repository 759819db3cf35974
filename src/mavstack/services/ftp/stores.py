"""File stores: what an FTP server gives access to, by paths with "/" between their parts.

A store raises OSError like the functions of the operating system. `MemoryStore` keeps files in memory;
`DirectoryStore`, in its own module, is a directory on disk.
"""

from __future__ import annotations

import os
from errno import EINVAL, EISDIR, ENAMETOOLONG, ENOENT, ENOSPC, ENOTEMPTY, EPERM
from typing import TYPE_CHECKING, Protocol

from mavstack.services.ftp.entries import Entry

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

MAX_NAME_LENGTH = 255


class OpenFile(Protocol):
    """An open file of a session."""

    def size(self) -> int:
        """Return its size in bytes."""

    def read(self, offset: int, size: int) -> bytes:
        """Return up to `size` bytes from an offset on; none past the end."""

    def write(self, offset: int, data: bytes) -> None:
        """Write data at an offset, which may lie past the end."""

    def close(self) -> None:
        """Close the file."""


class FileStore(Protocol):
    """Files and directories by path; all methods may raise OSError."""

    def list_directory(self, path: str) -> Sequence[Entry]:
        """Return the entries of a directory, always in the same order."""

    def open_file(self, path: str, *, write: bool = False, truncate: bool = False) -> OpenFile:
        """Open a file; for writing it is created if it does not exist."""

    def remove(self, path: str) -> None:
        """Remove a file."""

    def rename(self, path: str, to: str) -> None:
        """Rename or move a file or directory."""

    def truncate(self, path: str, size: int) -> None:
        """Set the size of a file."""

    def make_directory(self, path: str) -> None:
        """Create a directory."""

    def remove_directory(self, path: str) -> None:
        """Remove an empty directory."""


def parts_of(path: str) -> tuple[str, ...]:
    """Split a path below the root; raises OSError if it leads out."""
    parts = tuple(part for part in path.split("/") if part not in ("", "."))
    for part in parts:
        if part == ".." or "\0" in part or (os.sep != "/" and any(sign in part for sign in '\\:*?"<>|')):
            raise OSError(EPERM, "not below the root")
        if len(os.fsencode(part)) > MAX_NAME_LENGTH:
            raise OSError(ENAMETOOLONG, "the name is too long")
    return parts


class BytesFile:
    """A file in memory; `room` raises OSError if there is no room for a growth in bytes."""

    def __init__(self, data: bytearray | bytes, room: Callable[[int], None] = lambda growth: None) -> None:
        self._data = data if isinstance(data, bytearray) else bytearray(data)
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
        """Do nothing: there is no resource."""


#: The largest size of a file in memory, bytes.
MAX_MEMORY_FILE_SIZE = 64 << 20


def resize(data: bytearray, size: int) -> None:
    """Truncate, or extend with zeros."""
    if size > MAX_MEMORY_FILE_SIZE:
        raise OSError(EINVAL, "too long")
    del data[size:]
    data.extend(bytes(size - len(data)))


#: The bytes of all files in a store in memory, unless the program gives another capacity.
DEFAULT_MEMORY_CAPACITY = 64 << 20
#: The number of files and directories in a store with a capacity.
MAX_ENTRIES = 4096


class MemoryStore:
    """Files in memory.

    Args:
        files: The content of files by path ("logs/1.bin").
        virtual: Read-only files that are generated when they are opened.
        capacity: The number of bytes of all files together; None sets no limit.
    """

    def __init__(
        self,
        files: Mapping[str, bytes] | None = None,
        virtual: Mapping[str, Callable[[], bytes]] | None = None,
        *,
        capacity: int | None = DEFAULT_MEMORY_CAPACITY,
    ) -> None:
        self.capacity = capacity
        self._files: dict[tuple[str, ...], bytearray] = {}
        self._virtual = {parts_of(path): make for path, make in (virtual or {}).items()}
        self._directories: set[tuple[str, ...]] = {()}
        for location in self._virtual:
            self._make_parents(location)
        for path, data in (files or {}).items():
            self[path] = data

    def __getitem__(self, path: str) -> bytes:
        return bytes(self._files[parts_of(path)])

    def __setitem__(self, path: str, data: bytes) -> None:
        location = parts_of(path)
        self._make_parents(location)
        self._files[location] = bytearray(data)

    def __contains__(self, path: str) -> bool:
        return parts_of(path) in self._files

    def list_directory(self, path: str) -> Sequence[Entry]:
        location = parts_of(path)
        if location not in self._directories:
            raise FileNotFoundError
        inside = [Entry(known[-1], True) for known in self._directories if known and known[:-1] == location]
        inside += [
            Entry(known[-1], size=len(data)) for known, data in self._files.items() if known[:-1] == location
        ]
        inside += [
            Entry(known[-1], size=len(make()))
            for known, make in self._virtual.items()
            if known[:-1] == location
        ]
        return sorted(inside, key=lambda entry: entry.name)

    def open_file(self, path: str, *, write: bool = False, truncate: bool = False) -> OpenFile:
        location = parts_of(path)
        if location in self._virtual:
            if write:
                raise PermissionError
            return BytesFile(self._virtual[location]())
        if location in self._directories:
            raise OSError(EISDIR, "not a file")
        if write and location[:-1] in self._directories and location not in self._files:
            self._make_room()
            self._files[location] = bytearray()
        data = self._file(location)
        if truncate:
            data.clear()
        return BytesFile(data, lambda growth: self._check_growth(data, growth))

    def remove(self, path: str) -> None:
        location = parts_of(path)
        # cleared, because an open file would keep memory that the capacity no longer counts
        self._file(location).clear()
        del self._files[location]

    def rename(self, path: str, to: str) -> None:
        source, destination = parts_of(path), parts_of(to)
        if destination in self._files or destination in self._directories or destination in self._virtual:
            raise FileExistsError
        if destination[:-1] not in self._directories:
            raise FileNotFoundError
        if source in self._directories:
            self._rename_directory(source, destination)
        else:
            self._file(source)
            self._files[destination] = self._files.pop(source)

    def _rename_directory(self, source: tuple[str, ...], destination: tuple[str, ...]) -> None:
        depth = len(source)
        if not depth or any(location[:depth] == source for location in self._virtual):
            raise PermissionError
        if destination[:depth] == source:
            raise OSError(EINVAL, "a directory cannot be moved into itself")
        inside = [location for location in self._files if location[:depth] == source]
        self._files.update({(*destination, *known[depth:]): self._files.pop(known) for known in inside})
        self._directories = {
            (*destination, *known[depth:]) if known[:depth] == source else known
            for known in self._directories
        }

    def truncate(self, path: str, size: int) -> None:
        data = self._file(parts_of(path))
        self._make_room(max(size - len(data), 0))
        resize(data, size)

    def make_directory(self, path: str) -> None:
        location = parts_of(path)
        if location in self._directories or location in self._files:
            raise FileExistsError
        if location[:-1] not in self._directories:
            raise FileNotFoundError
        self._make_room()
        self._directories.add(location)

    def remove_directory(self, path: str) -> None:
        location = parts_of(path)
        if not location or location not in self._directories:
            raise OSError(EPERM, "the root") if not location else FileNotFoundError
        if any(
            known[:-1] == location for known in (*self._files, *self._directories, *self._virtual) if known
        ):
            raise OSError(ENOTEMPTY, "not empty")
        self._directories.discard(location)

    def _file(self, location: tuple[str, ...]) -> bytearray:
        if location not in self._files:
            raise PermissionError if location in self._virtual else FileNotFoundError
        return self._files[location]

    def _check_growth(self, data: bytearray, growth: int) -> None:
        if growth and not any(known is data for known in self._files.values()):
            raise FileNotFoundError(ENOENT, "the file was removed")
        self._make_room(growth)

    def _make_room(self, growth: int = 0) -> None:
        if self.capacity is None:
            return
        used = sum(map(len, self._files.values()))
        if growth > self.capacity - used or len(self._files) + len(self._directories) >= MAX_ENTRIES:
            raise OSError(ENOSPC, "the store is full")

    def _make_parents(self, location: tuple[str, ...]) -> None:
        self._directories.update(location[:length] for length in range(len(location)))
