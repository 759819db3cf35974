"""Logs of packets: tlogs (a timestamp before each packet) and raw streams.

Opening a file builds an index of all packets, whose CRC is verified; the table of a message is decoded on
first access. Junk between packets is skipped and counted.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from mavstack._core import Index, looks_timestamped
from mavstack.dialects import Dialect
from mavstack.errors import LogError, UnknownMessageError
from mavstack.logs.log_bytes import LogBytes
from mavstack.logs.message_table import MessageTable
from mavstack.logs.tables import table_dtype
from mavstack.wire.other_formats import other_format

if TYPE_CHECKING:
    import mmap
    from typing import Protocol, Self

    from mavstack.wire import SourceStatistics, Statistics

    class HasDialect(Protocol):
        """A `Dialect`, or a dialect module such as `mavstack.dialects.common`."""

        @property
        def dialect(self) -> Dialect:
            """The dialect."""


_MAX_HEAD = 1 << 18  # bytes examined to detect timestamps


class LogFile(Mapping[str, MessageTable]):
    """A log as a mapping from message names to tables: `log["ATTITUDE"]["roll"]` is a column.

    A table is a numpy structured array with one row per packet, which also converts itself to a data frame
    (`log["BATTERY_STATUS"].to_pandas()`). Its columns are `_time` (datetime64 in µs
    UTC, NaT if not recorded), `_system`, `_component`, `_sequence`, `_version`, and the fields of the message
    with their raw values.

    Args:
        path: Path of the file.
        dialect: The dialect of the messages.
        timestamped: True for a tlog, False for a raw stream; None detects it from the content.
        threads: Maximum number of threads; 0 for one per processor.

    Attributes:
        path: Path of the file.
        dialect: The dialect of the messages.
        size: Size of the file in bytes.
        timestamped: True for a tlog.
        counts: Number of packets by message name.

    Raises:
        LogError: The file cannot be read.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        dialect: Dialect,
        *,
        timestamped: bool | None = None,
        threads: int = 0,
    ) -> None:
        self.path = Path(path)
        self.dialect = dialect
        self._threads = threads or os.cpu_count() or 1
        self._bytes = LogBytes(self.path)
        self.size = self._bytes.size
        with self._bytes.access() as data:
            head = data[:_MAX_HEAD]
            other = other_format(head)
            if other is not None:
                raise LogError(f"cannot open {self.path}: this is {other}, not a stream of MAVLink packets")
            self.timestamped = looks_timestamped(head, dialect) if timestamped is None else timestamped
            self._index = self._indexed(data)
            self._data = data
        ids = self._index.counts
        self._ids = {dialect.name_of(message_id): message_id for message_id in ids}
        self.counts: dict[str, int] = {name: ids[message_id] for name, message_id in self._ids.items()}
        self._tables: dict[str, MessageTable] = {}

    def __getitem__(self, name: str) -> MessageTable:
        if name not in self._tables:
            self.load(name)
        return self._tables[name]

    def load(self, *names: str) -> None:
        """Decode several tables in one pass, which is faster than one after the other.

        Args:
            names: The message names; without names all tables are decoded.

        Raises:
            UnknownMessageError: The log has no message of that name.
            LogError: The file was truncated or rewritten since it was opened.
        """
        missing = [name for name in dict.fromkeys(names or self) if name not in self._tables]
        dtypes = [self._dtype(name) for name in missing]
        tables = [np.empty(self.counts[name], dtype) for name, dtype in zip(missing, dtypes, strict=True)]
        rows = [
            (self._ids[name], table.view(np.uint8).data) for name, table in zip(missing, tables, strict=True)
        ]
        with self._bytes.access() as data:
            if data is not self._data:
                self._use_copy(data)
            self._index.decode(rows, threads=self._threads)
        self._tables.update(
            (name, table.view(MessageTable)) for name, table in zip(missing, tables, strict=True)
        )

    def _indexed(self, data: mmap.mmap | bytes) -> Index:
        return Index(data, self.dialect, timestamped=self.timestamped, threads=self._threads)

    def _use_copy(self, data: mmap.mmap | bytes) -> None:
        """Continue with a copy of the file, which another process has opened for writing meanwhile."""
        index = self._indexed(data)
        if index.statistics != self._index.statistics or index.counts != self._index.counts:
            raise LogError(f"cannot read {self.path}: it was rewritten since it was opened; open it again")
        self._index, self._data = index, data

    def _dtype(self, name: str) -> np.dtype[np.void]:
        message_id = self._ids.get(name)
        if message_id is None:
            raise UnknownMessageError(f"{self.path} contains no {name}; it contains {', '.join(self)}")
        return table_dtype(self.dialect[name].definition, self._index.row_size(message_id))

    def __iter__(self) -> Iterator[str]:
        return iter(self._ids)

    def __len__(self) -> int:
        return len(self._ids)

    def __contains__(self, name: object) -> bool:
        return name in self._ids

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
    def duration(self) -> float:
        """Seconds from the earliest to the latest recorded time; 0 without times."""
        span = self._index.time_span
        return 0.0 if span is None else (span[1] - span[0]) / 1e6

    def clear_cache(self, name: str | None = None) -> None:
        """Drop decoded tables, which are decoded again on the next access.

        Args:
            name: The message name; None for all tables.
        """
        if name is None:
            self._tables.clear()
        else:
            self._tables.pop(name, None)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        self.clear_cache()

    def __repr__(self) -> str:
        return f"<LogFile {self.path.name}: {self.statistics.packets} packets, {len(self)} messages>"


def open_log(
    path: str | os.PathLike[str],
    dialect: HasDialect | str = "all",
    *,
    timestamped: bool | None = None,
    threads: int = 0,
) -> LogFile:
    """Open a tlog or a raw stream of packets as a mapping from message names to tables.

    Args:
        path: Path of the file.
        dialect: The dialect of the messages, as a `Dialect`, a dialect module or a name.
        timestamped: True for a tlog, False for a raw stream; None detects it from the content.
        threads: Maximum number of threads; 0 for one per processor.

    Returns:
        The log, with all packets indexed and no table decoded.

    Raises:
        LogError: The file cannot be read.
        UnknownDialectError: There is no dialect of that name.
    """
    loaded = Dialect.load(dialect) if isinstance(dialect, str) else dialect.dialect
    return LogFile(path, loaded, timestamped=timestamped, threads=threads)
