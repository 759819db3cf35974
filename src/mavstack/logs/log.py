"""The interface of all logs, whatever their format: a mapping from names to tables.

A format derives from `Log` and implements what differs: `counts`, `schema`, `decode_tables`, `skipped`, and
the methods named `read_…`, which take the log or a view of it. Everything else is here, for any format.
"""

from __future__ import annotations

import re
from abc import abstractmethod
from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack.errors import InvalidArgumentError, LogError, UnknownMessageError
from mavstack.logs.message_table import MessageTable
from mavstack.logs.records import merged_rows
from mavstack.logs.select import Selection, parse_moment
from mavstack.logs.table_text import suggestion
from mavstack.logs.time_base import CLOCKS, TimeBase, unix_seconds

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from pathlib import Path
    from typing import Self

    from numpy.typing import NDArray

    from mavstack.logs.damage import LogDamage
    from mavstack.logs.records import LogRecord, LogText, ParameterChange
    from mavstack.logs.schema import TableSchema
    from mavstack.logs.select import Moment
    from mavstack.logs.time_base import Clock, ClockChoice
    from mavstack.logs.vehicles import LogVehicle

#: Bytes of a file that `windows` decodes at a time.
DEFAULT_WINDOW: Final = 32 << 20
_INSTANCE: Final = re.compile(r"(?P<name>.+)\[(?P<instance>\d+)\]")


