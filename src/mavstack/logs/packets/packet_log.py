"""Logs of packets: tlogs (a timestamp before each packet) and raw streams.

An index of all packets, whose CRC is verified, is built when a file of up to 64 MiB is opened, and of a
larger file when its tables or counts are first needed. The table of a message is decoded on first access.
`windows` needs no index: it reads the file piece by piece, and carries the state of the scanner from one
piece to the next. Junk between packets is skipped and counted.
"""

from __future__ import annotations

import os
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack._core import Index, looks_timestamped
from mavstack.errors import LogError
from mavstack.logs.damage import LogDamage
from mavstack.logs.joined_windows import join_windows
from mavstack.logs.log import DEFAULT_WINDOW, Log
from mavstack.logs.log_bytes import LogBytes
from mavstack.logs.message_table import MessageTable
from mavstack.logs.packets import packet_facts
from mavstack.logs.packets.message_schema import message_schema
from mavstack.logs.packets.packet_clocks import PacketClocks
from mavstack.logs.packets.packet_record import PacketRecord
from mavstack.logs.packets.tables import table_dtype
from mavstack.logs.packets.window_reader import index_windows
from mavstack.logs.registry import MAX_HEAD
from mavstack.logs.saved_index import SavedIndex
from mavstack.logs.schema import SchemaSource
from mavstack.logs.table_memory import new_tables
from mavstack.wire import Parser

if TYPE_CHECKING:
    import mmap
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from numpy.typing import NDArray

    from mavstack._core import WindowIndexer
    from mavstack.dialects import Dialect
    from mavstack.logs.records import LogText, ParameterChange
    from mavstack.logs.schema import TableSchema
    from mavstack.logs.select import Selection
    from mavstack.logs.time_base import Clock, TimeBase
    from mavstack.logs.vehicles import LogVehicle
    from mavstack.wire import Packet, SourceStatistics, Statistics

#: Size in bytes up to which a file is indexed when it is opened.
MAX_EAGER_SIZE: Final = 64 << 20
#: Bytes that `records` parses at a time.
_RECORDS_CHUNK: Final = 1 << 20
#: Bytes that `prepare_windows` reads at a time: each thread indexes at least one mebibyte of them.
_SCAN_WINDOW: Final = 8 << 20


