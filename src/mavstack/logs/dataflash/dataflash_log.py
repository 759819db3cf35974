"""Binary DataFlash logs (`.BIN`): a table for each record type.

Opening a file builds an index of all records, from the definitions in the file itself. Damaged parts are
skipped and counted. The files have no checksums: a record in the middle of which bytes were overwritten
cannot be told from an intact one.
"""

from __future__ import annotations

import os
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from mavstack._core import DataFlashIndex
from mavstack.errors import LogError
from mavstack.logs.damage import LogDamage
from mavstack.logs.dataflash.ardupilot_log import ArduPilotLog
from mavstack.logs.dataflash.record_type import RecordType, table_names
from mavstack.logs.dataflash.units import SlotFinder, has_units, units_by_slot
from mavstack.logs.joined_windows import join_windows
from mavstack.logs.log import DEFAULT_WINDOW
from mavstack.logs.log_bytes import LogBytes
from mavstack.logs.mapped_pages import STEP, release
from mavstack.logs.message_table import MessageTable
from mavstack.logs.records import RowRecord
from mavstack.logs.saved_index import SavedIndex
from mavstack.logs.table_memory import new_tables

if TYPE_CHECKING:
    import mmap
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

    from numpy.typing import NDArray

    from mavstack.logs.records import LogRecord

    #: A part of a table: slot, number of the first row, number of rows.
    Part = tuple[int, int, int]

_MAX_RECORD: Final = 255


