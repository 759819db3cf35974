"""The base of export writers: they take a log piece by piece, and leave complete files or none.

A file is written under a temporary name in its folder, and takes its own name when it is complete. An export
that fails or is interrupted leaves nothing behind, and an older file stays as it was.
"""

from __future__ import annotations

import os
from abc import ABC, abstractmethod
from collections import Counter
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, TypeAlias
from urllib.parse import quote

from mavstack.errors import LogError

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from pathlib import Path
    from typing import Any

    from mavstack.logs.log import Log
    from mavstack.logs.message_table import Arrays, MessageTable

    #: Called with the number of bytes of the log that were read, and with the size of the log.
    Progress: TypeAlias = Callable[[int, int], None] | None

#: Characters of table names that are kept in file names, besides letters, digits and `_.-~`.
_SAFE: Final = " []:"
#: Bytes of a log that are decoded at a time; writers hold several copies of their rows.
_WINDOW: Final = 4 << 20


@dataclass(frozen=True, slots=True)
class ExportOptions:
    """Options of an export.

    Attributes:
        scaled: True writes values in their units, as floating point, with NaN for "unknown"; False writes
            them as they are stored.
        enums: True writes the names of enum values; False writes numbers.
        raw_text: True keeps texts in CSV files which spreadsheets run as formulas; False writes an apostrophe
            before them.
    """

    scaled: bool = False
    enums: bool = False
    raw_text: bool = False


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
    """Writes one log; used by `export_log`. Formats of tables derive from `TableWriter`.

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
    def write_log(self, names: Sequence[str], progress: Progress) -> Mapping[str, int]:
        """Write the log.

        Args:
            names: Names of the tables to write; none: all.
            progress: Called with the bytes of the log that were read, and with its size.

        Returns:
            Number of rows that were written, by name of the table.

        Raises:
            OSError: The file cannot be written.
            LogError: The log cannot be read, or has nothing that the format holds.
        """

    def describe(self, rows: Mapping[str, int]) -> str:
        """Return what was written, such as "200 rows of 8 messages".

        Args:
            rows: The result of `write_log`.
        """
        return f"{counted(sum(rows.values()), 'row')} of {counted(len(rows), 'message')}"

    @abstractmethod
    def finish(self) -> list[Path]:
        """Complete the files, and return their paths.

        Raises:
            OSError: A file cannot be written.
        """

    @abstractmethod
    def discard(self) -> None:
        """Remove all files of this export that are not complete. Idempotent."""


class TableWriter(ExportWriter):
    """Writes the tables of a log, piece by piece."""

    def write_log(self, names: Sequence[str], progress: Progress) -> Mapping[str, int]:
        """Write the tables; see `ExportWriter.write_log`."""
        rows: Counter[str] = Counter()
        for tables in self.log.windows(_WINDOW, names or None, progress=progress):
            self.write(tables)
            rows.update({name: len(table) for name, table in tables.items()})
        if not rows:
            raise nothing_to_write(self.log)
        return rows

    @abstractmethod
    def write(self, tables: Mapping[str, MessageTable]) -> None:
        """Write the next rows of some tables.

        Args:
            tables: The rows by name of the table.

        Raises:
            OSError: The file cannot be written.
        """


def nothing_to_write(log: Log) -> LogError:
    """Return the error about a log without any row."""
    return LogError(f"{log.path}: there is nothing to write; skipped: {log.skipped.describe()}")


class TableFilesWriter(TableWriter):
    """Writes a file for each table. A format implements `open_file`, and sets `suffix` and `arrays`."""

    suffix = ""
    arrays: Arrays = "lists"

    def __init__(self, log: Log, path: Path, options: ExportOptions) -> None:
        super().__init__(log, path, options)
        self._files: dict[str, tuple[PartFile, Any]] = {}

    @abstractmethod
    def open_file(self, path: Path, schema: Any) -> Any:  # noqa: ANN401 (pyarrow has no types)
        """Open a file whose object has `write_table` and `close`.

        Args:
            path: The file.
            schema: The Arrow schema of the table.
        """

    def prepared(self, rows: Any) -> Any:  # noqa: ANN401 (as above)
        """Return rows as the format holds them."""
        return rows

    def write(self, tables: Mapping[str, MessageTable]) -> None:
        """Write the next rows; see `TableWriter.write`."""
        for name, table in tables.items():
            rows = table.to_arrow(self.arrays, scaled=self.options.scaled, enums=self.options.enums)
            rows = self.prepared(rows)
            if name not in self._files:
                file = PartFile(self.path / f"{file_stem(name)}{self.suffix}")
                self._files[name] = file, self.open_file(file.temporary, rows.schema)
            self._files[name][1].write_table(rows)

    def finish(self) -> list[Path]:
        """Complete the files; see `ExportWriter.finish`."""
        for _, writer in self._files.values():
            writer.close()
        return [file.complete() for file, _ in self._files.values()]

    def discard(self) -> None:
        """Remove incomplete files; see `ExportWriter.discard`."""
        for file, writer in self._files.values():
            writer.close()
            file.discard()


def file_stem(table: str) -> str:
    """Return the name of a table as part of a file's name.

    A log names its tables itself: a name such as `../../x` must not lead out of the folder. Characters that
    separate folders are escaped as in URLs, so different tables have different files.
    """
    return quote(table, safe=_SAFE)


def counted(count: int, noun: str) -> str:
    """Return a number with its noun, such as "1,234 points"."""
    return f"{count:,} {noun}{'' if count == 1 else 's'}"
