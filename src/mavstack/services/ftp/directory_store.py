"""A file store in a directory on disk, which it never leaves.

A path is resolved part by part, each relative to the open handle of the directory before it and without
following links; the target of a link is resolved in the same way, and `..` in it goes back to the handle
before. A directory that is exchanged for a link at any time therefore leads nowhere outside. Removing and
renaming apply to a link itself. Only regular files are opened, so that no call blocks.

Where the operating system cannot open relative to a handle (Windows), the resolved path is compared with the
root.
"""

from __future__ import annotations

import os
import stat
from contextlib import contextmanager
from errno import EEXIST, EISDIR, ELOOP, EMLINK, ENOENT, ENOTDIR, EPERM
from pathlib import Path
from typing import TYPE_CHECKING

from mavstack.services.ftp.entries import Entry
from mavstack.services.ftp.quota import Quota
from mavstack.services.ftp.stores import parts_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from mavstack.services.ftp.stores import OpenFile

#: The largest size of all files together in bytes, unless the program sets another capacity.
DEFAULT_CAPACITY = 1 << 30
#: The largest number of files and directories, unless the program sets another one.
DEFAULT_MAX_ENTRIES = 16384
MAX_LINKS = 16

_HANDLES = {os.open, os.stat, os.unlink, os.rename, os.mkdir, os.rmdir, os.readlink} <= os.supports_dir_fd
_FLAGS = (
    getattr(os, "O_NOFOLLOW", 0)
    | getattr(os, "O_NONBLOCK", 0)
    | getattr(os, "O_BINARY", 0)
    | getattr(os, "O_CLOEXEC", 0)
)
_DIRECTORY = os.O_RDONLY | _FLAGS | getattr(os, "O_DIRECTORY", 0)
#: The errors of opening a symbolic link as a directory without following it; they depend on the operating
#: system.
_NOT_A_DIRECTORY = frozenset({ENOTDIR, ELOOP, EMLINK})


