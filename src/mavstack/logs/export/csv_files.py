"""CSV: a file for each message, with a column for each element of an array field.

Times are in UTC by ISO 8601; values that are not known are empty. Texts that spreadsheets would run as
formulas have an apostrophe before them, unless the option `raw_text` keeps them.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any, Final

from mavstack.errors import MissingExtraError
from mavstack.logs.export.csv_text import escape_columns
from mavstack.logs.export.registry import LogExporter
from mavstack.logs.export.writer import ExportOptions, TableFilesWriter

if TYPE_CHECKING:
    from pathlib import Path

    from mavstack.logs.log import Log


class CsvWriter(TableFilesWriter):
    """Writes a CSV file for each message."""

    suffix = ".csv"
    arrays = "columns"

    def __init__(self, log: Log, path: Path, options: ExportOptions) -> None:
        super().__init__(log, path, options)
        try:
            self._csv = import_module("pyarrow.csv")
        except ImportError:
            raise MissingExtraError("the export to CSV", "data") from None

    def prepared(self, rows: Any) -> Any:  # noqa: ANN401 (pyarrow has no types)
        """Return rows whose texts no spreadsheet takes as formulas."""
        return rows if self.options.raw_text else escape_columns(rows)

    def open_file(self, path: Path, schema: Any) -> Any:  # noqa: ANN401 (pyarrow has no types)
        """Open a file; see `TableFilesWriter.open_file`."""
        return self._csv.CSVWriter(path, schema)


CSV: Final = LogExporter("csv", "CSV, a file for each message", ".csv", True, CsvWriter)
