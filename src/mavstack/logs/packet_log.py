"""Logs that are packets: tlogs (a timestamp before each packet) and raw streams.

The file is mapped into memory, not read. Opening it makes an index of where each packet is, CRC checked; a
message's table is decoded when it is first asked for. Junk between packets is skipped and counted.
"""

from __future__ import annotations

import mmap
import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from mavstack._core import Index, looks_timestamped
from mavstack.dialects import Dialect
from mavstack.errors import LogError, UnknownMessageError
from mavstack.logs.tables import table_dtype

if TYPE_CHECKING:
    from typing import Self

    from mavstack.wire import SourceStatistics, Statistics

_HEAD = 1 << 18


class LogFile(Mapping[str, "np.ndarray[tuple[int], np.dtype[np.void]]"]):
    """A log as a mapping from message name to table: a numpy structured array, one row a packet.

    Columns: `_time` (datetime64 in µs UTC, NaT where not recorded), `_system`, `_component`,
    `_sequence`, `_version`, and the message's fields, raw as on the wire.
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
        data = _map(self.path)
        self._data = data
        self.size = len(data)
        self.timestamped = looks_timestamped(data[:_HEAD], dialect) if timestamped is None else timestamped
        self._index = Index(data, dialect, timestamped=self.timestamped, threads=self._threads)
        ids = self._index.counts
        self._ids = {dialect.name_of(message_id): message_id for message_id in ids}
        self.counts: dict[str, int] = {name: ids[message_id] for name, message_id in self._ids.items()}
        self._tables: dict[str, np.ndarray[tuple[int], np.dtype[np.void]]] = {}

    def __getitem__(self, name: str) -> np.ndarray[tuple[int], np.dtype[np.void]]:
        if name not in self._tables:
            self.load(name)
        return self._tables[name]

    def load(self, *names: str) -> None:
        """Decode the tables of `names`, or all tables, in one go: faster than one after the other."""
        wanted = [name for name in dict.fromkeys(names or self) if name not in self._tables]
        dtypes = [self._dtype(name) for name in wanted]
        parts = [np.empty(self.counts[name], dtype) for name, dtype in zip(wanted, dtypes, strict=True)]
        rows = [(self._ids[name], part.view(np.uint8).data) for name, part in zip(wanted, parts, strict=True)]
        # A map of bytes that the file no longer has ends the whole process where it is read.
        if isinstance(self._data, mmap.mmap) and self._data.size() < self.size:
            raise LogError(f"{self.path}: was made shorter since it was opened; open it again")
        self._index.decode(rows, threads=self._threads)
        self._tables.update(zip(wanted, parts, strict=True))

    def _dtype(self, name: str) -> np.dtype[np.void]:
        message_id = self._ids.get(name)
        if message_id is None:
            raise UnknownMessageError(f"{self.path} has no {name}; it has {', '.join(self)}")
        return table_dtype(self.dialect[name].definition, self._index.row_size(message_id))

    def __iter__(self) -> Iterator[str]:
        return iter(self._ids)

    def __len__(self) -> int:
        return len(self._ids)

    def __contains__(self, name: object) -> bool:
        return name in self._ids

    @property
    def unknown(self) -> dict[int, int]:
        """Packets whose id the dialect does not have, counted by id."""
        return self._index.unknown

    @property
    def statistics(self) -> Statistics:
        """Totals of the file: packets, bad bytes, signed packets and so on."""
        return self._index.statistics

    @property
    def sources(self) -> dict[tuple[int, int], SourceStatistics]:
        """What was heard of each (system, component)."""
        return self._index.sources

    @property
    def duration(self) -> float:
        """Seconds from the earliest packet's time to the latest's; 0 without times."""
        span = self._index.time_span
        return 0.0 if span is None else (span[1] - span[0]) / 1e6

    def forget(self, name: str | None = None) -> None:
        """Drop the decoded table of `name`, or all tables; they are decoded anew when asked for."""
        if name is None:
            self._tables.clear()
        else:
            self._tables.pop(name, None)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        self.forget()

    def __repr__(self) -> str:
        return f"<LogFile {self.path.name}: {self.statistics.packets} packets, {len(self)} messages>"


def _map(path: Path) -> mmap.mmap | bytes:
    try:
        with path.open("rb") as file:
            # A map of nothing is refused by the operating system.
            if os.fstat(file.fileno()).st_size == 0:
                return b""
            return mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
    except OSError as error:
        raise LogError(f"{path}: {error.strerror or error}") from error
    except ValueError as error:
        raise LogError(f"{path}: cannot be mapped into memory ({error}); is it a regular file?") from error


def open_log(
    path: str | os.PathLike[str],
    dialect: Dialect | str = "all",
    *,
    timestamped: bool | None = None,
    threads: int = 0,
) -> LogFile:
    """Open a tlog or a raw stream of packets as a mapping from message name to table.

    `timestamped` says whether a time precedes each packet (told from the content if not given); `threads` is
    the number of threads to decode with (0: one a processor). Raises LogError if the file cannot be read.
    """
    if isinstance(dialect, str):
        dialect = Dialect.load(dialect)
    return LogFile(path, dialect, timestamped=timestamped, threads=threads)