class DirectoryStore:
    """A directory on disk, and nothing outside of it.

    Args:
        root: The directory, which must exist.
        capacity: The bytes of all files together, beyond which nothing is created and no file grows; None
            sets no limit.
        max_entries: The number of files and directories with a capacity.
    """

    def __init__(
        self,
        root: str | os.PathLike[str],
        *,
        capacity: int | None = DEFAULT_CAPACITY,
        max_entries: int = DEFAULT_MAX_ENTRIES,
    ) -> None:
        self.root = Path(root).resolve(strict=True)
        self._roots = (self.root, Path(os.path.abspath(root)))  # noqa: PTH100 (links stay as they are)
        self._quota = Quota(self.root, capacity, max_entries)

    def list_directory(self, path: str) -> Sequence[Entry]:
        with self._directory(parts_of(path)) as handle, os.scandir(handle) as found:
            items = sorted(found, key=lambda item: item.name)
            return [self._entry(item, parts_of(path)) for item in items]

    def open_file(self, path: str, *, write: bool = False, truncate: bool = False) -> OpenFile:
        with self._located(parts_of(path), follow=True) as (handle, name):
            is_new = write and not _exists(name, handle)
            self._quota.check_growth(0, is_new)
            flags = _FLAGS | (os.O_RDWR | os.O_CREAT if write else os.O_RDONLY)
            descriptor = os.open(name, flags, 0o666, dir_fd=handle)
        try:
            known = os.fstat(descriptor)
            if not stat.S_ISREG(known.st_mode):
                raise OSError(EISDIR, "not a file")
            self._quota.changed(0, is_new)
            if truncate:
                os.ftruncate(descriptor, 0)
                self._quota.changed(-known.st_size)
            return _DiskFile(descriptor, self._quota, write=write)
        except OSError:
            os.close(descriptor)
            raise

    def remove(self, path: str) -> None:
        with self._located(parts_of(path)) as (handle, name):
            known = os.stat(name, dir_fd=handle, follow_symlinks=False)
            if stat.S_ISDIR(known.st_mode):
                raise OSError(EISDIR, "a directory")
            os.unlink(name, dir_fd=handle)
            self._quota.removed(known)

    def rename(self, path: str, to: str) -> None:
        with self._located(parts_of(path)) as (source, name), self._located(parts_of(to)) as (target, new):
            if _exists(new, target):
                raise FileExistsError(EEXIST, "it exists")
            os.rename(name, new, src_dir_fd=source, dst_dir_fd=target)

    def truncate(self, path: str, size: int) -> None:
        with self._located(parts_of(path), follow=True) as (handle, name):
            descriptor = os.open(name, os.O_WRONLY | _FLAGS, dir_fd=handle)
        try:
            known = os.fstat(descriptor)
            if not stat.S_ISREG(known.st_mode):
                raise OSError(EISDIR, "not a file")
            self._quota.check_growth(size - known.st_size)
            os.ftruncate(descriptor, size)
            self._quota.changed(size - known.st_size)
        finally:
            os.close(descriptor)

    def make_directory(self, path: str) -> None:
        with self._located(parts_of(path)) as (handle, name):
            if _exists(name, handle):
                raise FileExistsError(EEXIST, "it exists")
            self._quota.check_growth(0, 1)
            os.mkdir(name, dir_fd=handle)
            self._quota.changed(0, 1)

    def remove_directory(self, path: str) -> None:
        with self._located(parts_of(path)) as (handle, name):
            if stat.S_ISLNK(os.stat(name, dir_fd=handle, follow_symlinks=False).st_mode):
                raise OSError(ENOTDIR, "not a directory")
            os.rmdir(name, dir_fd=handle)
            self._quota.changed(0, -1)

    @contextmanager
    def _located(self, parts: Sequence[str], *, follow: bool = False) -> Iterator[tuple[int | None, str]]:
        """Resolve a path to the handle of a directory and a name in it; `follow` a link of that name."""
        if not parts:
            raise OSError(EPERM, "the root directory")
        if not _HANDLES:
            yield None, str(self._resolved(parts, follow=follow))
            return
        walk = _Walk(self._roots)
        try:
            yield walk.last_handle(parts, follow=follow)
        finally:
            walk.close()

    @contextmanager
    def _directory(self, parts: Sequence[str]) -> Iterator[int | str]:
        """Resolve a path to the handle of a directory, or to its path where there are no handles."""
        if not _HANDLES or os.scandir not in os.supports_fd:
            yield str(self._resolved(parts, follow=True))
            return
        walk = _Walk(self._roots)
        try:
            walk.enter(parts)
            yield walk.handle
        finally:
            walk.close()

    def _resolved(self, parts: Sequence[str], *, follow: bool) -> Path:
        """Resolve a path by its names, where there are no handles."""
        last = parts[len(parts) if follow else -1 :]
        folder = Path(os.path.realpath(self.root.joinpath(*parts[: len(parts) - len(last)])))
        if not folder.is_relative_to(self.root):
            raise OSError(EPERM, "not below the root")
        return folder.joinpath(*last)

    def _entry(self, item: os.DirEntry[str], parts: tuple[str, ...]) -> Entry:
        """Return an entry; an empty name is sent as a skip."""
        try:
            known = item.stat(follow_symlinks=False)
            if stat.S_ISLNK(known.st_mode):
                known = self._target(item, parts)
        except OSError:
            return Entry("")
        if stat.S_ISDIR(known.st_mode):
            return Entry(item.name, is_directory=True, modified=int(known.st_mtime))
        return Entry(
            item.name if stat.S_ISREG(known.st_mode) else "", False, known.st_size, int(known.st_mtime)
        )

    def _target(self, item: os.DirEntry[str], parts: tuple[str, ...]) -> os.stat_result:
        """Return the properties of the file or directory that a link leads to."""
        with self._located((*parts, item.name), follow=True) as (handle, name):
            return os.stat(name, dir_fd=handle, follow_symlinks=False)


