"""The cache of metadata files in the user's cache folder.

A file that a component names with a CRC is kept under that CRC, as it was served, and verified when it is
read again; so a vehicle sends it once for each version of its firmware. A file that a user named for vehicles
that serve none is kept under the key of their firmware.

The cache is bounded, files are written completely or not at all, and a cache that cannot be read or written
is no error: the file is downloaded again.
"""

from __future__ import annotations

import logging
import re
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Final

from mavstack.atomic_file import write_file_atomically
from mavstack.bounded_file import read_file_bounded
from mavstack.errors import MetadataError
from mavstack.services.component_metadata import MAX_CONTENT, has_crc
from mavstack.user_directories import cache_directory

if TYPE_CHECKING:
    import os
    from collections.abc import Iterator

_LOGGER: Final = logging.getLogger("mavstack.files")
#: Maximum number of cached files; the oldest ones are removed.
MAX_FILES: Final = 100
_SUFFIX: Final = ".metadata"
_KEY: Final = re.compile(r"[a-z0-9._-]{1,80}")


class MetadataCache:
    """Metadata files on disk.

    Args:
        directory: The folder; None: `metadata` in `cache_directory()`.
    """

    def __init__(self, directory: str | os.PathLike[str] | None = None) -> None:
        self._directory = None if directory is None else Path(directory)

    @property
    def directory(self) -> Path:
        """The folder of the files; it may not exist yet."""
        return cache_directory() / "metadata" if self._directory is None else self._directory

    def find_crc(self, kind: int, crc: int) -> bytes | None:
        """Return the file of a COMP_METADATA_TYPE with a CRC; None if there is none."""
        data = self.find(_crc_key(kind, crc))
        with suppress(MetadataError):
            if data is not None and has_crc(data, crc):
                return data
        return None

    def store_crc(self, kind: int, crc: int, data: bytes) -> None:
        """Keep the file of a COMP_METADATA_TYPE with a CRC."""
        self.store(_crc_key(kind, crc), data)

    def newest(self, kind: int, count: int) -> list[bytes]:
        """Return the newest files of a COMP_METADATA_TYPE, at most `count`, the newest one first."""
        try:
            by_age = sorted(self._ages(), reverse=True)
        except RuntimeError:  # the home directory is unknown
            return []
        keys = [path.name.removesuffix(_SUFFIX) for _, path in by_age]
        own = [key for key in keys if key.startswith(_crc_prefix(kind))]
        return [data for key in own[:count] if (data := self.find(key)) is not None]

    def find(self, key: str) -> bytes | None:
        """Return the file of a key; None if there is none."""
        path = self._path(key)
        try:
            data = b"" if path is None else read_file_bounded(path, MAX_CONTENT + 1)
        except OSError:
            return None
        return data if 0 < len(data) <= MAX_CONTENT else None

    def store(self, key: str, data: bytes) -> None:
        """Keep a file under a key, and remove the oldest ones if there are too many."""
        path = self._path(key)
        if path is None:
            return
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            write_file_atomically(path, data)
            self._prune()
        except OSError as error:
            _LOGGER.info("the metadata cache cannot be written: %s", error)

    def _path(self, key: str) -> Path | None:
        try:
            return self.directory / f"{key}{_SUFFIX}" if _KEY.fullmatch(key) else None
        except RuntimeError:  # the home directory is unknown
            return None

    def _prune(self) -> None:
        by_age = sorted(self._ages(), reverse=True)
        for _, path in by_age[MAX_FILES:]:
            path.unlink(missing_ok=True)

    def _ages(self) -> Iterator[tuple[float, Path]]:
        """Yield the time of writing and the path of each file."""
        for path in self.directory.glob(f"*{_SUFFIX}"):
            with suppress(OSError):
                yield path.stat().st_mtime, path


def _crc_key(kind: int, crc: int) -> str:
    return f"{_crc_prefix(kind)}{crc:08x}"


def _crc_prefix(kind: int) -> str:
    return f"type{int(kind)}-"
