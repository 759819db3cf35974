"""Logs of packets: tlogs (a timestamp before each packet) and raw streams.

Opening a file builds an index of all packets, whose CRC is verified; the table of a message is decoded on
first access. Junk between packets is skipped and counted.
"""

from __future__ import annotations

import os
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from mavstack._core import Index, looks_timestamped
from mavstack.errors import LogError
from mavstack.logs.damage import LogDamage
from mavstack.logs.log import Log
from mavstack.logs.log_bytes import LogBytes
from mavstack.logs.message_table import MessageTable
from mavstack.logs.packets import packet_facts
from mavstack.logs.packets.message_schema import message_schema
from mavstack.logs.packets.packet_clocks import PacketClocks
from mavstack.logs.packets.packet_record import PacketRecord
from mavstack.logs.packets.tables import table_dtype
from mavstack.logs.registry import MAX_HEAD
from mavstack.logs.schema import SchemaSource
from mavstack.wire import Parser

if TYPE_CHECKING:
    import mmap
    from collections.abc import Iterator, Mapping, Sequence

    from numpy.typing import NDArray

    from mavstack.dialects import Dialect
    from mavstack.logs.records import LogText, ParameterChange
    from mavstack.logs.schema import TableSchema
    from mavstack.logs.time_base import TimeBase
    from mavstack.logs.vehicles import LogVehicle
    from mavstack.wire import Packet, SourceStatistics, Statistics

#: Bytes that `records` parses at a time.
_RECORDS_CHUNK = 1 << 20


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
        with self._bytes.access() as data:
            self.timestamped = (
                looks_timestamped(data[:MAX_HEAD], dialect) if timestamped is None else timestamped
            )
            self._index = self._indexed(data)
            self._data = data
        self.format = "tlog" if self.timestamped else "raw"
        ids = self._index.counts
        self._ids = {dialect.name_of(message_id): message_id for message_id in ids}
        self._counts = {name: ids[message_id] for name, message_id in self._ids.items()}
        self._schemas: dict[str, SchemaSource] = {}

    @property
    def counts(self) -> Mapping[str, int]:
        """Number of packets by message name."""
        return self._counts

    def schema(self, name: str) -> TableSchema:
        """Return the meaning of the columns of a message's table; see `Log.schema`."""
        self._require([name])
        return self._schema_source(name).schema

    def _schema_source(self, name: str) -> SchemaSource:
        source = self._schemas.get(name)
        if source is None:
            source = SchemaSource(partial(message_schema, self.dialect, self._ids[name]))
            self._schemas[name] = source
        return source

    def decode_tables(self, names: Sequence[str]) -> Mapping[str, MessageTable]:
        """Decode tables in one pass; see `Log.decode_tables`."""
        tables = {name: np.empty(self.counts[name], self._dtype(name)) for name in names}
        rows = [(self._ids[name], table.view(np.uint8).data) for name, table in tables.items()]
        with self._bytes.access() as data:
            if data is not self._data:
                self._use_copy(data)
            self._index.decode(rows, threads=self._threads)
        return {name: MessageTable.of(table, self._schema_source(name)) for name, table in tables.items()}

    def _indexed(self, data: mmap.mmap | bytes) -> Index:
        return Index(data, self.dialect, timestamped=self.timestamped, threads=self._threads)

    def _use_copy(self, data: mmap.mmap | bytes) -> None:
        """Continue with a copy of the file, which another process has opened for writing meanwhile."""
        index = self._indexed(data)
        if index.statistics != self._index.statistics or index.counts != self._index.counts:
            raise LogError(f"cannot read {self.path}: it was rewritten since it was opened; open it again")
        self._index, self._data = index, data

    def _dtype(self, name: str) -> np.dtype[np.void]:
        definition = self.dialect.message_definition(self._ids[name])
        return table_dtype(definition, self._index.row_size(self._ids[name]))

    def records(self, *names: str) -> Iterator[PacketRecord]:
        """Iterate over the packets in the order of the file; see `Log.records`."""
        wanted = {self._ids[name] for name in names or self if name in self._ids}
        for packet in self._packets():
            if packet.message_id in wanted:
                yield PacketRecord(packet)

    def _packets(self) -> Iterator[Packet]:
        parser = Parser(self.dialect, timestamped=self.timestamped)
        for start in range(0, self.size, _RECORDS_CHUNK):
            with self._bytes.access() as data:
                packets = parser.feed(data[start : start + _RECORDS_CHUNK])
            yield from packets
        yield from parser.flush()

    @property
    def unknown(self) -> dict[int, int]:
        """Number of packets of each message id that is not in the dialect."""
        return self._index.unknown

    @property
    def statistics(self) -> Statistics:
        """Totals of the file: packets, bad bytes, signed packets and so on."""
        return self._index.statistics

    @property
    def sources(self) -> dict[tuple[int, int], SourceStatistics]:
        """Statistics of each source, by (system, component)."""
        return self._index.sources

    @property
    def skipped(self) -> LogDamage:
        """Bytes outside of packets, damaged packets, and packets whose id is not in the dialect."""
        totals = self.statistics
        damaged = totals.bad_checksum + totals.bad_flags + totals.bad_length if totals.bad_bytes else 0
        return LogDamage(bad_bytes=totals.bad_bytes, bad_records=damaged, unknown=self.unknown)

    @property
    def time_span(self) -> tuple[float, float] | None:
        """Earliest and latest recorded time in seconds since 1970, or None without times."""
        span = self._index.time_span
        return None if span is None else (span[0] / 1e6, span[1] / 1e6)

    @property
    def duration(self) -> float:
        """Seconds from the earliest to the latest recorded time; 0 without times."""
        span = self._index.time_span
        return 0.0 if span is None else (span[1] - span[0]) / 1e6

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
        return clocks.time_base("received" if self.timestamped else "boot")

    def read_info(self, log: Log) -> dict[str, str]:
        """Return the facts in HEARTBEAT and AUTOPILOT_VERSION of the first vehicle."""
        return packet_facts.info(log)

    def read_parameters(self, log: Log) -> tuple[dict[str, float], list[ParameterChange]]:
        """Return the parameters in PARAM_VALUE of the first vehicle."""
        return packet_facts.parameters(log)

    def read_texts(self, log: Log) -> list[LogText]:
        """Return the texts in STATUSTEXT."""
        return packet_facts.texts(log)

    def read_vehicles(self, log: Log) -> dict[int, LogVehicle]:
        """Return the systems whose HEARTBEAT names an autopilot."""
        return packet_facts.vehicles(log)

    def __repr__(self) -> str:
        return f"<PacketLog {self.path.name}: {self.statistics.packets} packets, {len(self)} messages>"
