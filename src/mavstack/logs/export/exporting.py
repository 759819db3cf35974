"""The export of a log: its tables go to a writer piece by piece, in bounded memory."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from mavstack.errors import LogError
from mavstack.logs.export.registry import exporter
from mavstack.logs.export.writer import ExportOptions

if TYPE_CHECKING:
    import os
    from collections.abc import Callable, Mapping, Sequence
    from typing import Any

    from mavstack.logs.damage import LogDamage
    from mavstack.logs.export.registry import LogExporter
    from mavstack.logs.export.writer import ExportWriter
    from mavstack.logs.log import Log


@dataclass(frozen=True, slots=True)
class ExportSummary:
    """The result of an export.

    Attributes:
        rows: Number of rows written, by table.
        files: Paths of the files.
        skipped: Counts of everything in the log that was not read.
        description: What was written, such as "200 rows of 8 messages" or "50 points of 2 vehicles".
    """

    rows: Mapping[str, int]
    files: Sequence[Path]
    skipped: LogDamage
    description: str

    def to_dict(self) -> dict[str, Any]:
        """Return the result as values that JSON can hold."""
        return {
            "description": self.description,
            "rows": dict(sorted(self.rows.items())),
            "files": [str(path) for path in self.files],
            "skipped": self.skipped.to_dict(),
        }


def export_log(
    log: Log,
    to: str | LogExporter,
    path: str | os.PathLike[str],
    *,
    names: Sequence[str] = (),
    options: ExportOptions | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> ExportSummary:
    """Write a log in the format of other programs.

    Args:
        log: The log, or a view of it.
        to: Name of the format, such as "parquet" (see `exporter_names`), or a format of another package.
        path: The file or, for formats with a file for each message, the folder.
        names: Names of the tables to write; none: all.
        options: Options; None takes the default ones.
        progress: Called with the bytes of the log that were read, and with its size.

    Returns:
        The rows and the files that were written, and what the log holds that could not be read.

    Raises:
        InvalidArgumentError: There is no such format.
        UnknownMessageError: The log has no table of one of the names.
        MissingExtraError: The format needs a library that is not installed.
        LogError: The log cannot be read, it has nothing that the format holds, or a file cannot be written.
    """
    log.prepare_windows()
    for name in names:
        log.schema(name)  # raises an error if the table does not exist
    if Path(path).exists() and log.path.exists() and Path(path).samefile(log.path):
        raise LogError(f"cannot write {path}: it is the log itself; choose another path")
    writer: ExportWriter | None = None
    try:
        chosen = exporter(to) if isinstance(to, str) else to
        writer = chosen.open(log, Path(path), options or ExportOptions())
        rows = writer.write_log(names, progress)
        files = writer.finish()
    except OSError as error:
        raise LogError(f"cannot write {error.filename or path}: {error.strerror or error}") from error
    finally:
        if writer is not None:
            writer.discard()
    return ExportSummary(dict(rows), files, log.skipped, writer.describe(rows))
