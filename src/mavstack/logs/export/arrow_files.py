"""Arrow IPC: a file for each message, which pyarrow, polars, DuckDB, R and Julia map into memory."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any, Final

from mavstack.errors import MissingExtraError
from mavstack.logs.export.registry import LogExporter
from mavstack.logs.export.writer import ExportOptions, TableFilesWriter

if TYPE_CHECKING:
    from pathlib import Path

    from mavstack.logs.log import Log


class ArrowWriter(TableFilesWriter):
    """Writes an Arrow file for each message."""

    suffix = ".arrow"
    arrays = "lists"

    def __init__(self, log: Log, path: Path, options: ExportOptions) -> None:
        super().__init__(log, path, options)
        try:
            self._ipc = import_module("pyarrow.ipc")
        except ImportError:
            raise MissingExtraError("the export to Arrow files", "data") from None

    def open_file(self, path: Path, schema: Any) -> Any:  # noqa: ANN401 (pyarrow has no types)
        """Open a file; see `TableFilesWriter.open_file`."""
        return self._ipc.new_file(path, schema)


ARROW: Final = LogExporter("arrow", "Arrow IPC, a file for each message", ".arrow", True, ArrowWriter)
