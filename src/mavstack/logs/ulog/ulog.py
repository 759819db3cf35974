"""PX4's onboard logs (.ulg): a table for each topic, with the instances of the topic in one table.

Opening a file builds an index of all messages; the table of a topic is decoded on first access. The format
has no checksums: damage is recognised by messages that do not follow each other, and counted.
"""

from __future__ import annotations

import os
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack._core import UlogIndex
from mavstack.errors import LogError
from mavstack.logs.joined_windows import join_windows
from mavstack.logs.log import DEFAULT_WINDOW, Log
from mavstack.logs.log_bytes import LogBytes
from mavstack.logs.mapped_pages import STEP, release
from mavstack.logs.message_table import MessageTable
from mavstack.logs.saved_index import SavedIndex
from mavstack.logs.schema import SchemaSource
from mavstack.logs.table_memory import new_tables
from mavstack.logs.ulog import vehicle_facts
from mavstack.logs.ulog.clock import GPS_TOPICS, time_base
from mavstack.logs.ulog.entries import read_entries, read_texts
from mavstack.logs.ulog.tables import table_dtype, table_schema

if TYPE_CHECKING:
    import mmap
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from numpy.typing import NDArray

    from mavstack.logs.damage import LogDamage
    from mavstack.logs.records import LogText, ParameterChange
    from mavstack.logs.schema import TableSchema
    from mavstack.logs.select import Selection
    from mavstack.logs.time_base import TimeBase
    from mavstack.logs.ulog.entries import Dropout, Entries, LoggedText, Value
    from mavstack.logs.vehicles import LogVehicle

#: Maximum size in bytes of a file whose record positions are kept from the start; for a larger file, they are
#: kept when a table is decoded.
_MAX_STORED: Final = 1 << 30
#: Minimum number of rows of a regular topic; number of regular topics (those with the fewest rows) whose last
#: times are compared with the last time of all records; and the difference in microseconds that means another
#: boot.
_REGULAR: Final = 50
_COMPARED: Final = 5
_MAX_AHEAD_US: Final = 60_000_000


