"""Records of a log one after the other, for programs that walk through a flight."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from heapq import merge
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator
    from typing import Any

    from mavstack.dialects import Message
    from mavstack.logs.message_table import MessageTable


class LogText(NamedTuple):
    """A text of the vehicle: STATUSTEXT, MSG or a logged message.

    Attributes:
        time: Time in UTC; NaT if it is not known.
        severity: MAV_SEVERITY, 0 (emergency) to 7 (debug); 6 (info) where the format has none.
        text: The text.
        system: System id of the sender; 0 in logs of one vehicle.
        boot_us: Time since boot in microseconds, or None.
    """

    time: np.datetime64
    severity: int
    text: str
    system: int = 0
    boot_us: int | None = None


class ParameterChange(NamedTuple):
    """A parameter with another value than before.

    Attributes:
        time: Time in UTC; NaT if it is not known.
        name: Name of the parameter.
        before: The value before, or None if it was not known.
        value: The new value.
        system: System id of the vehicle; 0 in logs of one vehicle.
        boot_us: Time since boot in microseconds, or None.
    """

    time: np.datetime64
    name: str
    before: float | None
    value: float
    system: int = 0
    boot_us: int | None = None


def differs(before: float | None, value: float) -> bool:
    """Return whether a parameter has another value than before; NaN stays NaN.

    Args:
        before: The value before, or None.
        value: The new value.
    """
    return before != value and not (before != before and value != value)


class LogRecord(Mapping[str, object]):
    """One record of a log: a mapping from field names to values.

    Attributes:
        name: Name of the record's table.
    """

    name: str

    @property
    @abstractmethod
    def time(self) -> np.datetime64:
        """Time in UTC, in microseconds; NaT if it is not known."""

    @property
    def message(self) -> Message | None:
        """The typed message; None in logs that are not of packets."""
        return None

    @property
    def system(self) -> int:
        """System id of the sender; 0 in logs of one vehicle."""
        return 0

    @property
    def component(self) -> int:
        """Component id of the sender; 0 in logs of one vehicle."""
        return 0

    def __eq__(self, other: object) -> bool:
        return self is other

    def __hash__(self) -> int:
        return id(self)

    def __repr__(self) -> str:
        fields = ", ".join(f"{name}={value!r}" for name, value in self.items() if not name.startswith("_"))
        return f"<{self.name} {self.time}: {fields}>"


class RowRecord(LogRecord):
    """A row of a table as a record.

    Args:
        name: Name of the table.
        row: The row.
    """

    def __init__(self, name: str, row: np.void) -> None:
        self.name = name
        self._row = row

    @property
    def time(self) -> np.datetime64:
        """Time in UTC, in microseconds; NaT if it is not known."""
        time: np.datetime64 = self._row["_time"]
        return time

    @property
    def system(self) -> int:
        """System id of the sender; 0 in logs of one vehicle."""
        return int(self._row["_system"]) if "_system" in self else 0

    @property
    def component(self) -> int:
        """Component id of the sender; 0 in logs of one vehicle."""
        return int(self._row["_component"]) if "_component" in self else 0

    def __getitem__(self, field: str) -> Any:  # noqa: ANN401 (values of all kinds)
        if field not in self:
            raise KeyError(field)
        value = self._row[field]
        if isinstance(value, bytes):
            return value.decode("utf-8", "replace")
        return (
            value.tolist() if isinstance(value, np.ndarray) else value.item() if field != "_time" else value
        )

    def __contains__(self, field: object) -> bool:
        return field in (self._row.dtype.names or ())

    def __iter__(self) -> Iterator[str]:
        return iter(self._row.dtype.names or ())

    def __len__(self) -> int:
        return len(self._row.dtype.names or ())


def merged_rows(tables: Mapping[str, MessageTable]) -> Iterator[RowRecord]:
    """Return the rows of several tables as records, in the order of their times.

    Args:
        tables: Tables by name, each in the order of time.
    """
    return merge(*map(_rows, tables.items()), key=_time_order)


def _rows(item: tuple[str, MessageTable]) -> Iterator[RowRecord]:
    name, table = item
    return (RowRecord(name, row) for row in table.view(np.ndarray))


def _time_order(record: RowRecord) -> int:
    return int(record.time.astype(np.int64))
