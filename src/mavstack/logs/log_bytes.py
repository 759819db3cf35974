"""The bytes of a log file, which another process may truncate or rewrite at any time.

Reading a mapped byte beyond the end of a truncated file kills the process (SIGBUS), and no check of the size
before the access prevents it. Therefore the mapping is read only under a read lease: Linux grants one while
no descriptor is open for writing, and makes a process that wants to truncate or write wait until the lease is
released. Where no lease is granted (a log that is still being written, a file of another user, a network file
system, another Unix) the bytes are copied: those of a small file into memory, those of a large one into a
temporary file without a name, which is mapped. Windows refuses to truncate a mapped file.
"""

from __future__ import annotations

import mmap
import os
import signal
import stat
import sys
import tempfile
import weakref
from contextlib import contextmanager
from pathlib import Path
from threading import Lock
from typing import TYPE_CHECKING, Final

from mavstack._core import MappingGuard
from mavstack.errors import LogError
from mavstack.logs.mapped_pages import release

if TYPE_CHECKING:
    from collections.abc import Iterator

#: Maximum size for a lease: it ends 45 s after another process opens the file, and reading a larger file
#: might take longer.
_MAX_LEASED_SIZE: Final = 1 << 32
_READ_SIZE: Final = 1 << 26
#: Maximum size in bytes of a copy that is kept in memory.
_MAX_MEMORY: Final = 1 << 26
#: Flags against blocking on a FIFO without a writer, and against a serial port as the controlling terminal.
_OPEN_FLAGS: Final = (
    os.O_RDONLY
    | getattr(os, "O_BINARY", 0)
    | getattr(os, "O_CLOEXEC", 0)
    | getattr(os, "O_NOCTTY", 0)
    | getattr(os, "O_NONBLOCK", 0)
)


