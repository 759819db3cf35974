"""Several logs as one: their tables, with times on one timeline."""

from __future__ import annotations

from functools import cached_property
from heapq import merge
from typing import TYPE_CHECKING

import numpy as np

from mavstack.logs.damage import LogDamage
from mavstack.logs.log import DEFAULT_WINDOW, Log
from mavstack.logs.records import merged_rows
from mavstack.logs.time_base import TimeBase, unix_seconds

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from numpy.typing import NDArray

    from mavstack.logs.merged_source import LogOffset, MergedSource
    from mavstack.logs.message_table import MessageTable
    from mavstack.logs.records import LogRecord, LogText, ParameterChange, RowRecord
    from mavstack.logs.schema import TableSchema
    from mavstack.logs.time_base import Clock
    from mavstack.logs.vehicles import LogVehicle


class MergedLog(Log):
    """Several logs of one flight on one timeline, which `merge_logs` creates.

    A table keeps its name. If several logs have a table of that name, the tables of the second and later logs
    are named after their log: `tlog 2:ATTITUDE`.

    Args:
        sources: The logs.
        clock: The clock of the timeline.
    """

    format = "merged"

    def __init__(self, sources: Sequence[MergedSource], clock: Clock) -> None:
        first = sources[0].log
        super().__init__(first.path, sum(source.log.size for source in sources))
        self._sources = tuple(sources)
        self._clock: Clock = clock
        self._places: dict[str, tuple[MergedSource, str]] = {}
        for source in self._sources:
            for name in source.log:
                self._places[self._name_of(source, name)] = (source, name)

    @property
    def offsets(self) -> list[LogOffset]:
        """By how much the times of each log were shifted, and how well that is known."""
        return [source.offset for source in self._sources]

    @property
    def logs(self) -> dict[str, Log]:
        """The logs by label."""
        return {source.offset.label: source.log for source in self._sources}

    def _name_of(self, source: MergedSource, name: str) -> str:
        place = self._places.get(name)
        return name if place is None or place[0] is source else f"{source.offset.label}:{name}"

    @property
    def counts(self) -> Mapping[str, int]:
        """Number of rows by table name."""
        return {key: source.log.counts[name] for key, (source, name) in self._places.items()}

    def schema(self, name: str) -> TableSchema:
        """Return the meaning of the columns of a table; see `Log.schema`."""
        self._require([name])
        source, own_name = self._places[name]
        return source.log.schema(own_name)

    def decode_tables(self, names: Sequence[str]) -> Mapping[str, MessageTable]:
        """Decode tables; see `Log.decode_tables`."""
        for source in self._sources:
            source.log.load(*(own for owner, own in map(self._places.__getitem__, names) if owner is source))
        return {name: self._shifted(*self._places[name]) for name in names}

    def _shifted(self, source: MergedSource, name: str) -> MessageTable:
        return source.shifted(name, source.log[name])

    def prepare_windows(self) -> None:
        """Make all logs ready; see `Log.prepare_windows`."""
        for source in self._sources:
            source.log.prepare_windows()

    def windows(
        self,
        size: int = DEFAULT_WINDOW,
        names: Sequence[str] | None = None,
        *,
        progress: Callable[[int, int], None] | None = None,
    ) -> Iterator[dict[str, MessageTable]]:
        """Yield the logs one after the other, each piece by piece; see `Log.windows`."""
        done = 0
        for source in self._sources:
            yield from self._source_windows(source, size, names, progress, done)
            done += source.log.size

    def _source_windows(
        self,
        source: MergedSource,
        size: int,
        names: Sequence[str] | None,
        progress: Callable[[int, int], None] | None = None,
        before: int = 0,
    ) -> Iterator[dict[str, MessageTable]]:
        keys = {own: key for key, (owner, own) in self._places.items() if owner is source}
        wanted = [own for own, key in keys.items() if names is None or key in names]
        report = None if progress is None else lambda done, _: progress(before + done, self.size)
        for tables in source.log.windows(size, wanted, progress=report):
            yield {keys[own]: source.shifted(own, table) for own, table in tables.items()}

    def records(self, *names: str) -> Iterator[LogRecord]:
        """Iterate over the rows of all logs in the order of the timeline; see `Log.records`."""
        return merge(*(self._source_records(source, names) for source in self._sources), key=_time)

    def _source_records(self, source: MergedSource, names: tuple[str, ...]) -> Iterator[RowRecord]:
        for tables in self._source_windows(source, DEFAULT_WINDOW, names or None):
            yield from merged_rows(tables)

    @property
    def skipped(self) -> LogDamage:
        """Counts of everything in the files that is in no table, added up."""
        parts = [source.log.skipped for source in self._sources]
        unknown: dict[int, int] = {}
        other: dict[str, int] = {}
        for part in parts:
            for number, count in part.unknown.items():
                unknown[number] = unknown.get(number, 0) + count
            for reason, count in part.other.items():
                other[reason] = other.get(reason, 0) + count
        return LogDamage(
            bad_bytes=sum(part.bad_bytes for part in parts),
            bad_records=sum(part.bad_records for part in parts),
            truncated_bytes=sum(part.truncated_bytes for part in parts),
            unknown=unknown,
            other=other,
        )

    @property
    def clock(self) -> Clock:
        """The clock of the timeline."""
        return self._clock

    @cached_property
    def time_span(self) -> tuple[float, float] | None:
        """Earliest and latest time on the timeline in seconds, or None without times."""
        spans = [span for source in self._sources if (span := source.span()) is not None]
        return (min(first for first, _ in spans), max(last for _, last in spans)) if spans else None

    def utc_times(self, name: str, table: MessageTable) -> NDArray[np.float64] | None:
        """Return the time of each row on the timeline; see `Log.utc_times`."""
        return unix_seconds(table["_time"])

    def boot_times(self, name: str, table: MessageTable) -> NDArray[np.float64] | None:
        """Return the time since boot of each row; see `Log.boot_times`."""
        if self._clock == "boot":
            return unix_seconds(table["_time"])
        source, own_name = self._places[name]
        return source.log.boot_times(own_name, table)

    def read_time_base(self, log: Log) -> TimeBase:
        """Return the clock of the timeline, and the offset of the reference."""
        reference = next(source.log for source in self._sources if source.offset.source == "reference")
        base = reference.time_base
        return TimeBase(self._clock, base.offset_us, base.uncertainty_us, base.source)

    def read_info(self, log: Log) -> dict[str, str]:
        """Return the facts of all logs, those of the first log that has them."""
        facts: dict[str, str] = {}
        for source in self._sources:
            facts = source.log.info | facts
        return facts

    def read_parameters(self, log: Log) -> tuple[dict[str, float], list[ParameterChange]]:
        """Return the parameters of the log with the most parameters, normally the vehicle's own."""
        best = max(self._sources, key=lambda source: len(source.log.parameters))
        changes = [change._replace(time=best.moved(change)) for change in best.log.parameter_changes]
        return best.log.parameters, changes

    def read_texts(self, log: Log) -> list[LogText]:
        """Return the texts of all logs, in the order of the timeline."""
        found = [
            text._replace(time=source.moved(text)) for source in self._sources for text in source.log.texts
        ]
        return sorted(found, key=lambda text: int(text.time.astype(np.int64)))

    def read_vehicles(self, log: Log) -> dict[int, LogVehicle]:
        """Return the vehicles of all logs by system id."""
        found: dict[int, LogVehicle] = {}
        for source in self._sources:
            found = source.log.vehicles | found
        return found


def _time(record: LogRecord) -> int:
    return int(record.time.astype(np.int64))
