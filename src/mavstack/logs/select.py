"""Selection of rows: by system, component, instance and time."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import UTC, datetime
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from typing import Any

    from numpy.typing import NDArray

    from mavstack.logs.message_table import MessageTable
    from mavstack.logs.records import LogRecord
    from mavstack.logs.schema import TableSchema

#: A time: seconds from the beginning of the log, or UTC as datetime64, datetime or ISO 8601 text.
Moment: TypeAlias = "float | np.datetime64 | datetime | str"


@dataclass(frozen=True, slots=True)
class Selection:
    """The rows to keep; None keeps all.

    Attributes:
        names: Names of the tables.
        system: System id.
        component: Component id.
        instance: Instance of a sensor or topic.
        start: First time that is kept, in seconds from the beginning of the log or in UTC.
        end: First time that is not kept any more.
    """

    names: tuple[str, ...] = ()
    system: int | None = None
    component: int | None = None
    instance: int | None = None
    start: float | np.datetime64 | None = None
    end: float | np.datetime64 | None = None

    def keeps_table(self, name: str, schema: TableSchema) -> bool:
        """Return whether rows of a table can be selected: the table has the columns that are asked for.

        Args:
            name: Name of the table.
            schema: Schema of the table.
        """
        if self.names and name not in self.names:
            return False
        return self.instance is None or bool(schema.instance_field)

    def keeps_all_rows(self, schema: TableSchema) -> bool:
        """Return whether nothing in the selection can leave out a row of a table.

        Args:
            schema: Schema of the table.
        """
        ids = {"_system": self.system, "_component": self.component}
        selects_ids = any(value is not None and name in schema.names for name, value in ids.items())
        return not self.has_times and self.instance is None and not selects_ids

    def keeps_source(self, system: int | None, component: int | None) -> bool:
        """Return whether rows of a component can be selected.

        Args:
            system: System id; None in a log without.
            component: Component id; None in a log without.
        """
        return self.system in (None, system) and self.component in (None, component)

    def keeps_record(self, record: LogRecord, instance_field: str, first: float) -> bool:
        """Return whether a record is selected.

        Args:
            record: The record.
            instance_field: Name of its field that tells instances apart, or empty.
            first: Beginning of the log in seconds since 1970.
        """
        if self.names and record.name not in self.names:
            return False
        if not self.keeps_source(record.system, record.component):
            return False
        if self.instance is not None and (not instance_field or record[instance_field] != self.instance):
            return False
        return not self.has_times or self._keeps_time(record.time, first)

    def _keeps_time(self, time: np.datetime64, first: float) -> bool:
        if np.isnat(time):
            return False
        seconds = int(time.astype("M8[us]").astype(np.int64)) / 1e6 - first
        return (self.start is None or _seconds(self.start, first) <= seconds) and (
            self.end is None or seconds < _seconds(self.end, first)
        )

    def clip(self, span: tuple[float, float]) -> tuple[float, float]:
        """Return the part of a time span that is selected.

        Args:
            span: Earliest and latest time of the log in seconds.
        """
        first, last = span
        start = first if self.start is None else max(first, first + _seconds(self.start, first))
        end = last if self.end is None else min(last, first + _seconds(self.end, first))
        return start, max(start, end)

    @property
    def has_times(self) -> bool:
        """True if rows are selected by time."""
        return self.start is not None or self.end is not None

    def mask(self, table: MessageTable, seconds: NDArray[np.float64] | None) -> NDArray[np.bool_] | None:
        """Return which rows are selected, or None for all.

        Args:
            table: The rows.
            seconds: Their times in seconds from the beginning of the log; needed if `start` or `end` is a
                number.
        """
        masks = [*self._id_masks(table), *self._time_masks(table, seconds)]
        return np.logical_and.reduce(masks) if masks else None

    def _id_masks(self, table: MessageTable) -> list[NDArray[np.bool_]]:
        columns = table.dtype.names or ()
        wanted = [
            ("_system", self.system),
            ("_component", self.component),
            (table.schema.instance_field if self.instance is not None else "", self.instance),
        ]
        return [table[name] == value for name, value in wanted if value is not None and name in columns]

    def _time_masks(
        self, table: MessageTable, seconds: NDArray[np.float64] | None
    ) -> list[NDArray[np.bool_]]:
        masks = []
        for moment, is_start in ((self.start, True), (self.end, False)):
            if moment is None:
                continue
            times: NDArray[Any] | None = table["_time"] if isinstance(moment, np.datetime64) else seconds
            if times is None:
                raise InvalidArgumentError("selecting by seconds needs the times of the rows")
            # Comparisons with NaT and NaN are false, so rows of unknown time are not selected.
            masks.append(times >= moment if is_start else times < moment)
        return masks


def parse_moment(moment: Moment | None, argument: str) -> float | np.datetime64 | None:
    """Return a time as seconds from the beginning of the log or as UTC.

    Args:
        moment: Seconds, datetime64, datetime (without time zone: UTC) or ISO 8601 text; None stays None.
        argument: Name of the argument, for error texts.

    Returns:
        A float, a datetime64 in microseconds, or None.

    Raises:
        InvalidArgumentError: The value is none of these.
    """
    if moment is None or isinstance(moment, np.datetime64):
        return moment if moment is None else moment.astype("M8[us]")
    try:
        if isinstance(moment, str):
            moment = datetime.fromisoformat(moment)
        if isinstance(moment, datetime):
            aware = moment if moment.tzinfo is not None else moment.replace(tzinfo=UTC)
            return np.datetime64(aware.astimezone(UTC).replace(tzinfo=None), "us")
        return float(moment)
    except (TypeError, ValueError):
        raise InvalidArgumentError(
            f"{argument} must be seconds from the beginning of the log or a time in UTC, got {moment!r}"
        ) from None


def _seconds(moment: float | np.datetime64, first: float) -> float:
    """Return a time in seconds from the beginning of the log, which is `first` seconds since 1970."""
    if isinstance(moment, np.datetime64):
        return int(moment.astype(np.int64)) / 1e6 - first
    return moment