class ULog(Log):
    """An onboard log of PX4.

    The names are those of topics, such as `vehicle_attitude`. A table has the columns `_time` (datetime64 in
    µs UTC, NaT without satellite navigation), `_instance` and the fields of the topic with their raw values;
    fields of nested definitions have dotted names (`esc[0].esc_rpm`). `log["battery_status[1]"]` is the table
    of one instance.

    Args:
        source: Path of the file, or its bytes.
        threads: Maximum number of threads; 0 for one per processor.

    Raises:
        LogError: The file cannot be read, is no ULog, or uses features of ULog that are not supported.
    """

    format = "ulog"

    def __init__(self, source: str | os.PathLike[str] | LogBytes, *, threads: int = 0) -> None:
        self._bytes = source if isinstance(source, LogBytes) else LogBytes(Path(source))
        super().__init__(self._bytes.path, self._bytes.size)
        self._threads = threads or os.cpu_count() or 1
        self._saves_memory = False
        self._saved = SavedIndex(
            self._bytes,
            self.format,
            restore=partial(UlogIndex.restore, threads=self._threads),
            build=self._indexed,
        )
        with self._bytes.access() as data:
            self._index, self._data = self._opened(data), data
        self._instances = dict(self._index.instances)
        self._counts = {name: sum(counts.values()) for name, counts in self._instances.items()}
        self._dtypes: dict[str, np.dtype[np.void]] = {}
        self._schemas: dict[str, SchemaSource] = {}

    def _opened(self, data: mmap.mmap | bytes) -> UlogIndex:
        """Return the saved index, or a new one, of a very large file without positions."""
        if self.size >= _MAX_STORED:
            return self._indexed(data, positions=False)
        return self._saved.open(data)

    def _indexed(
        self, data: mmap.mmap | bytes, *, positions: bool = True, size: int | None = None
    ) -> UlogIndex:
        try:
            return UlogIndex(
                data,
                size=size,
                positions=positions,
                threads=self._threads,
                step=STEP,
                done=partial(release, data),
            )
        except ValueError as error:
            raise LogError(f"cannot open {self.path}: {error}") from None

    @property
    def counts(self) -> Mapping[str, int]:
        """Number of records by topic."""
        return self._counts

    @property
    def instances(self) -> Mapping[str, Mapping[int, int]]:
        """Number of records of each instance, by topic."""
        return self._instances

    def selected_rows(self, name: str, selection: Selection) -> int | None:
        """Return how many rows of a topic a selection keeps, without times; see `Log.selected_rows`."""
        if selection.has_times:
            return None
        if selection.instance is None:
            return self.counts[name]
        return self.instances[name].get(selection.instance, 0)

    def schema(self, name: str) -> TableSchema:
        """Return the meaning of the columns of a topic's table; see `Log.schema`."""
        self._require([name])
        return self._schema_source(name).schema

    def _schema_source(self, name: str) -> SchemaSource:
        if name not in self._schemas:
            self._schemas[name] = SchemaSource(partial(table_schema, name, self._dtype(name)))
        return self._schemas[name]

    def _dtype(self, name: str) -> np.dtype[np.void]:
        if name not in self._dtypes:
            self._dtypes[name] = table_dtype(*self._index.layout(name))
        return self._dtypes[name]

    # decoding

    def decode_tables(self, names: Sequence[str]) -> Mapping[str, MessageTable]:
        """Decode tables in one pass; see `Log.decode_tables`."""
        offset = self._time_base.offset_us if names else None
        if self._saves_memory and names:
            counts = {name: self.counts[name] for name in names}
            return join_windows(self.path, counts, self._pieces(DEFAULT_WINDOW, names, offset))
        return self._decode_boot(names, offset)

    def _decode_boot(self, names: Sequence[str], offset: int | None) -> dict[str, MessageTable]:
        with self._bytes.access() as data:
            if data is not self._data:
                self._use_copy(data)
            if not self._index.has_positions:
                self._index = self._saved.complete(data)
            counts = {name: self.counts[name] for name in names}
            return self._decode(self._index, counts, offset)

    def _decode(
        self, index: UlogIndex, counts: Mapping[str, int], offset: int | None
    ) -> dict[str, MessageTable]:
        empty = new_tables([(self._dtype(name), count) for name, count in counts.items()])
        tables = dict(zip(counts, empty, strict=True))
        rows = [(name, table.view(np.uint8).data) for name, table in tables.items()]
        index.decode(rows, utc_offset=offset, threads=self._threads)
        return {name: MessageTable.of(table, self._schema_source(name)) for name, table in tables.items()}

    def _use_copy(self, data: mmap.mmap | bytes) -> None:
        """Continue with a copy of the file, which another process has opened for writing meanwhile."""
        index = self._indexed(data, positions=self._index.has_positions)
        if index.instances != self._index.instances or index.damage != self._index.damage:
            raise LogError(f"cannot read {self.path}: it was rewritten since it was opened; open it again")
        self._index, self._data = index, data

    def prepare_windows(self) -> None:
        """Keep the positions of no records, and no pages of the file; see `Log.prepare_windows`."""
        self._index, self._saves_memory = self._index.without_positions(), True
        self._bytes.release()

    def windows(
        self,
        size: int = DEFAULT_WINDOW,
        names: Sequence[str] | None = None,
        *,
        progress: Callable[[int, int], None] | None = None,
    ) -> Iterator[dict[str, MessageTable]]:
        """Yield the file piece by piece, in bounded memory; see `Log.windows`."""
        yield from self._pieces(size, names, self._time_base.offset_us, progress)

    def _pieces(
        self,
        size: int,
        names: Sequence[str] | None,
        offset: int | None,
        progress: Callable[[int, int], None] | None = None,
    ) -> Iterator[dict[str, MessageTable]]:
        piece: UlogIndex | None = None
        used: mmap.mmap | bytes | None = None
        while True:
            with self._bytes.access() as data:
                if data is not used and piece is not None:
                    self._use_copy(data)
                    piece = self._indexed(data, positions=False, size=piece.end)
                used = data
                piece = self._indexed(data, size=size) if piece is None else piece.following(size)
                if piece is None:
                    return
                counts = {name: sum(instances.values()) for name, instances in piece.instances}
                wanted = {name: count for name, count in counts.items() if names is None or name in names}
                tables = self._decode(piece, wanted, offset)
                release(data, max(piece.end - 2 * size, 0), piece.end)
            yield tables
            if progress is not None:
                progress(piece.end, self.size)

    # facts

    @cached_property
    def _entries(self) -> Entries:
        with self._bytes.access() as data:
            if data is not self._data:
                self._use_copy(data)
            return read_entries(self._index, partial(release, data))

    @cached_property
    def logged_texts(self) -> list[LoggedText]:
        """Texts that programs on the vehicle printed, in the order of the file."""
        with self._bytes.access() as data:
            if data is not self._data:
                self._use_copy(data)
            return read_texts(self._index, partial(release, data))

    @property
    def information(self) -> Mapping[str, Value]:
        """Information messages by name, such as `ver_sw_release`."""
        return self._entries.information

    @property
    def multi_information(self) -> Mapping[str, list[list[Value]]]:
        """Information in several messages: for each name a list of values, each a list of parts."""
        return self._entries.multi_information

    @property
    def default_parameters(self) -> Mapping[str, Mapping[str, float]]:
        """Default values of parameters by group ("system", "configuration") and name."""
        return self._entries.defaults

    @property
    def dropouts(self) -> list[Dropout]:
        """Times in which the logger lost messages."""
        return self._entries.dropouts

    @property
    def skipped(self) -> LogDamage:
        """Bytes outside of messages, and messages that cannot be read."""
        return vehicle_facts.damage(self._index, self._entries.damaged)

    @property
    def _time_base(self) -> TimeBase:
        return self._clocks[0]

    @cached_property
    def _clocks(self) -> tuple[TimeBase, int]:
        """The time base, and the latest time in some regular topics in microseconds since boot."""
        satellites = [name for name in GPS_TOPICS if name in self.counts]
        regular = sorted((count, name) for name, count in self._counts.items() if count >= _REGULAR)
        compared = [name for _, name in regular[:_COMPARED]]
        ends: list[int] = []

        def pieces() -> Iterator[Mapping[str, MessageTable]]:
            for tables in self._boot_pieces(list({*satellites, *compared})):
                found = [tables[name] for name in compared if len(tables.get(name, ()))]
                ends.extend(int(table["timestamp"].max()) for table in found if table.has_number("timestamp"))
                yield {name: tables[name] for name in satellites if name in tables}

        span = self._index.time_span
        base = time_base(pieces(), self.information)
        return base, max(ends, default=0 if span is None else span[1])

    def _boot_pieces(self, names: Sequence[str]) -> Iterator[Mapping[str, MessageTable]]:
        """Yield tables without UTC: of a large file piece by piece, so that no positions are stored."""
        stores_positions = not self._saves_memory and self.size < _MAX_STORED
        if stores_positions or self._index.has_positions:
            yield self._decode_boot(names, None)
        else:
            yield from self._pieces(DEFAULT_WINDOW, names, None)

    @property
    def time_span(self) -> tuple[float, float] | None:
        """Start of the log and latest time of a record in seconds, UTC or since boot; None without records.

        A logger also writes the last values from before its start, some of them with the time 0, or with that
        of an earlier boot, as a mission that was stored then.
        """
        span, offset = self._index.time_span, self._time_base.offset_us or 0
        if span is None:
            return None
        end = self._clocks[1]
        last = span[1] if span[1] <= end + _MAX_AHEAD_US else end
        first = min(max(span[0], self._index.start_time), last)
        return (first + offset) / 1e6, (last + offset) / 1e6

    def boot_times(self, name: str, table: MessageTable) -> NDArray[np.float64] | None:
        """Return the field `timestamp` of each row, NaN in a topic without it; see `Log.boot_times`."""
        if not table.has_number("timestamp"):
            return np.full(len(table), np.nan)
        return table["timestamp"] / 1e6

    def read_time_base(self, log: Log) -> TimeBase:
        """Return the vehicle's clock, which satellite navigation or the autopilot relates to UTC."""
        return self._time_base

    def read_info(self, log: Log) -> dict[str, str]:
        """Return the information messages as text, and the firmware and hardware in them."""
        return vehicle_facts.info(self.information)

    def read_parameters(self, log: Log) -> tuple[dict[str, float], list[ParameterChange]]:
        """Return the parameters at the beginning of the log, and the changes in the time of the view."""
        return vehicle_facts.parameters(self._entries, self._time_base, self._span_of(log))

    def read_texts(self, log: Log) -> list[LogText]:
        """Return the logged texts in the time of the view."""
        return vehicle_facts.texts(self.logged_texts, self._time_base, self._span_of(log))

    def read_vehicles(self, log: Log) -> dict[int, LogVehicle]:
        """Return the vehicle that wrote the log."""
        return vehicle_facts.vehicles(self.parameters, self.info.get("autopilot", ""))

    def _span_of(self, log: Log) -> tuple[float, float] | None:
        """Return the times of a view, or None for the whole log."""
        return None if log is self else log.time_span