class Log(Mapping[str, MessageTable]):
    """A log as a mapping from names to tables: `log["ATTITUDE"]["roll"]` is a column.

    The names are those of MAVLink messages, of ULog topics, or of DataFlash record types. `log["GPS[1]"]` is
    the table of one instance. A table is decoded on first access and kept until `clear_cache`.

    Attributes:
        path: Path of the file.
        format: Name of the format: "tlog", "raw", "dataflash" …
        size: Size of the file in bytes.
    """

    format: str = ""

    def __init__(self, path: Path, size: int) -> None:
        self.path = path
        self.size = size
        self._tables: dict[str, MessageTable] = {}

    # implemented by each format; `log` is the log itself or a view of it

    @property
    @abstractmethod
    def counts(self) -> Mapping[str, int]:
        """Number of rows by table name."""

    @abstractmethod
    def schema(self, name: str) -> TableSchema:
        """Return the meaning of the columns of a table, without decoding the table.

        Args:
            name: Name of the table.

        Returns:
            Units, multipliers, enums and descriptions of all columns.

        Raises:
            UnknownMessageError: The log has no table of that name.
        """

    @abstractmethod
    def decode_tables(self, names: Sequence[str]) -> Mapping[str, MessageTable]:
        """Decode tables that the log has, in one pass."""

    @property
    @abstractmethod
    def skipped(self) -> LogDamage:
        """Counts of everything in the file that is in no table."""

    @property
    def time_span(self) -> tuple[float, float] | None:
        """Earliest and latest time in seconds on the log's own time base, or None without times."""
        return None

    def boot_times(self, name: str, table: MessageTable) -> NDArray[np.float64] | None:
        """Return the time since boot in seconds of each row of (a part of) a table.

        Args:
            name: Name of the table.
            table: The rows.

        Returns:
            The times, NaN where not known; None if the table has none.
        """
        return None

    def utc_times(self, name: str, table: MessageTable) -> NDArray[np.float64] | None:
        """Return the UTC in seconds since 1970 of each row of (a part of) a table; see `boot_times`."""
        return None if self.clock == "boot" else unix_seconds(table["_time"])

    def read_time_base(self, log: Log) -> TimeBase:
        """Return the clock of a view of this log."""
        return TimeBase("boot")

    def read_info(self, log: Log) -> dict[str, str]:
        """Return the facts about the vehicle that a view of this log holds."""
        return {}

    def read_parameters(self, log: Log) -> tuple[dict[str, float], list[ParameterChange]]:
        """Return the first value of each parameter in a view of this log, and the changes."""
        return {}, []

    def read_texts(self, log: Log) -> list[LogText]:
        """Return the texts of the vehicle in a view of this log."""
        return []

    def read_vehicles(self, log: Log) -> dict[int, LogVehicle]:
        """Return the vehicles in a view of this log by system id."""
        return {}

    def selected_rows(self, name: str, selection: Selection) -> int | None:
        """Return how many rows of a table a selection keeps; None if only its decoded rows can tell.

        Args:
            name: Name of the table.
            selection: The selection, which keeps the table itself.
        """
        return self.counts[name] if selection.keeps_all_rows(self.schema(name)) else None

    def prepare_windows(self) -> None:
        """Release memory that only speeds up decoding; learn `counts`, `time_span` and `skipped`."""

    # the interface of `Mapping`

    def __getitem__(self, name: str) -> MessageTable:
        if name not in self._tables:
            if name not in self.counts and (found := _INSTANCE.fullmatch(name)):
                return self._instance(found["name"], int(found["instance"]))
            self.load(name)
        return self._tables[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.counts)

    def __len__(self) -> int:
        return len(self.counts)

    def __contains__(self, name: object) -> bool:
        return name in self.counts

    def _instance(self, name: str, instance: int) -> MessageTable:
        table = self[name]
        field = table.schema.instance_field
        if not field:
            raise UnknownMessageError(f"{self.path}: {name} has no instances")
        selected = table.where(table[field] == instance)
        if not len(selected):
            known = ", ".join(map(str, np.unique(table[field]).tolist()))
            raise UnknownMessageError(f"{self.path} contains no {name}[{instance}]; instances: {known}")
        return selected

    def _require(self, names: Sequence[str]) -> list[str]:
        """Return the names without duplicates, or all names without any; raises if the log lacks one."""
        for name in names:
            if name not in self.counts:
                close = suggestion(name, self)
                raise UnknownMessageError(
                    f"{self.path} contains no {name}{close}; it contains {', '.join(self)}"
                )
        return list(dict.fromkeys(names or self))

    def load(self, *names: str) -> None:
        """Decode several tables in one pass, which is faster than one after the other.

        Args:
            names: The names; without names all tables are decoded.

        Raises:
            UnknownMessageError: The log has no table of that name.
            LogError: The file was truncated or rewritten since it was opened.
        """
        missing = [name for name in self._require(names) if name not in self._tables]
        self._tables.update(self.decode_tables(missing))

    def clear_cache(self, name: str | None = None) -> None:
        """Drop decoded tables, which are decoded again on the next access.

        Args:
            name: The name; None for all tables.
        """
        if name is None:
            self._tables.clear()
        else:
            self._tables.pop(name, None)

    def close(self) -> None:
        """Release the decoded tables and other resources; a later access takes them again. Idempotent."""
        self.clear_cache()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()

    def windows(
        self,
        size: int = DEFAULT_WINDOW,
        names: Sequence[str] | None = None,
        *,
        progress: Callable[[int, int], None] | None = None,
    ) -> Iterator[dict[str, MessageTable]]:
        """Yield the file piece by piece, in bounded memory.

        All pieces of a name are its table. A format that can only be read as a whole yields one piece.

        Args:
            size: Approximate size of a piece in bytes of the file.
            names: Names of the tables to decode, which may be absent from the file; None for all.
            progress: Called with the bytes of the file that were read, and with its size.

        Yields:
            The tables of a piece, those with rows only.

        Raises:
            LogError: The file was truncated or rewritten since it was opened.
        """
        wanted = [name for name in self if names is None or name in names]
        tables = self.decode_tables(wanted)
        yield {name: table for name, table in tables.items() if len(table)}
        if progress is not None:
            progress(self.size, self.size)

    def records(self, *names: str) -> Iterator[LogRecord]:
        """Iterate over the records one after the other, in the order of the file where the format keeps it.

        Args:
            names: Names of the tables, which may be absent from the file; without names all.

        Yields:
            The records; those of packet logs have the typed message in `message`.

        Raises:
            LogError: The file was truncated or rewritten since it was opened.
        """
        for tables in self.windows(names=names or None):
            yield from merged_rows(tables)

    def select(
        self,
        *names: str,
        system: int | None = None,
        component: int | None = None,
        instance: int | None = None,
        start: Moment | None = None,
        end: Moment | None = None,
    ) -> Log:
        """Return a view with some of the tables and rows.

        Args:
            names: Names of the tables; without names all.
            system: System id; None for all.
            component: Component id; None for all.
            instance: Instance of a sensor or topic; None for all.
            start: First time that is kept: seconds from the beginning, or UTC as datetime64, datetime or
                ISO 8601 text; None for the beginning.
            end: First time that is not kept any more, as `start`; None for the end.

        Returns:
            The view, a log with the same interface.

        Raises:
            UnknownMessageError: The log has no table of that name.
            InvalidArgumentError: `start` or `end` is no time.
        """
        tables = tuple(self._require(names)) if names else ()
        first, last = parse_moment(start, "start"), parse_moment(end, "end")
        return LogView(self, Selection(tables, system, component, instance, first, last))

    # time

    @cached_property
    def time_base(self) -> TimeBase:
        """The best clock of the log, and its offset to the time since boot."""
        return self.read_time_base(self)

    @property
    def clock(self) -> Clock:
        """The kind of the time base: "utc", "received" or "boot"."""
        return self.time_base.kind

    @property
    def start(self) -> np.datetime64 | None:
        """Earliest time in UTC, or None if it is not known."""
        return self._utc(0)

    @property
    def end(self) -> np.datetime64 | None:
        """Latest time in UTC, or None if it is not known."""
        return self._utc(1)

    def _utc(self, index: int) -> np.datetime64 | None:
        span = self.time_span
        if span is None or self.clock == "boot":
            return None
        microseconds = round(span[index] * 1e6)
        # A damaged record may have a time that does not fit into a datetime64.
        return np.datetime64(microseconds, "us") if abs(microseconds) < 1 << 63 else None

    @property
    def duration(self) -> float:
        """Seconds from the earliest to the latest recorded time; 0 without times."""
        first, last = self.time_span or (0.0, 0.0)
        return last - first

    def times(self, name: str, base: ClockChoice = "auto") -> NDArray[np.float64]:
        """Return the time of each row of a table in seconds.

        Args:
            name: Name of the table.
            base: "utc", "received": seconds since 1970; "boot": since boot; "auto": those of `time_base`.

        Returns:
            The times; NaN where the time is not known.

        Raises:
            UnknownMessageError: The log has no table of that name.
            InvalidArgumentError: `base` is none of these.
            LogError: The log does not hold that clock for the table.
        """
        return self.times_of(name, self[name], base)

    def times_of(self, name: str, table: MessageTable, base: ClockChoice = "auto") -> NDArray[np.float64]:
        """Return the time of each row of (a part of) a table in seconds; see `times`."""
        if base not in CLOCKS:
            raise InvalidArgumentError(f"base must be one of {', '.join(CLOCKS)}, got {base!r}")
        wanted = self.clock if base == "auto" else base
        times = None
        if wanted == "boot":
            times = self.boot_times(name, table)
        elif wanted == "utc":
            times = self.utc_times(name, table)
        elif self.clock == "received":
            times = unix_seconds(table["_time"])
        if times is None:
            raise LogError(f"{self.path}: the {wanted} time of {name} is not known")
        return times

    def seconds_from_start(self, name: str, table: MessageTable) -> NDArray[np.float64]:
        """Return the times of rows in seconds from the beginning of the log."""
        return self.times_of(name, table, "auto") - (self.time_span or (0.0,))[0]

    # the vehicle

    @cached_property
    def info(self) -> dict[str, str]:
        """Facts about the vehicle that the file holds.

        Those that it can fill of `system`, `vehicle_type`, `autopilot`, `firmware_version`, `firmware_git`,
        `hardware`, `uid`, and others of the format.
        """
        return self.read_info(self)

    @property
    def parameters(self) -> dict[str, float]:
        """First value of each parameter by name; integer parameters have integer values."""
        return self._parameters[0]

    @property
    def parameter_changes(self) -> list[ParameterChange]:
        """Changes of parameters, in the order of the file."""
        return self._parameters[1]

    @cached_property
    def _parameters(self) -> tuple[dict[str, float], list[ParameterChange]]:
        return self.read_parameters(self)

    @property
    def texts(self) -> list[LogText]:
        """Texts of the vehicle, in the order of the file."""
        return self.read_texts(self)

    @cached_property
    def vehicles(self) -> dict[int, LogVehicle]:
        """Vehicles in the log by system id; `log.select(system=…)` is the log of one of them."""
        return self.read_vehicles(self)

    def __repr__(self) -> str:
        rows = sum(self.counts.values())
        return f"<{type(self).__name__} {self.path.name}: {rows} rows, {len(self)} tables>"


