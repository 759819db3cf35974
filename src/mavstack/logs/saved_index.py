"""The index of a large log in the user's cache folder, with which a later process need not read all of it.

An index is used if the log has the path, size, time of change, beginning and end that it had, and if Mavstack
has the same version. The file of an index holds a digest of all that and a checksum of its content, so that
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
from typing import TYPE_CHECKING, Final, TypeVar
from zlib import crc32

from mavstack.user_directories import cache_directory

if TYPE_CHECKING:
    import mmap
    from collections.abc import Callable
    from pathlib import Path

    from mavstack.logs.log_bytes import LogBytes

_LOGGER: Final = logging.getLogger("mavstack.logs")
_VARIABLE: Final = "MAVSTACK_CACHE"
#: Size of a log in bytes from which its index is kept: a smaller one is indexed in a third of a second.
MIN_LOG: Final = 128 << 20
#: Maximum size of an index, and of all together, in bytes.
MAX_INDEX: Final = 256 << 20
MAX_TOTAL: Final = 1 << 30
#: Seconds for which a log must not have changed.
_MIN_AGE: Final = 2.0
#: Seconds after which a file that was never completed is removed.
_MAX_PART_AGE: Final = 3600.0
_MAGIC: Final = b"mavstack index 2"
_DIGEST: Final = 32
#: Length of a checksum: a CRC, several times as fast as a digest, which would take longer than reading.
_CHECKSUM: Final = 4
_HEAD: Final = len(_MAGIC) + _DIGEST + _CHECKSUM
_SAMPLE: Final = 1 << 16
_SUFFIX: Final = ".index"
_PART: Final = ".part"
_FORBIDDEN: Final = stat.S_IWGRP | stat.S_IWOTH

Index = TypeVar("Index")


def cached_index(
    log: LogBytes,
    data: mmap.mmap | bytes,
    kind: str,
    *,
    restore: Callable[[bytes], Index | None],
    build: Callable[[], Index],
    save: Callable[[Index], bytes | None],
) -> Index:
    """Return the index of a log: that in the cache, or a new one, which is then kept.

    Args:
        log: The log.
        data: Its bytes.
        kind: What the index depends on beside the file, such as the format.
        restore: Makes the index from the bytes that `save` returned; None if they are not those of an index.
        build: Makes the index from the log.
        save: Returns an index as bytes; None if it cannot be saved.
    """
    path = _index_path(log, kind)
    if path is None:
        return build()
    try:
        key = _key(log, data, kind)
        saved = _read(path, key)
    except OSError as error:
        _LOGGER.debug("the saved index of %s cannot be read: %s", log.path, error)
        return build()
    found = None if saved is None else restore(saved)
    if found is not None:
        return found
    index = build()
    if time.time() - log.modified_ns / 1e9 >= _MIN_AGE and (content := save(index)) is not None:
        _keep(path, key, content)
    return index


def _index_path(log: LogBytes, kind: str) -> Path | None:
    """Return the file for the index of a log; None if it is not to be kept."""
    if log.size < MIN_LOG or os.environ.get(_VARIABLE) == "0":
        return None
    try:
        name = f"{kind} {log.path.resolve()}".encode(errors="surrogateescape")
        folder = cache_directory() / "indexes"
    except (OSError, RuntimeError):  # there is no home directory
        return None
    return folder / f"{blake2b(name, digest_size=16).hexdigest()}{_SUFFIX}"


def _key(log: LogBytes, data: mmap.mmap | bytes, kind: str) -> bytes:
    """Return a digest of what distinguishes the content of a log."""
    from mavstack import __version__

    facts = (__version__, kind, str(log.path.resolve()), log.size, log.modified_ns)
    digest = blake2b(repr(facts).encode(errors="surrogateescape"), digest_size=_DIGEST)
    digest.update(data[:_SAMPLE])
    digest.update(data[-_SAMPLE:])
    return digest.digest()


def _read(path: Path, key: bytes) -> bytes | None:
    """Return the content of the file of an index; None if it is none of this log."""
    flags = os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0)
    try:
        descriptor = os.open(path, flags)
    except FileNotFoundError:
        return None
    with os.fdopen(descriptor, "rb") as file:
        status = os.fstat(file.fileno())
        if not (_is_own(status) and _is_own(path.parent.stat()) and stat.S_ISREG(status.st_mode)):
            return None
        if status.st_size > MAX_INDEX:
            return None
        head = file.read(_HEAD)
        if head[:-_CHECKSUM] != _MAGIC + key:
            return None
        content = file.read()
    if _checksum(content) != head[-_CHECKSUM:]:
        return None
    os.utime(path)  # the indexes that are not used are the oldest
    return content


def _keep(path: Path, key: bytes, content: bytes) -> None:
    """Write the file of an index. Its checksum tells if it is complete, so nothing waits for the disk."""
    if len(content) + _HEAD > MAX_INDEX:
        return
    part = path.with_name(f".{os.urandom(8).hex()}{_PART}")
    try:
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        if not _is_own(path.parent.stat()):
            return
        _remove_oldest(path.parent, len(content))
        try:
            with part.open("xb") as file:
                file.write(_MAGIC + key + _checksum(content))
                file.write(content)
            part.chmod(0o600)
            part.replace(path)
        finally:
            part.unlink(missing_ok=True)
    except OSError as error:
        _LOGGER.debug("the index of a log is not kept in %s: %s", path.parent, error)


def _checksum(content: bytes) -> bytes:
    return crc32(content).to_bytes(_CHECKSUM, "little")


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
    if not hasattr(os, "geteuid"):  # Windows: the folder is below that of the user
        return True
    return status.st_uid == os.geteuid() and not status.st_mode & _FORBIDDEN
