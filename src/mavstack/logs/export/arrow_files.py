"""Arrow IPC: a file for each message, which pyarrow, polars, DuckDB, R and Julia map into memory."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any, Final

from mavstack.errors import MissingExtraError
from mavstack.logs.export.registry import LogExporter
from mavstack.logs.export.writer import ExportOptions, PartFile, TableWriter, file_stem

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from mavstack.logs.log import Log
    from mavstack.logs.message_table import MessageTable


class ArrowWriter(TableWriter):
    """Writes an Arrow file for each message."""

    def __init__(self, log: Log, path: Path, options: ExportOptions) -> None:
        super().__init__(log, path, options)
        try:
            self._ipc = import_module("pyarrow.ipc")
        except ImportError:
            raise MissingExtraError("the export to Arrow files", "data") from None
        self._files: dict[str, tuple[PartFile, Any]] = {}

    def write(self, tables: Mapping[str, MessageTable]) -> None:
        """Write the next rows; see `TableWriter.write`."""
        for name, table in tables.items():
            rows = table.to_arrow("lists", scaled=self.options.scaled, enums=self.options.enums)
            if name not in self._files:
                file = PartFile(self.path / f"{file_stem(name)}.arrow")
                self._files[name] = file, self._ipc.new_file(file.temporary, rows.schema)
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


ARROW: Final = LogExporter("arrow", "Arrow IPC, a file for each message", ".arrow", True, ArrowWriter)