class LogView(Log):
    """Some tables and rows of another log.

    Args:
        log: The other log.
        selection: The rows to keep.
    """

    def __init__(self, log: Log, selection: Selection) -> None:
        super().__init__(log.path, log.size)
        self.format = log.format
        self._log = log
        self._selection = selection
        self._counts: dict[str, int] | None = None

    @property
    def counts(self) -> Mapping[str, int]:
        """Number of selected rows by table name; tables without such rows are left out."""
        if self._counts is None:
            wanted = self._selection.names or self._log
            names = [name for name in self._log if name in wanted and self._keeps_table(name)]
            counts = {name: self._log.selected_rows(name, self._selection) for name in names}
            unknown = [name for name, rows in counts.items() if rows is None]
            if unknown:
                self._log.load(*unknown)
            counts |= {name: len(self._rows(name, self._log[name])) for name in unknown}
            self._counts = {name: rows for name, rows in counts.items() if rows}
        return self._counts

    def schema(self, name: str) -> TableSchema:
        """Return the meaning of the columns of a table; see `Log.schema`."""
        return self._log.schema(name)

    def _keeps_table(self, name: str) -> bool:
        return self._selection.keeps_table(name, self._log.schema(name))

    def _rows(self, name: str, table: MessageTable) -> MessageTable:
        seconds = self._seconds(name, table) if self._selection.has_times else None
        mask = self._selection.mask(table, seconds)
        return table if mask is None else table.where(mask)

    def _seconds(self, name: str, table: MessageTable) -> NDArray[np.float64]:
        try:
            return self._log.seconds_from_start(name, table)
        except LogError:
            raise LogError(
                f"cannot select rows of {name} by time: {self.path} has no times of reception, and {name} "
                "has no time of its own; leave out start and end, or name only tables that have one"
            ) from None

    def decode_tables(self, names: Sequence[str]) -> Mapping[str, MessageTable]:
        """Decode tables; see `Log.decode_tables`."""
        self._log.load(*names)
        return {name: self._rows(name, self._log[name]) for name in names}

    def prepare_windows(self) -> None:
        """Make ready for `windows`; see `Log.prepare_windows`."""
        self._log.prepare_windows()

    def windows(
        self,
        size: int = DEFAULT_WINDOW,
        names: Sequence[str] | None = None,
        *,
        progress: Callable[[int, int], None] | None = None,
    ) -> Iterator[dict[str, MessageTable]]:
        """Yield the file piece by piece; see `Log.windows`."""
        wanted = self._selection.names or None
        if names is not None:
            wanted = tuple(name for name in names if wanted is None or name in wanted)
        for tables in self._log.windows(size, wanted, progress=progress):
            selected = {
                name: self._rows(name, table)
                for name, table in tables.items()
                if self._selection.keeps_table(name, table.schema)
            }
            yield {name: table for name, table in selected.items() if len(table)}

    def records(self, *names: str) -> Iterator[LogRecord]:
        """Iterate over the selected records; see `Log.records`."""
        selection = self._selection
        if selection.has_times and self.clock == "boot":
            yield from super().records(*names)
            return
        first = (self._log.time_span or (0.0,))[0] if selection.has_times else 0.0
        fields: dict[str, str] = {}
        for record in self._log.records(*(names or selection.names)):
            if record.name not in fields:
                fields[record.name] = self._log.schema(record.name).instance_field
            if selection.keeps_record(record, fields[record.name], first):
                yield record

    @property
    def clock(self) -> Clock:
        """The kind of the time base; see `Log.clock`."""
        return self._log.clock

    @property
    def skipped(self) -> LogDamage:
        """Counts of everything in the whole file that is in no table."""
        return self._log.skipped

    @property
    def time_span(self) -> tuple[float, float] | None:
        """Earliest and latest selected time; see `Log.time_span`."""
        span = self._log.time_span
        return None if span is None else self._selection.clip(span)

    def boot_times(self, name: str, table: MessageTable) -> NDArray[np.float64] | None:
        """Return the time since boot of each row; see `Log.boot_times`."""
        return self._log.boot_times(name, table)

    def utc_times(self, name: str, table: MessageTable) -> NDArray[np.float64] | None:
        """Return the UTC of each row; see `Log.utc_times`."""
        return self._log.utc_times(name, table)

    def read_time_base(self, log: Log) -> TimeBase:
        """Return the clock of a view; see `Log.read_time_base`."""
        return self._log.read_time_base(log)

    def read_info(self, log: Log) -> dict[str, str]:
        """Return the facts of a view; see `Log.read_info`."""
        return self._log.read_info(log)

    def read_parameters(self, log: Log) -> tuple[dict[str, float], list[ParameterChange]]:
        """Return the parameters of a view; see `Log.read_parameters`."""
        return self._log.read_parameters(log)

    def read_texts(self, log: Log) -> list[LogText]:
        """Return the texts of a view; see `Log.read_texts`."""
        return self._log.read_texts(log)

    def read_vehicles(self, log: Log) -> dict[int, LogVehicle]:
        """Return the vehicles of a view; see `Log.read_vehicles`."""
        return self._log.read_vehicles(log)
