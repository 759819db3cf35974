"""The base of export writers: they take a log piece by piece, and leave complete files or none.

A file is written under a temporary name in its folder, and takes its own name when it is complete. An export
that fails or is interrupted leaves nothing behind, and an older file stays as it was.
"""

from __future__ import annotations

import os
from abc import ABC, abstractmethod
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from mavstack.logs.log import Log
    from mavstack.logs.message_table import MessageTable


@dataclass(frozen=True, slots=True)
class ExportOptions:
    """Options of an export.

    Attributes:
        scaled: True writes values in their units, as floating point, with NaN for "unknown"; False writes
            them as they are stored.
        enums: True writes the names of enum values; False writes numbers.
    """

    scaled: bool = False
    enums: bool = False


class PartFile:
    """A file that gets its name when it is complete.

    Args:
        path: Path of the complete file; its folder is made.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        path.parent.mkdir(parents=True, exist_ok=True)
        self.temporary = path.with_name(f".{path.name}-{os.urandom(4).hex()}.part")

    def complete(self) -> Path:
        """Give the file its name, and return it."""
        self.temporary.replace(self.path)
        return self.path

    def discard(self) -> None:
        """Remove the file. Idempotent."""
        with suppress(OSError):
            self.temporary.unlink()


class ExportWriter(ABC):
    """Writes the tables of one log; used by `export_log`.

    Args:
        log: The log, for its schemas and its vehicles.
        path: The file or folder to write.
        options: The options.
    """

    def __init__(self, log: Log, path: Path, options: ExportOptions) -> None:
        self.log = log
        self.path = path
        self.options = options

    @abstractmethod
    def write(self, tables: Mapping[str, MessageTable]) -> None:
        """Write the next rows of some tables.

        Args:
            tables: The rows by name of the table.

        Raises:
            OSError: The file cannot be written.
        """

    @abstractmethod
    def finish(self) -> list[Path]:
        """Complete the files, and return their paths.

        Raises:
            OSError: A file cannot be written.
            LogError: The log has nothing that the format holds.
        """

    @abstractmethod
    def discard(self) -> None:
        """Remove all files of this export that are not complete. Idempotent."""
