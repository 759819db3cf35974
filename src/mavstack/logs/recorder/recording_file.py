"""A file of complete records, in the hands of the system after each write.

The records of one call are one `write` to an unbuffered file, so a program that is killed leaves no partial
record; if the disk is full, the part of a record that was written is cut off again.
"""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from typing import TYPE_CHECKING

from mavstack.errors import LogError

if TYPE_CHECKING:
    from pathlib import Path
    from typing import BinaryIO


class RecordingFile:
    """A new file of records; an existing file is never overwritten.

    Args:
        path: Path of the new file; None: standard output.
        header: The bytes before the first record.

    Attributes:
        path: Path of the file; None: standard output.
        size: Size in bytes.

    Raises:
        LogError: The file exists, or cannot be created.
    """

    def __init__(self, path: Path | None, header: bytes) -> None:
        self.path = path
        self.size = 0
        try:
            self._file = _standard_output() if path is None else path.open("xb", buffering=0)
        except FileExistsError:
            raise LogError(f"{path}: it exists, and a recording never overwrites a file") from None
        except OSError as error:
            raise LogError(f"{path}: {error.strerror or error}") from None
        self.append(header)

    def append(self, records: bytes) -> None:
        """Write complete records.

        Raises:
            LogError: The file cannot be written; it keeps the records before these.
        """
        if not records:
            return
        try:
            written = self._file.write(records)
            if written != len(records):
                raise OSError(f"only {written} of {len(records)} bytes were written")
        except OSError as error:
            self._cut_off()
            name = self.path or "standard output"
            raise LogError(f"{name}: {error.strerror or error}; {self.size} bytes are kept") from None
        self.size += len(records)

    def sync(self) -> None:
        """Wait until the system has stored the file on the disk, so that it survives a loss of power."""
        try:
            os.fsync(self._file.fileno())
        except (OSError, ValueError):
            return  # a pipe, or a file that is already closed

    def close(self) -> None:
        """Close the file. Idempotent."""
        self._file.close()

    def _cut_off(self) -> None:
        """Remove a record that was written partly; a disk that is gone keeps it."""
        if self.path is not None:
            with suppress(OSError):
                self._file.truncate(self.size)
                self._file.seek(self.size)


def _standard_output() -> BinaryIO:
    return os.fdopen(os.dup(sys.stdout.fileno()), "wb", buffering=0)
