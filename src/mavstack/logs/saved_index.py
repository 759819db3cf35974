"""The index of a large log in the user's cache folder, with which a later process need not read all of it.

An index is used if the log has the path, size, time of change, beginning and end that it had, and if Mavstack
has the same version. The file of an index holds a digest of all that and checksums of its content, so that
a stale, truncated or damaged one is not used; the core checks again that it can be an index of the log. Of a
log that changed within the last seconds none is kept: it may change again without a later time of change.

The folder belongs to the user alone, or it is not used; the oldest indexes are removed when it becomes large.
`MAVSTACK_CACHE=0` in the environment turns the cache off. A cache that cannot be read or written is no error.
"""

from __future__ import annotations

import logging
import os
import stat
import time
from contextlib import suppress
from hashlib import blake2b
from struct import Struct
from typing import TYPE_CHECKING, Final, Generic, Literal, TypeAlias, TypeVar
from zlib import crc32

from mavstack.user_directories import cache_directory

if TYPE_CHECKING:
    import mmap
    from collections.abc import Callable
    from pathlib import Path

    from mavstack._core import DataFlashIndex, Index, UlogIndex
    from mavstack.logs.log_bytes import LogBytes

_LOGGER: Final = logging.getLogger("mavstack.logs")
_VARIABLE: Final = "MAVSTACK_CACHE"
#: Minimum size in bytes of a log whose index is kept; a smaller log is indexed in a third of a second.
MIN_LOG: Final = 128 << 20
#: Maximum size in bytes of one index, and of all indexes together.
MAX_INDEX: Final = 256 << 20
MAX_TOTAL: Final = 1 << 30
#: Seconds since the last change of a log, before which no index is saved.
_MIN_AGE: Final = 2.0
#: Seconds after which an incomplete file is removed.
_MAX_PART_AGE: Final = 3600.0
_MAGIC: Final = b"mavstack index 3"
_DIGEST: Final = 32
#: Magic, digest, size of the totals, and the checksums of totals and positions. A digest of these parts would
#: take longer than reading them.
_HEAD: Final = Struct(f"<{len(_MAGIC)}s{_DIGEST}sQII")
_SAMPLE: Final = 1 << 16
_SUFFIX: Final = ".index"
_PART: Final = ".part"
_FORBIDDEN: Final = stat.S_IWGRP | stat.S_IWOTH

IndexT = TypeVar("IndexT", bound="Index | DataFlashIndex | UlogIndex")
#: The bytes of a log.
Data: TypeAlias = "mmap.mmap | bytes"


class SavedIndex(Generic[IndexT]):
    """The index of a log in the cache, in two parts: its totals, and the positions of all records.

    Opening a log reads the totals alone; the positions are read when tables are decoded.

    Args:
        log: The log.
        kind: Facts on which the index depends beside the file, such as the format.
        restore: Makes the index from the bytes that its `save` returned and those of the log; None if they
            are not those of an index.
        build: Makes the index from the bytes of the log.
    """

    def __init__(
        self,
        log: LogBytes,
        kind: str,
        *,
        restore: Callable[[bytes, Data], IndexT | None],
        build: Callable[[Data], IndexT],
    ) -> None:
        self._log, self._kind = log, kind
        self._restore, self._build = restore, build

    def open(self, data: Data) -> IndexT:
        """Return the totals in the cache, or a new index with positions, which is then kept.

        Args:
            data: The bytes of the log.
        """
        index = self._read(data, "totals")
        return self._new(data) if index is None else index

    def complete(self, data: Data) -> IndexT:
        """Return the index with positions: the one in the cache, or a new one, which is then kept.

        Args:
            data: The bytes of the log.
        """
        index = self._read(data, "positions")
        return self._new(data) if index is None else index

    def _read(self, data: Data, part: Literal["totals", "positions"]) -> IndexT | None:
        path = _index_path(self._log, self._kind)
        if path is None:
            return None
        try:
            saved = _read(path, _key(self._log, data, self._kind), part)
        except OSError as error:
            _LOGGER.debug("the saved index of %s cannot be read: %s", self._log.path, error)
            return None
        return None if saved is None else self._restore(saved, data)

    def _new(self, data: Data) -> IndexT:
        index = self._build(data)
        self._log.require_intact()
        path = _index_path(self._log, self._kind)
        if path is not None and index.has_positions and self._is_settled():
            with suppress(OSError):
                key = _key(self._log, data, self._kind)
                _keep(path, key, index.without_positions().save(), index.save())
        return index

    def _is_settled(self) -> bool:
        """Return whether the log has not changed within the last seconds."""
        return time.time() - self._log.modified_ns / 1e9 >= _MIN_AGE