class LogBytes:
    """A regular file, mapped or read into memory.

    Args:
        path: Path of the file.

    Attributes:
        path: Path of the file.
        size: Size of the file in bytes when it was opened.
        modified_ns: Time of its last change then, in nanoseconds since 1970.

    Raises:
        LogError: The file cannot be opened, or is not a regular file.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._lock = Lock()
        try:
            self._descriptor = os.open(path, _OPEN_FLAGS)
        except (OSError, ValueError) as error:
            raise LogError(f"cannot open {path}: {getattr(error, 'strerror', None) or error}") from error
        weakref.finalize(self, os.close, self._descriptor)
        status = os.fstat(self._descriptor)
        if not stat.S_ISREG(status.st_mode) and not _is_null_device(status):
            raise LogError(f"cannot open {path}: not a regular file")
        self.size, self.modified_ns = status.st_size, status.st_mtime_ns
        self._map: mmap.mmap | None = None
        self._guard: MappingGuard | None = None
        self._copy: mmap.mmap | bytes | None = None if self.size else b""

    @contextmanager
    def access(self) -> Iterator[mmap.mmap | bytes]:
        """Give access to the bytes for the length of a block, in which they can be read safely.

        Yields:
            The bytes: the mapped file, or its copy once no lease was granted.

        Raises:
            LogError: The file was truncated, or cannot be read, also where the disk failed in the block.
        """
        with self._lock:
            try:
                with self._held() as data:
                    yield data
            finally:
                self._end_access()

    @contextmanager
    def _held(self) -> Iterator[mmap.mmap | bytes]:
        """Give access to the bytes, under a lease if one is granted."""
        if self._copy is not None:
            yield self._copy
        elif self.size <= _MAX_LEASED_SIZE and _take_lease(self._descriptor):
            try:
                yield self._mapped()
            finally:
                _release_lease(self._descriptor)
        else:
            self._copy = self._read()
            yield self._copy

    def require_intact(self) -> None:
        """Raise if bytes could not be read since the access began, before its results are kept.

        Raises:
            LogError: The disk failed, or the file was truncated.
        """
        if self._guard is not None and self._guard.failed:
            raise LogError(
                f"cannot read {self.path}: the disk failed or the file was truncated while it was read; "
                "copy the file to another disk and open the copy"
            )

    def _end_access(self) -> None:
        try:
            self.require_intact()
        except LogError:
            # The mapping now contains zeros, so the next access maps the file again.
            self._map = self._guard = None
            self._copy = None if self.size else b""
            raise

    def _map_descriptor(self, descriptor: int) -> mmap.mmap:
        """Map a file and guard the mapping."""
        data = mmap.mmap(descriptor, self.size, access=mmap.ACCESS_READ)
        self._guard = MappingGuard(data)
        return data

    def release(self) -> None:
        """Release the memory of the mapped file; a later access reads it again."""
        with self._lock:
            for data in (self._map, self._copy):
                if data is not None:
                    release(data, 0, self.size)

    def read_into(self, offset: int, buffer: memoryview) -> None:
        """Copy bytes of the file into a buffer; the rest of the file needs no memory.

        Args:
            offset: Offset in the file, in bytes.
            buffer: The buffer, which is filled completely.

        Raises:
            LogError: The file was truncated, or cannot be read.
        """
        done = 0
        try:
            with self._lock, open(self._descriptor, "rb", buffering=0, closefd=False) as file:
                file.seek(offset)
                while done < len(buffer) and (count := file.readinto(buffer[done:])):
                    done += count
        except OSError as error:
            raise LogError(f"cannot read {self.path}: {error.strerror or error}") from error
        if done < len(buffer):
            raise self._truncated()

    def read(self, offset: int, size: int) -> bytes:
        """Return bytes of the file, up to its end; see `read_into`.

        Args:
            offset: Offset in the file, in bytes.
            size: Maximum number of bytes.

        Raises:
            LogError: The file was truncated, or cannot be read.
        """
        try:
            with self._lock:
                return b"".join(self._pieces(offset, max(min(size, self.size - offset), 0)))
        except OSError as error:
            raise LogError(f"cannot read {self.path}: {error.strerror or error}") from error

    def _mapped(self) -> mmap.mmap:
        # No process can change the size while the lease is held.
        if os.fstat(self._descriptor).st_size < self.size:
            raise self._truncated()
        if self._map is None:
            try:
                self._map = self._map_descriptor(self._descriptor)
            except (OSError, ValueError) as error:
                raise LogError(f"cannot map {self.path}: {error}") from error
        return self._map

    def _read(self) -> mmap.mmap | bytes:
        if self.size > _MAX_MEMORY:
            return self._temporary()
        try:
            return b"".join(self._pieces(0, self.size))
        except (OSError, MemoryError) as error:
            raise LogError(f"cannot read {self.path}: {error or 'not enough memory'}") from error

    def _temporary(self) -> mmap.mmap:
        """Return the bytes of a file without a name, which no other process can open."""
        try:
            with tempfile.TemporaryFile() as copy:
                for piece in self._pieces(0, self.size):
                    copy.write(piece)
                copy.flush()
                return self._map_descriptor(copy.fileno())
        except OSError as error:
            reason = f"it may change, and cannot be copied to {tempfile.gettempdir()}"
            raise LogError(f"cannot read {self.path}: {reason}: {error.strerror or error}") from error

    def _pieces(self, offset: int, left: int) -> Iterator[bytes]:
        """Yield `left` bytes from `offset` on."""
        with open(self._descriptor, "rb", buffering=0, closefd=False) as file:
            file.seek(offset)
            while left and (piece := file.read(min(left, _READ_SIZE))):
                yield piece
                left -= len(piece)
        if left:
            raise self._truncated()

    def _truncated(self) -> LogError:
        return LogError(f"cannot read {self.path}: it was truncated since it was opened; open it again")


def _is_null_device(status: os.stat_result) -> bool:
    return stat.S_ISCHR(status.st_mode) and os.path.samestat(status, Path(os.devnull).stat())


if sys.platform == "linux":
    from fcntl import F_RDLCK, F_SETLEASE, F_SETSIG, F_UNLCK, fcntl

    def _take_lease(descriptor: int) -> bool:
        """Return whether a lease was granted, under which other processes cannot change the file.

        SIGIO, the default signal to a holder, would end this process; SIGURG is ignored. The kernel forgets
        the choice with each lease that is released.
        """
        try:
            fcntl(descriptor, F_SETSIG, signal.SIGURG)
            fcntl(descriptor, F_SETLEASE, F_RDLCK)
        except OSError:
            return False
        return True

    def _release_lease(descriptor: int) -> None:
        fcntl(descriptor, F_SETLEASE, F_UNLCK)

else:

    def _take_lease(descriptor: int) -> bool:
        """Return whether a mapping is safe without a lease."""
        return sys.platform == "win32"

    def _release_lease(descriptor: int) -> None:
        """Do nothing: no lease was taken."""
