"""Virtual files over a store.

The base is any store. A virtual file is generated when it is opened, so that a client reads one consistent
content, however long that takes; a writable one collects the written data and passes it to its owner when it
is closed, and an error of the owner is reported to the client that closes it. The data of unfinished uploads
is bounded, for each file and in total. The part of the name behind a
`?` is the query ("param.pck?count=10"), if the file takes one. A directory that holds only virtual files can
be listed, but nothing can be stored there. If both have an entry of one name, the virtual one wins.
"""

from __future__ import annotations

from dataclasses import dataclass
from errno import EBADF, EFBIG, EISDIR, ENOSPC, ENOTDIR
from typing import TYPE_CHECKING

from mavstack.services.ftp.entries import Entry
from mavstack.services.ftp.stores import BytesFile, parts_of

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from mavstack.services.ftp.stores import FileStore, OpenFile


#: The largest upload to one virtual file, and the largest size of all unfinished uploads to a store, in
#: bytes.
MAX_UPLOAD, MAX_UPLOADS = 1 << 20, 4 << 20


@dataclass(frozen=True, slots=True)
class VirtualFile:
    """A file that a program generates. `read` and `write` may raise OSError.

    Attributes:
        read: Returns the content for a query (empty if there is none).
        write: Takes the whole content that a client wrote; None makes the file read-only.
        size: Returns the size for listings, if the content is expensive to generate; may be approximate.
        takes_query: True if names with a query belong to this file.
    """

    read: Callable[[str], bytes]
    write: Callable[[bytes], None] | None = None
    size: Callable[[], int] | None = None
    takes_query: bool = False

    def listed_size(self) -> int:
        """Return the size for listings."""
        try:
            return self.size() if self.size is not None else len(self.read(""))
        except OSError:
            return 0


class _Upload:
    """The data that a client writes to a virtual file.

    Args:
        accept: Takes the data when the client closes the file.
        uploads: The unfinished uploads of the store, to which this one belongs until it is closed.
    """

    def __init__(self, accept: Callable[[bytes], None], uploads: set[_Upload]) -> None:
        self._data = bytearray()
        self._file = BytesFile(self._data, self._check_growth)
        self._accept = accept
        self._uploads = uploads
        uploads.add(self)

    def size(self) -> int:
        return len(self._data)

    def read(self, offset: int, size: int) -> bytes:
        raise OSError(EBADF, "the file is open for writing")

    def write(self, offset: int, data: bytes) -> None:
        self._file.write(offset, data)

    def close(self) -> None:
        self._uploads.discard(self)
        self._accept(bytes(self._data))

    def _check_growth(self, growth: int) -> None:
        if self.size() + growth > MAX_UPLOAD:
            raise OSError(EFBIG, "an upload to a generated file must be smaller")
        if sum(upload.size() for upload in self._uploads) + growth > MAX_UPLOADS:
            raise OSError(ENOSPC, "too many unfinished uploads")


class OverlayStore:
    """A store with virtual files."""

    def __init__(self, base: FileStore, files: Mapping[str, VirtualFile] | None = None) -> None:
        self.base = base
        self._files: dict[tuple[str, ...], VirtualFile] = {}
        self._directories: set[tuple[str, ...]] = {()}
        self._uploads: set[_Upload] = set()
        for path, file in (files or {}).items():
            self.add(path, file)

    def add(self, path: str, file: VirtualFile) -> None:
        """Add a virtual file."""
        location = parts_of(path)
        self._files[location] = file
        self._directories.update(location[:length] for length in range(len(location)))

    def list_directory(self, path: str) -> Sequence[Entry]:
        location = parts_of(path)
        if self._find(location) is not None:
            raise NotADirectoryError(ENOTDIR, "a file")
        if location not in self._directories:
            return self.base.list_directory(path)
        entries = {entry.name: entry for entry in self._list_base(path)}
        names = {known[-1] for known in self._directories if known and known[:-1] == location}
        entries.update((name, Entry(name, is_directory=True)) for name in names)
        entries.update(
            (known[-1], Entry(known[-1], size=file.listed_size()))
            for known, file in self._files.items()
            if known[:-1] == location
        )
        return sorted(entries.values(), key=lambda entry: entry.name)

    def open_file(self, path: str, *, write: bool = False, truncate: bool = False) -> OpenFile:
        location = parts_of(path)
        found = self._find(location)
        if found is None:
            if location in self._directories:
                raise IsADirectoryError(EISDIR, "a directory")
            if write:
                self._check_parent(location)
            return self.base.open_file(path, write=write, truncate=truncate)
        file, query = found
        if not write:
            return BytesFile(file.read(query))
        if file.write is None:
            raise PermissionError("generated by the component")
        return _Upload(file.write, self._uploads)

    def remove(self, path: str) -> None:
        self._check_is_real(path)
        self.base.remove(path)

    def rename(self, path: str, to: str) -> None:
        self._check_is_real(path)
        destination = parts_of(to)
        if self._find(destination) is not None or destination in self._directories:
            raise FileExistsError
        self._check_parent(destination)
        self.base.rename(path, to)

    def truncate(self, path: str, size: int) -> None:
        self._check_is_real(path)
        self.base.truncate(path, size)

    def make_directory(self, path: str) -> None:
        location = parts_of(path)
        if self._find(location) is not None or location in self._directories:
            raise FileExistsError
        self._check_parent(location)
        self.base.make_directory(path)

    def remove_directory(self, path: str) -> None:
        self._check_is_real(path)
        self.base.remove_directory(path)

    def _find(self, location: tuple[str, ...]) -> tuple[VirtualFile, str] | None:
        """Return the virtual file of a path, and the query."""
        if not location:
            return None
        plain = self._files.get(location)
        if plain is not None:
            return plain, ""
        name, mark, query = location[-1].partition("?")
        file = self._files.get((*location[:-1], name)) if mark else None
        return (file, query) if file is not None and file.takes_query else None

    def _list_base(self, path: str) -> Sequence[Entry]:
        try:
            return self.base.list_directory(path)
        except (FileNotFoundError, NotADirectoryError):
            return ()

    def _check_is_real(self, path: str) -> None:
        """Refuse to change a virtual file, or a directory that holds some."""
        location = parts_of(path)
        if self._find(location) is not None or location in self._directories:
            raise PermissionError("generated by the component")

    def _check_parent(self, location: tuple[str, ...]) -> None:
        """Refuse to store a file in a directory that only virtual files have."""
        parent = location[:-1]
        if parent in self._directories and not self._base_has_directory(parent):
            raise PermissionError("the directory is generated by the component")

    def _base_has_directory(self, location: tuple[str, ...]) -> bool:
        if not location:
            return True
        try:
            # opened, because listing a directory may take long
            self.base.open_file("/".join(location)).close()
        except IsADirectoryError:
            return True
        except OSError:
            return False
        return False
