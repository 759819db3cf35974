"""Virtual files beside real ones: a store laid over another.

The base is any store. A virtual file is made when it is opened, so that who reads it sees one moment, however
long that takes; one that can be written gathers what comes and hands it over whole when it is closed, and
what its owner refuses there is told to whoever closes. What follows a `?` in its name is the file's query
("param.pck?count=10"), if it takes one. A directory that holds virtual files only is as good as any other for
listing, but nothing can be put there. Where both have something of one name, the virtual one is seen.
"""

from __future__ import annotations

from dataclasses import dataclass
from errno import EBADF, EISDIR, ENOTDIR
from typing import TYPE_CHECKING

from mavstack.services.ftp.entries import Entry
from mavstack.services.ftp.stores import BytesFile, parts_of

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from mavstack.services.ftp.stores import FileStore, OpenFile


@dataclass(frozen=True, slots=True)
class VirtualFile:
    """A file made by a program: `read` gets the query (empty if there is none) and gives the content.

    `write` takes the whole content that someone wrote; both may raise OSError. `size` is what a listing says,
    for contents that are dear to make: it need not be exact.
    """

    read: Callable[[str], bytes]
    write: Callable[[bytes], None] | None = None
    size: Callable[[], int] | None = None
    takes_query: bool = False

    def listed_size(self) -> int:
        """How long a listing says it is."""
        try:
            return self.size() if self.size is not None else len(self.read(""))
        except OSError:
            return 0


class _Upload:
    """What is being written to a virtual file."""

    def __init__(self, take: Callable[[bytes], None]) -> None:
        self._data = bytearray()
        self._file = BytesFile(self._data)
        self._take = take

    def size(self) -> int:
        return len(self._data)

    def read(self, offset: int, size: int) -> bytes:
        raise OSError(EBADF, "it is being written")

    def write(self, offset: int, data: bytes) -> None:
        self._file.write(offset, data)

    def close(self) -> None:
        self._take(bytes(self._data))


class OverlayStore:
    """A store, and virtual files over it."""

    def __init__(self, base: FileStore, files: Mapping[str, VirtualFile] | None = None) -> None:
        self.base = base
        self._files: dict[tuple[str, ...], VirtualFile] = {}
        self._directories: set[tuple[str, ...]] = {()}
        for path, file in (files or {}).items():
            self.add(path, file)

    def add(self, path: str, file: VirtualFile) -> None:
        """Lay a virtual file over the base."""
        place = parts_of(path)
        self._files[place] = file
        self._directories.update(place[:length] for length in range(len(place)))

    def list_directory(self, path: str) -> Sequence[Entry]:
        place = parts_of(path)
        if self._find(place) is not None:
            raise NotADirectoryError(ENOTDIR, "a file")
        if place not in self._directories:
            return self.base.list_directory(path)
        entries = {entry.name: entry for entry in self._listed_in_base(path)}
        names = {known[-1] for known in self._directories if known and known[:-1] == place}
        entries.update((name, Entry(name, is_directory=True)) for name in names)
        entries.update(
            (known[-1], Entry(known[-1], size=file.listed_size()))
            for known, file in self._files.items()
            if known[:-1] == place
        )
        return sorted(entries.values(), key=lambda entry: entry.name)

    def open_file(self, path: str, *, write: bool = False, truncate: bool = False) -> OpenFile:
        place = parts_of(path)
        found = self._find(place)
        if found is None:
            if place in self._directories:
                raise IsADirectoryError(EISDIR, "a directory")
            if write:
                self._check_parent(place)
            return self.base.open_file(path, write=write, truncate=truncate)
        file, query = found
        if not write:
            return BytesFile(bytearray(file.read(query)))
        if file.write is None:
            raise PermissionError("it is made by the component")
        return _Upload(file.write)

    def remove(self, path: str) -> None:
        self._check_is_real(path)
        self.base.remove(path)

    def rename(self, path: str, to: str) -> None:
        self._check_is_real(path)
        goal = parts_of(to)
        if self._find(goal) is not None or goal in self._directories:
            raise FileExistsError
        self._check_parent(goal)
        self.base.rename(path, to)

    def truncate(self, path: str, size: int) -> None:
        self._check_is_real(path)
        self.base.truncate(path, size)

    def make_directory(self, path: str) -> None:
        place = parts_of(path)
        if self._find(place) is not None or place in self._directories:
            raise FileExistsError
        self._check_parent(place)
        self.base.make_directory(path)

    def remove_directory(self, path: str) -> None:
        self._check_is_real(path)
        self.base.remove_directory(path)

    def _find(self, place: tuple[str, ...]) -> tuple[VirtualFile, str] | None:
        """The virtual file that a path names, and its query."""
        if not place:
            return None
        plain = self._files.get(place)
        if plain is not None:
            return plain, ""
        name, mark, query = place[-1].partition("?")
        file = self._files.get((*place[:-1], name)) if mark else None
        return (file, query) if file is not None and file.takes_query else None

    def _listed_in_base(self, path: str) -> Sequence[Entry]:
        try:
            return self.base.list_directory(path)
        except (FileNotFoundError, NotADirectoryError):
            return ()

    def _check_is_real(self, path: str) -> None:
        """Refuse to change a virtual file, or a directory that holds some."""
        place = parts_of(path)
        if self._find(place) is not None or place in self._directories:
            raise PermissionError("it is made by the component")

    def _check_parent(self, place: tuple[str, ...]) -> None:
        """Refuse to put something where the base has no directory and only virtual files are."""
        parent = place[:-1]
        if parent in self._directories:
            try:
                self.base.list_directory("/".join(parent))
            except (FileNotFoundError, NotADirectoryError):
                raise PermissionError("the directory is made by the component") from None