def _index_path(log: LogBytes, kind: str) -> Path | None:
    """Return the file for the index of a log; None if it is not to be kept."""
    if log.size < MIN_LOG or os.environ.get(_VARIABLE) == "0":
        return None
    try:
        name = f"{kind} {log.path.resolve()}".encode(errors="surrogateescape")
        folder = cache_directory() / "indexes"
    except (OSError, RuntimeError):  # no home directory
        return None
    return folder / f"{blake2b(name, digest_size=16).hexdigest()}{_SUFFIX}"


def _key(log: LogBytes, data: Data, kind: str) -> bytes:
    """Return a digest of what distinguishes the content of a log."""
    from mavstack import __version__

    facts = (__version__, kind, str(log.path.resolve()), log.size, log.modified_ns)
    digest = blake2b(repr(facts).encode(errors="surrogateescape"), digest_size=_DIGEST)
    digest.update(data[:_SAMPLE])
    digest.update(data[-_SAMPLE:])
    return digest.digest()


def _read(path: Path, key: bytes, part: Literal["totals", "positions"]) -> bytes | None:
    """Return a part of the file of an index; None if it is none of this log."""
    flags = os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0)
    try:
        descriptor = os.open(path, flags)
    except FileNotFoundError:
        return None
    with os.fdopen(descriptor, "rb", buffering=0) as file:
        status = os.fstat(file.fileno())
        if not (_is_own(status) and _is_own(path.parent.stat()) and stat.S_ISREG(status.st_mode)):
            return None
        if status.st_size > MAX_INDEX:
            return None
        head = file.read(_HEAD.size)
        if len(head) < _HEAD.size:
            return None
        magic, found, size, *checksums = _HEAD.unpack(head)
        if magic != _MAGIC or found != key:
            return None
        if part == "positions":
            file.seek(size, os.SEEK_CUR)
        content = file.read(size) if part == "totals" else file.readall()
    if crc32(content) != checksums[part == "positions"]:
        return None
    os.utime(path)  # mark as used: the oldest indexes are removed first
    return content


def _keep(path: Path, key: bytes, totals: bytes, positions: bytes) -> None:
    """Write the file of an index. Its checksums show if it is complete, so nothing waits for the disk."""
    size = _HEAD.size + len(totals) + len(positions)
    if size > MAX_INDEX:
        return
    part = path.with_name(f".{os.urandom(8).hex()}{_PART}")
    try:
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        if not _is_own(path.parent.stat()):
            return
        _remove_oldest(path.parent, size)
        try:
            with part.open("xb") as file:
                file.write(_HEAD.pack(_MAGIC, key, len(totals), crc32(totals), crc32(positions)))
                file.write(totals)
                file.write(positions)
            part.chmod(0o600)
            part.replace(path)
        finally:
            part.unlink(missing_ok=True)
    except OSError as error:
        _LOGGER.debug("the index of a log is not kept in %s: %s", path.parent, error)


def _remove_oldest(folder: Path, size: int) -> None:
    """Make room for an index of a size, and remove what was never completed."""
    now, left = time.time(), MAX_TOTAL - size
    found = [(entry.stat(), entry) for entry in folder.iterdir()]
    for status, path in sorted(found, key=lambda item: -item[0].st_mtime):
        left -= status.st_size
        outdated = path.suffix == _PART and now - status.st_mtime > _MAX_PART_AGE
        if outdated or (path.suffix == _SUFFIX and left < 0):
            with suppress(OSError):
                path.unlink()


def _is_own(status: os.stat_result) -> bool:
    """Return whether only this user can have written a file or folder."""
    if not hasattr(os, "geteuid"):  # Windows: the folder is in the user's profile
        return True
    return status.st_uid == os.geteuid() and not status.st_mode & _FORBIDDEN