class PacketLog(Log):
    """A log of packets: a tlog or a raw stream.

    A table is a numpy structured array with one row per packet, which also converts itself to a data frame
    (`log["BATTERY_STATUS"].to_pandas()`). Its columns are `_time` (datetime64 in µs UTC, NaT if not
    recorded), `_system`, `_component`, `_sequence`, `_version`, and the fields of the message with their raw
    values.

    Args:
        source: Path of the file, or its bytes.
        dialect: The dialect of the messages.
        timestamped: True for a tlog, False for a raw stream; None detects it from the content.
        threads: Maximum number of threads; 0 for one per processor.

    Attributes:
        dialect: The dialect of the messages.
        timestamped: True for a tlog.

    Raises:
        LogError: The file cannot be read.
    """

    def __init__(
        self,
        source: str | os.PathLike[str] | LogBytes,
        dialect: Dialect,
        *,
        timestamped: bool | None = None,
        threads: int = 0,
    ) -> None:
        self._bytes = source if isinstance(source, LogBytes) else LogBytes(Path(source))
        super().__init__(self._bytes.path, self._bytes.size)
        self.dialect = dialect
        self._threads = threads or os.cpu_count() or 1
        if timestamped is None:
            timestamped = looks_timestamped(self._bytes.read(0, MAX_HEAD), dialect)
        self.timestamped = timestamped
        self.format = "tlog" if timestamped else "raw"
        self._schemas: dict[int, SchemaSource] = {}
        self._saved = SavedIndex(
            self._bytes, f"{self.format} {dialect.name}", restore=self._restored, build=self._indexed
        )
        self._index: Index | None = None
        self._data: mmap.mmap | bytes = b""
        self._scanned: WindowIndexer | None = None
        self._saves_memory = False
        if self.size <= MAX_EAGER_SIZE:
            self._require_index()

    @property
    def counts(self) -> Mapping[str, int]:
        """Number of packets by message name."""
        return self._counts

    @cached_property
    def _counts(self) -> dict[str, int]:
        return {self.dialect.name_of(number): count for number, count in self._totals.counts.items()}

    @cached_property
    def _ids(self) -> dict[str, int]:
        return {self.dialect.name_of(number): number for number in self._totals.counts}

    def schema(self, name: str) -> TableSchema:
        """Return the meaning of the columns of a message's table; see `Log.schema`."""
        self._require([name])
        return self._schema_source(self._ids[name]).schema

    def _schema_source(self, message_id: int) -> SchemaSource:
        source = self._schemas.get(message_id)
        if source is None:
            source = SchemaSource(partial(message_schema, self.dialect, message_id))
            self._schemas[message_id] = source
        return source

    def decode_tables(self, names: Sequence[str]) -> Mapping[str, MessageTable]:
        """Decode tables in one pass; see `Log.decode_tables`."""
        if self._saves_memory:
            counts = {name: self.counts[name] for name in names}
            return join_windows(self.path, counts, self.windows(_SCAN_WINDOW, names)) if names else {}
        wanted = {self._ids[name]: self.counts[name] for name in names}
        index = self._require_index()
        with self._bytes.access() as data:
            if data is not self._data:
                index = self._use_copy(data, index)
            if not index.has_positions:
                index = self._index = self._saved.complete(data)
            return self._tables_of(index, wanted)

    def _tables_of(self, index: Index, counts: Mapping[int, int]) -> dict[str, MessageTable]:
        """Decode the rows of messages, by message id, from an index whose data may be read now."""
        empty = new_tables([(self._dtype(index, number), count) for number, count in counts.items()])
        tables = dict(zip(counts, empty, strict=True))
        rows = [(number, table.view(np.uint8).data) for number, table in tables.items()]
        index.decode(rows, threads=self._threads)
        return {
            self.dialect.name_of(number): MessageTable.of(table, self._schema_source(number))
            for number, table in tables.items()
        }

    def _require_index(self) -> Index:
        """Return the index of the file, and make it before its first use."""
        if self._index is None:
            with self._bytes.access() as data:
                self._index, self._data = self._saved.open(data), data
        return self._index

    def _restored(self, saved: bytes, data: mmap.mmap | bytes) -> Index | None:
        return Index.restore(saved, data, self.dialect)

    @property
    def _totals(self) -> Index | WindowIndexer:
        return self._index or self._scanned or self._require_index()

    def _indexed(self, data: mmap.mmap | bytes) -> Index:
        return Index(data, self.dialect, timestamped=self.timestamped, threads=self._threads)

    def _use_copy(self, data: mmap.mmap | bytes, before: Index) -> Index:
        """Continue with a copy of the file, which another process has opened for writing meanwhile."""
        index = self._indexed(data)
        if index.statistics != before.statistics or index.counts != before.counts:
            raise LogError(f"cannot read {self.path}: it was rewritten since it was opened; open it again")
        self._index, self._data = index, data
        return index

    def _dtype(self, index: Index, message_id: int) -> np.dtype[np.void]:
        return table_dtype(self.dialect.message_definition(message_id), index.row_size(message_id))

    def selected_rows(self, name: str, selection: Selection) -> int | None:
        """Return how many rows of a table a selection keeps, if known; see `Log.selected_rows`."""
        if not selection.has_times and selection.instance is None:
            kept = [selection.keeps_source(system, component) for system, component in self.sources]
            if all(kept) or not any(kept):
                return self.counts[name] if all(kept) else 0
        return None

    def prepare_windows(self) -> None:
        """Read the totals piece by piece; see `Log.prepare_windows`."""
        if self._scanned is None:
            for _ in self._indexed_windows(_SCAN_WINDOW):
                pass
        self._saves_memory = True
        self._index, self._data = None, b""
        self._bytes.release()

    def _indexed_windows(self, size: int) -> Iterator[tuple[Index, int]]:
        """Yield the index of each piece of the file, and the bytes read so far; then keep the totals."""
        from mavstack._core import WindowIndexer

        indexer = WindowIndexer(self.dialect, timestamped=self.timestamped, threads=self._threads)
        yield from index_windows(self._bytes, indexer, size)
        self._scanned = indexer

    def windows(
        self,
        size: int = DEFAULT_WINDOW,
        names: Sequence[str] | None = None,
        *,
        progress: Callable[[int, int], None] | None = None,
    ) -> Iterator[dict[str, MessageTable]]:
        """Yield the file piece by piece, in bounded memory; see `Log.windows`."""
        for index, done in self._indexed_windows(size):
            counts = {
                number: count
                for number, count in index.counts.items()
                if names is None or self.dialect.name_of(number) in names
            }
            tables = self._tables_of(index, counts)
            if tables:
                yield tables
            if progress is not None:
                progress(done, self.size)

    def records(self, *names: str) -> Iterator[PacketRecord]:
        """Iterate over the packets in the order of the file; see `Log.records`."""
        for packet in self._packets():
            if packet.name in names if names else packet.name is not None:
                yield PacketRecord(packet)

    def _packets(self) -> Iterator[Packet]:
        parser = Parser(self.dialect, timestamped=self.timestamped)
        for start in range(0, self._bytes.size, _RECORDS_CHUNK):
            yield from parser.feed(self._bytes.read(start, _RECORDS_CHUNK))
        yield from parser.flush()

    @property
    def unknown(self) -> dict[int, int]:
        """Number of packets of each message id that is not in the dialect."""
        return self._totals.unknown

    @property
    def statistics(self) -> Statistics:
        """Totals of the file: packets, bad bytes, signed packets and so on."""
        return self._totals.statistics

    @property
    def sources(self) -> dict[tuple[int, int], SourceStatistics]:
        """Statistics of each source, by (system, component)."""
        return self._totals.sources

    @property
    def skipped(self) -> LogDamage:
        """Bytes outside of packets, damaged packets, and packets whose id is not in the dialect."""
        totals = self.statistics
        damaged = totals.bad_checksum + totals.bad_flags + totals.bad_length if totals.bad_bytes else 0
        return LogDamage(bad_bytes=totals.bad_bytes, bad_records=damaged, unknown=self.unknown)

    @property
    def time_span(self) -> tuple[float, float] | None:
        """Earliest and latest recorded time in seconds since 1970, or None without times."""
        span = self._totals.time_span
        return None if span is None else (span[0] / 1e6, span[1] / 1e6)

    @property
    def duration(self) -> float:
        """Seconds from the earliest to the latest recorded time; 0 without times."""
        span = self._totals.time_span
        return 0.0 if span is None else (span[1] - span[0]) / 1e6

    @property
    def clock(self) -> Clock:
        """The clock of the column `_time`: "received", or "boot" in a raw stream, which has no times."""
        return "received" if self.timestamped else "boot"

    @cached_property
    def _clocks(self) -> PacketClocks:
        return PacketClocks(self)

    def boot_times(self, name: str, table: MessageTable) -> NDArray[np.float64] | None:
        """Return the time since boot of each row; see `Log.boot_times`."""
        return self._clocks.boot_times(table)

    def utc_times(self, name: str, table: MessageTable) -> NDArray[np.float64] | None:
        """Return the UTC of each row; see `Log.utc_times`."""
        return self._clocks.utc_times(table)

    def read_time_base(self, log: Log) -> TimeBase:
        """Return the recorder's clock, and the offset of the first vehicle's clock."""
        clocks = self._clocks if log is self else PacketClocks(log)
        return clocks.time_base(self.clock)

    def read_info(self, log: Log) -> dict[str, str]:
        """Return the facts in HEARTBEAT and AUTOPILOT_VERSION of the first vehicle."""
        return packet_facts.info(log)

    def read_parameters(self, log: Log) -> tuple[dict[str, float], list[ParameterChange]]:
        """Return the parameters in PARAM_VALUE of the first vehicle."""
        return packet_facts.parameters(log)

    def read_texts(self, log: Log) -> list[LogText]:
        """Return the texts in STATUSTEXT."""
        return packet_facts.texts(log, self)

    def read_vehicles(self, log: Log) -> dict[int, LogVehicle]:
        """Return the systems whose HEARTBEAT names an autopilot."""
        return packet_facts.vehicles(log)

    def __repr__(self) -> str:
        kind, packets = type(self).__name__, self.statistics.packets
        return f"<{kind} {self.path.name}: {packets} packets, {len(self)} messages>"
