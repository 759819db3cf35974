"""The common part of binary and text DataFlash logs: clocks, facts and the meaning of columns."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Final

from mavstack.logs.dataflash import clock, vehicle_facts
from mavstack.logs.dataflash.record_type import NEIGHBOUR_TIME
from mavstack.logs.log import Log
from mavstack.logs.schema import SchemaSource
from mavstack.logs.time_base import TimeBase

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    import numpy as np
    from numpy.typing import NDArray

    from mavstack.logs.dataflash.record_type import RecordType
    from mavstack.logs.message_table import MessageTable
    from mavstack.logs.records import LogText, ParameterChange
    from mavstack.logs.schema import TableSchema
    from mavstack.logs.vehicles import LogVehicle

_MODE: Final = "MODE"


class ArduPilotLog(Log):
    """A log of ArduPilot. A format implements `definitions`, `rows_without_time` and `first_and_last`."""

    def __init__(self, path: Path, size: int) -> None:
        super().__init__(path, size)
        self._schemas: dict[str, SchemaSource] = {}
        self._clock: TimeBase | None = None
        self._span: tuple[float, float] | None = None

    @property
    @abstractmethod
    def definitions(self) -> Mapping[str, RecordType]:
        """The record type of each table: format characters, labels and units as in the file."""

    @abstractmethod
    def rows_without_time(self, name: str) -> NDArray[np.void]:
        """Return a table whose column `_time` is not filled."""

    @abstractmethod
    def first_and_last(self) -> dict[str, tuple[NDArray[np.void], NDArray[np.void]]]:
        """Return the first and the last row of each table, as tables of one row without `_time`."""

    # the meaning of the columns

    def schema(self, name: str) -> TableSchema:
        """Return the meaning of the columns of a table; see `Log.schema`."""
        self._require([name])
        return self._schema_source(name).schema

    def _schema_source(self, name: str) -> SchemaSource:
        if name not in self._schemas:
            self._schemas[name] = SchemaSource(partial(self._make_schema, name))
        return self._schemas[name]

    def _make_schema(self, name: str) -> TableSchema:
        kind = self.definitions[name]
        if kind.name == _MODE:
            kind = replace(kind, enums=vehicle_facts.mode_enums([text.text for text in self.texts]))
        return kind.schema(name)

    # time

    def read_time_base(self, log: Log) -> TimeBase:
        """Return UTC by the GPS records of the file, or the time since boot without them."""
        if self._clock is None:
            self._clock = self._find_clock()
        return self._clock

    def _find_clock(self) -> TimeBase:
        for name in clock.GPS_TABLES:
            if name in self.counts:
                found = clock.gps_time_base(self.definitions[name], self.rows_without_time(name))
                if found.offset_us is not None:
                    return found
        return TimeBase("boot")

    @property
    def time_span(self) -> tuple[float, float] | None:
        """Earliest and latest time in seconds on the log's own time base, or None without times."""
        if self._span is None:
            firsts, lasts = [], []
            for name, rows in self.first_and_last().items():
                first, last = (clock.boot_microseconds(self.definitions[name], row) for row in rows)
                if first is not None and last is not None:
                    firsts.append(int(first[0]))
                    lasts.append(int(last[0]))
            found, offset = clock.span(firsts, lasts), self.time_base.offset_us or 0
            self._span = None if found is None else ((found[0] + offset) / 1e6, (found[1] + offset) / 1e6)
        return self._span

    def boot_times(self, name: str, table: MessageTable) -> NDArray[np.float64]:
        """Return the time since boot of each row; see `Log.boot_times`.

        Records of a type without a time have the time of the record before, NaN in a log without any times.
        """
        times = clock.boot_microseconds(self.definitions[name], table)
        return clock.neighbour_seconds(table) if times is None else times / 1e6

    def fill_neighbour_times(self, name: str, table: NDArray[np.void], boot_us: NDArray[np.int64]) -> None:
        """Give rows without a time the time of the records beside them.

        Args:
            name: Name of the table.
            table: Rows of it.
            boot_us: Time since boot of each row in microseconds, `NO_TIME` where no record has one.
        """
        table[NEIGHBOUR_TIME] = boot_us
        offset = self.time_base.offset_us
        if offset is not None:
            known = boot_us != clock.NO_TIME
            table["_time"][known] = (boot_us[known] + offset).view("M8[us]")

    # the vehicle

    def read_info(self, log: Log) -> dict[str, str]:
        """Return the facts in VER and the first texts."""
        return vehicle_facts.info(log)

    def read_parameters(self, log: Log) -> tuple[dict[str, float], list[ParameterChange]]:
        """Return the parameters in PARM."""
        return vehicle_facts.parameters(log)

    def read_texts(self, log: Log) -> list[LogText]:
        """Return the texts in MSG."""
        return vehicle_facts.texts(log)

    def read_vehicles(self, log: Log) -> dict[int, LogVehicle]:
        """Return the vehicle that wrote the log."""
        return vehicle_facts.vehicles(log)