class _Walk:
    """The open directories from the root to the current one."""

    def __init__(self, roots: Sequence[Path]) -> None:
        self._roots = roots
        self._handles = [os.open(roots[0], os.O_RDONLY | getattr(os, "O_DIRECTORY", 0))]
        self._links = 0

    @property
    def handle(self) -> int:
        """The handle of the current directory."""
        return self._handles[-1]

    def close(self) -> None:
        """Close all handles."""
        for handle in self._handles:
            os.close(handle)
        self._handles = []

    def enter(self, parts: Sequence[str]) -> None:
        """Enter the directory with this path, relative to the current one."""
        pending = list(reversed(parts))
        while pending:
            name = pending.pop()
            if name == "..":
                self._leave()
                continue
            try:
                self._handles.append(os.open(name, _DIRECTORY, dir_fd=self.handle))
            except OSError as error:
                if error.errno not in _NOT_A_DIRECTORY:
                    raise
                pending += reversed(self._link_parts(name))

    def last_handle(self, parts: Sequence[str], *, follow: bool) -> tuple[int, str]:
        """Enter the directory that holds the last part; return its handle and the name in it."""
        pending = list(parts)
        while True:
            *before, name = pending
            self.enter(before)
            if name == "..":
                self._leave()
                return self.handle, "."
            if not follow or not self._is_link(name):
                return self.handle, name
            pending = list(self._link_parts(name))
            if not pending:
                return self.handle, "."

    def _is_link(self, name: str) -> bool:
        try:
            return stat.S_ISLNK(os.stat(name, dir_fd=self.handle, follow_symlinks=False).st_mode)
        except FileNotFoundError:
            return False

    def _link_parts(self, name: str) -> Sequence[str]:
        """Return the parts of the target of a link, relative to the current directory.

        A link with an absolute target below the root continues at the root.
        """
        try:
            target = os.readlink(name, dir_fd=self.handle)
        except OSError:
            raise NotADirectoryError(ENOTDIR, "not a directory") from None
        self._links += 1
        if self._links > MAX_LINKS:
            raise OSError(ELOOP, "too many links")
        if target.startswith("/"):
            target = self._below_root(target)
            for handle in self._handles[1:]:
                os.close(handle)
            del self._handles[1:]
        return [part for part in target.split("/") if part not in ("", ".")]

    def _below_root(self, target: str) -> str:
        for root in self._roots:
            if Path(target).is_relative_to(root):
                return str(Path(target).relative_to(root))
        raise OSError(EPERM, "not below the root")

    def _leave(self) -> None:
        if len(self._handles) == 1:
            raise OSError(EPERM, "not below the root")
        os.close(self._handles.pop())


class _DiskFile:
    """A regular file on disk."""

    def __init__(self, descriptor: int, quota: Quota, *, write: bool) -> None:
        self._file = os.fdopen(descriptor, "r+b" if write else "rb", buffering=0)
        self._quota = quota
        quota.opened(os.fstat(descriptor))

    def size(self) -> int:
        return os.fstat(self._file.fileno()).st_size

    def read(self, offset: int, size: int) -> bytes:
        self._file.seek(offset)
        return self._file.read(size) or b""

    def write(self, offset: int, data: bytes) -> None:
        known = os.fstat(self._file.fileno())
        if not known.st_nlink:
            raise OSError(ENOENT, "the file was removed")
        before = known.st_size
        self._quota.check_growth(offset + len(data) - before)
        try:
            self._file.seek(offset)
            rest = memoryview(data)
            while rest:
                rest = rest[self._file.write(rest) or 0 :]
        finally:
            self._quota.changed(self.size() - before)

    def close(self) -> None:
        if not self._file.closed:
            known = os.fstat(self._file.fileno())
            self._file.close()
            self._quota.closed(known)


def _exists(name: str, handle: int | None) -> bool:
    try:
        os.stat(name, dir_fd=handle, follow_symlinks=False)
    except FileNotFoundError:
        return False
    return True
