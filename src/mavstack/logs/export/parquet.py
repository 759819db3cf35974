"""Parquet: a dataset of many flights, partitioned by vehicle, date and message.

    OUT/vehicle=1/date=2026-11-22/message=ATTITUDE/flight-4f9a1c20d3-0.parquet

DuckDB, Spark, Dask, polars and pandas read such a folder as one table with the columns `vehicle`, `date` and
`message`, and skip the files that a query does not need. The date is that of the beginning of the log, so
that a flight over midnight stays together. Every log has files of its own, whose name comes from its content:
logs can be added at any time and by several programs at once, and a log that is exported again replaces its
files. Units, enums and the origin of the definitions are in the metadata of each column and file.
"""

from __future__ import annotations

import json
from concurrent.futures import ThreadPoolExecutor
from importlib import import_module
from itertools import accumulate
from typing import TYPE_CHECKING, Any, Final

from mavstack.errors import MissingExtraError
from mavstack.logs.export.flights import by_vehicle, flight_date, flight_name
from mavstack.logs.export.registry import LogExporter
from mavstack.logs.export.writer import ExportOptions, PartFile, TableWriter, file_stem

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from mavstack.logs.log import Log
    from mavstack.logs.message_table import MessageTable

#: System id and name of the table.
Key = tuple[int, str]

#: Number of rows in a row group, which readers skip or read as a whole.
_GROUP_ROWS: Final = 1 << 16
#: Maximum size in bytes of the rows that wait for a full row group, in all files together.
_MAX_WAITING: Final = 16 << 20
#: Maximum number of open files; for more systems, the oldest file is completed and later continued in another
#: file.
_MAX_OPEN: Final = 256
_THREADS: Final = 4


class _Part:
    """A Parquet file of one message of one system, and the rows that wait for it."""

    def __init__(self, file: PartFile) -> None:
        self.file = file
        self.writer: Any = None
        self.waiting: list[Any] = []
        self.rows = 0
        self.bytes = 0

    def add(self, table: Any) -> None:  # noqa: ANN401 (pyarrow has no types)
        """Add rows."""
        self.waiting.append(table)
        self.rows += table.num_rows
        self.bytes += table.nbytes

    def flush(self, pyarrow: Any, parquet: Any) -> None:  # noqa: ANN401 (pyarrow has no types)
        """Write the waiting rows as a row group."""
        if not self.waiting:
            return
        rows = pyarrow.concat_tables(self.waiting)
        self.waiting, self.rows, self.bytes = [], 0, 0
        if self.writer is None:
            # Dictionaries only for texts: sensor values rarely repeat, and building dictionaries takes most
            # of the time.
            texts = [field.name for field in rows.schema if pyarrow.types.is_string(field.type)]
            self.writer = parquet.ParquetWriter(
                self.file.temporary,
                rows.schema,
                compression="zstd",
                compression_level=1,
                use_dictionary=texts,
            )
        self.writer.write_table(rows)

    def close(self) -> None:
        """Close the file."""
        if self.writer is not None:
            self.writer.close()


class ParquetWriter(TableWriter):
    """Writes a log into a Parquet dataset."""

    def __init__(self, log: Log, path: Path, options: ExportOptions) -> None:
        super().__init__(log, path, options)
        try:
            self._pyarrow = import_module("pyarrow")
            self._parquet = import_module("pyarrow.parquet")
        except ImportError:
            raise MissingExtraError("the export to Parquet", "data") from None
        self._flight = flight_name(log)
        self._date = flight_date(log)
        self._parts: dict[Key, _Part] = {}
        self._numbers: dict[Key, int] = {}
        self._closed: list[_Part] = []
        self._metadata = {"mavstack.log": json.dumps({"file": log.path.name, "format": log.format})}
        self._threads = ThreadPoolExecutor(_THREADS)

    def write(self, tables: Mapping[str, MessageTable]) -> None:
        """Write the next rows; see `TableWriter.write`."""
        work = list(by_vehicle(self.log, tables))
        for (system, name, _), rows in zip(work, self._threads.map(self._convert, work), strict=True):
            self._part((system, name)).add(rows)
        full = [part for part in self._parts.values() if part.rows >= _GROUP_ROWS]
        full = full or self._largest()
        if full:
            self._flush(full)
            # Return free memory to the system; otherwise it grows with the size of the file.
            self._pyarrow.default_memory_pool().release_unused()

    def finish(self) -> list[Path]:
        """Complete the files; see `ExportWriter.finish`."""
        parts = [*self._closed, *self._parts.values()]
        self._flush(parts)
        for part in parts:
            part.close()
        return [part.file.complete() for part in parts]

    def discard(self) -> None:
        """Remove incomplete files; see `ExportWriter.discard`."""
        self._threads.shutdown()
        for part in [*self._closed, *self._parts.values()]:
            part.close()
            part.file.discard()

    def _largest(self) -> list[_Part]:
        """Return the parts with the most rows that wait, if together they take too much memory."""
        waiting = sum(part.bytes for part in self._parts.values())
        if waiting <= _MAX_WAITING:
            return []
        # Each row group takes memory until its file is complete, so the small parts keep waiting.
        parts = sorted(self._parts.values(), key=lambda part: part.bytes, reverse=True)
        before = accumulate((part.bytes for part in parts), initial=0)
        return [part for part, less in zip(parts, before, strict=False) if waiting - less > _MAX_WAITING // 2]

    def _convert(self, item: tuple[int, str, MessageTable]) -> Any:  # noqa: ANN401 (pyarrow has no types)
        options = self.options
        rows = item[2].to_arrow("lists", scaled=options.scaled, enums=options.enums)
        return rows.replace_schema_metadata({**(rows.schema.metadata or {}), **self._metadata})

    def _part(self, key: Key) -> _Part:
        part = self._parts.get(key)
        if part is None:
            if len(self._parts) >= _MAX_OPEN:
                self._close_oldest()
            number = self._numbers[key] = self._numbers.get(key, -1) + 1
            part = self._parts[key] = _Part(PartFile(self._file_path(key, number)))
        return part

    def _close_oldest(self) -> None:
        part = self._parts.pop(next(iter(self._parts)))
        self._flush([part])
        part.close()
        self._closed.append(part)

    def _file_path(self, key: Key, number: int) -> Path:
        system, name = key
        folder = self.path / f"vehicle={system}" / f"date={self._date}" / f"message={file_stem(name)}"
        return folder / f"{self._flight}-{number}.parquet"

    def _flush(self, parts: list[_Part]) -> None:
        list(self._threads.map(lambda part: part.flush(self._pyarrow, self._parquet), parts))


PARQUET: Final = LogExporter(
    "parquet", "Parquet dataset, partitioned by vehicle, date and message", ".parquet", True, ParquetWriter
)