class DataFlashLog(ArduPilotLog):
    """A binary DataFlash log.

    A table has the columns `_time` (datetime64 in µs UTC, NaT if it is not known), `_instance` (number of the
    sensor, 0 in tables without instances), and the fields of the record type. A record type that changes its
    fields within the file is another table from there on: `NAME_2`.

    Args:
        source: Path of the file, or its bytes.
        threads: Maximum number of threads; 0 for one per processor.

    Raises:
        LogError: The file cannot be read.
    """

    format = "dataflash"

    def __init__(self, source: str | os.PathLike[str] | LogBytes, *, threads: int = 0) -> None:
        self._bytes = source if isinstance(source, LogBytes) else LogBytes(Path(source))
        super().__init__(self._bytes.path, self._bytes.size)
        self._threads = threads or os.cpu_count() or 1
        self._saves_memory = False
        self._times_of_neighbours: dict[int, NDArray[np.int64]] = {}
        self._saved = SavedIndex(
            self._bytes, self.format, restore=DataFlashIndex.restore, build=self._indexed
        )
        with self._bytes.access() as data:
            self._index, self._data = self._saved.open(data), data
        self._types = [RecordType.of(*definition) for definition in self._index.definitions]
        counts = self._index.counts
        self._slots = table_names((slot, kind.name, counts[slot]) for slot, kind in enumerate(self._types))
        self._counts = {name: counts[slot] for name, slot in self._slots.items()}
        self._types = self._with_units()

    @property
    def counts(self) -> Mapping[str, int]:
        """Number of records by table name."""
        return self._counts

    @property
    def definitions(self) -> Mapping[str, RecordType]:
        """The record type of each table: format characters, labels and units as in the file."""
        return {name: self._types[slot] for name, slot in self._slots.items()}

    # decoding

    def decode_tables(self, names: Sequence[str]) -> Mapping[str, MessageTable]:
        """Decode tables in one pass; see `Log.decode_tables`."""
        if self._saves_memory and names:
            counts = {name: self._counts[name] for name in names}
            return join_windows(self.path, counts, self.windows(DEFAULT_WINDOW, names))
        self._require_positions()
        parts = [(self._slots[name], 0, self._counts[name]) for name in names]
        return self._timed_tables(names, parts)

    def _require_positions(self) -> None:
        """Take the positions of all records: of an index in the cache, only the totals are read at first."""
        if not self._index.has_positions:
            with self._bytes.access() as data:
                self._index, self._data = self._saved.complete(data), data

    def _timed_tables(self, names: Iterable[str], parts: Sequence[Part]) -> dict[str, MessageTable]:
        """Decode parts of tables with all times."""
        tables = dict(zip(names, self._decode(parts, self.time_base.offset_us), strict=True))
        for (name, table), (slot, first, rows) in zip(tables.items(), parts, strict=True):
            if self._types[slot].time_column is None:
                self.fill_neighbour_times(name, table, self._neighbour_times(slot)[first : first + rows])
        return {name: self._table(name, table) for name, table in tables.items()}

    def _neighbour_times(self, slot: int) -> NDArray[np.int64]:
        """Return the time since boot in microseconds of the record before each record of a slot."""
        if slot not in self._times_of_neighbours:
            timed = [
                (number, self._types[number].layout(0))
                for number in self._slots.values()
                if self._types[number].time_column is not None
            ]
            with self._bytes.access():
                found = self._index.neighbour_times(slot, timed)
            self._times_of_neighbours[slot] = np.array(found, np.int64)
        return self._times_of_neighbours[slot]

    def _decode(self, parts: Sequence[Part], offset_us: int | None) -> list[NDArray[np.void]]:
        """Decode parts of tables, with times in UTC if the offset is known."""
        tables = new_tables([(self._types[slot].dtype, rows) for slot, _, rows in parts])
        requests = [
            (slot, first, self._types[slot].layout(offset_us), table.view(np.uint8).data)
            for (slot, first, _), table in zip(parts, tables, strict=True)
        ]
        with self._bytes.access() as data:
            if data is not self._data:
                self._use_copy(data)
            self._index.decode(requests, threads=self._threads)
        return tables

    def _indexed(self, data: mmap.mmap | bytes) -> DataFlashIndex:
        index = DataFlashIndex(data, threads=self._threads, step=STEP, done=partial(release, data))
        return index.without_positions() if self._saves_memory else index

    def prepare_windows(self) -> None:
        """Keep the positions of no records, and no pages of the file; see `Log.prepare_windows`."""
        self._index, self._saves_memory = self._index.without_positions(), True
        self._bytes.release()

    def _use_copy(self, data: mmap.mmap | bytes) -> None:
        """Continue with a copy of the file, which another process has opened for writing meanwhile."""
        index = self._indexed(data)
        if index.counts != self._index.counts or index.definitions != self._index.definitions:
            raise LogError(f"cannot read {self.path}: it was rewritten since it was opened; open it again")
        self._index, self._data = index, data

    def _table(self, name: str, rows: NDArray[np.void]) -> MessageTable:
        return MessageTable.of(rows, self._schema_source(name))

    # reading window by window

    def windows(
        self,
        size: int = DEFAULT_WINDOW,
        names: Sequence[str] | None = None,
        *,
        progress: Callable[[int, int], None] | None = None,
    ) -> Iterator[dict[str, MessageTable]]:
        """Yield the file piece by piece; see `Log.windows`."""
        for parts in self._windows(size, names, progress):
            yield self._decode_window(parts)

    def records(self, *names: str) -> Iterator[LogRecord]:
        """Iterate over the records in the order of the file; see `Log.records`."""
        for parts in self._windows(DEFAULT_WINDOW, names or None, None):
            tables = self._decode_window(parts)
            order = [
                (position, name, row)
                for name, (slot, first, rows) in parts.items()
                for row, position in enumerate(self._index.positions(slot, first, rows))
            ]
            for _, name, row in sorted(order):
                yield RowRecord(name, tables[name][row])

    def record_positions(self, size: int) -> Iterator[dict[str, NDArray[np.int64]]]:
        """Yield the positions in the file of the records of each table, piece by piece.

        Args:
            size: Approximate size of a piece in bytes of the file.
        """
        for parts in self._windows(size, None, None):
            yield {name: np.array(self._index.positions(*part), np.int64) for name, part in parts.items()}

    def _decode_window(self, parts: Mapping[str, Part]) -> dict[str, MessageTable]:
        return self._timed_tables(parts, list(parts.values()))

    def _windows(
        self, size: int, names: Sequence[str] | None, progress: Callable[[int, int], None] | None
    ) -> Iterator[dict[str, Part]]:
        """Yield the rows of each table in each piece of the file, without empty parts."""
        wanted = {name: slot for name, slot in self._slots.items() if names is None or name in names}
        size = max(size, _MAX_RECORD)
        before = [0] * len(self._types)
        for end in range(size, self.size + size, size):
            until = self._index.rows_before(min(end, self.size))
            parts = {
                name: (slot, before[slot], until[slot] - before[slot])
                for name, slot in wanted.items()
                if until[slot] > before[slot]
            }
            if parts:
                yield parts
            release(self._data, end - size, min(end, self.size))
            before = until
            if progress is not None:
                progress(min(end, self.size), self.size)

    # the meaning of the columns

    def _with_units(self) -> list[RecordType]:
        """Return the record types with their units."""
        needed = [name for name in ("FMTU", "UNIT", "MULT") if name in self._slots]
        parts = [(self._slots[name], 0, self._counts[name]) for name in needed]
        tables: dict[str, Any] = dict(zip(needed, self._decode(parts, None), strict=True))
        fmtu = tables.get("FMTU")
        if fmtu is None or not has_units(fmtu):
            return self._types
        positions = self._index.positions(self._slots["FMTU"], 0, len(fmtu))
        slot = SlotFinder(self._index.redefinitions).slot
        rows = dict(zip(positions, fmtu, strict=True))
        units = units_by_slot(rows, tables.get("UNIT"), tables.get("MULT"), slot)
        return [
            replace(kind, units=units[number]) if number in units else kind
            for number, kind in enumerate(self._types)
        ]

    # the interface of logs of ArduPilot

    def rows_without_time(self, name: str) -> NDArray[np.void]:
        """Return a table whose column `_time` is not filled."""
        windows = self._windows(DEFAULT_WINDOW, [name], None)
        return np.concatenate([self._decode([parts[name]], None)[0] for parts in windows])

    def first_and_last(self) -> dict[str, tuple[NDArray[np.void], NDArray[np.void]]]:
        """Return the first and the last row of each table, as tables of one row without `_time`."""
        firsts = self._decode([(slot, 0, 1) for slot in self._slots.values()], None)
        lasts = [(slot, self._counts[name] - 1, 1) for name, slot in self._slots.items()]
        return dict(zip(self._slots, zip(firsts, self._decode(lasts, None), strict=True), strict=True))

    # damage

    @property
    def skipped(self) -> LogDamage:
        """Bytes outside of records, damaged records, and records of types without a definition.

        Records that damage follows directly are in the tables; they are counted because their last bytes may
        be damaged too.
        """
        damage = self._index.damage
        other = {
            "doubtful records before damage (kept)": damage["suspect_records"],
            "unusable definitions": damage["bad_definitions"],
            "fields of unknown format": sum(self._types[slot].lost_fields for slot in self._slots.values()),
        }
        return LogDamage(
            bad_bytes=damage["bad_bytes"] - damage["truncated_bytes"],
            bad_records=damage["damaged_records"],
            truncated_bytes=damage["truncated_bytes"],
            unknown=self._index.unknown,
            other={reason: count for reason, count in other.items() if count},
        )
