"""Tables of flights: the columns of a kind of frame, and rows as structured arrays.

Successive fields `q[0]`, `q[1]` … are one array column `q`. Fields are 32-bit integers, signed as the header
says, except for the time.
"""

from __future__ import annotations

import re
from itertools import groupby
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from typing import Any

    from numpy.typing import NDArray

    from mavstack.logs.blackbox.flight import Rows
    from mavstack.logs.blackbox.header import FrameDefinition

TIME: Final = "time"
_HEADER: Final = [("_time", "<M8[us]"), ("_instance", "<u2")]
EVENT_DTYPE: Final = np.dtype([*_HEADER, (TIME, "<i8"), ("event", "u1"), ("value", "<f8"), ("detail", "<f8")])
#: Arrays whose elements have different meanings, so each element is a separate column.
_NO_ARRAYS: Final = ("GPS_coord", "GPS_home")
_ELEMENT: Final = re.compile(r"(?P<field>.+)\[(?P<index>\d+)\]")


class Column(NamedTuple):
    """A column: name, number of its first field, number of elements (0 for one value), and sign."""

    name: str
    first: int
    size: int
    signed: bool


def columns(definition: FrameDefinition) -> list[Column]:
    """Return the columns of a frame.

    Args:
        definition: The definition of the frame.
    """
    found: list[Column] = []
    for (base, signed), group in groupby(_numbered(definition), lambda item: (_base(item[1]), item[2])):
        members = list(group)
        indexes = [_index(name) for _, name, _ in members]
        if base and indexes == list(range(len(members))):
            found.append(Column(base, members[0][0], len(members), signed))
        else:
            found += [Column(name, number, 0, signed) for number, name, signed in members]
    names = [column.name for column in found]
    if len(set(names)) < len(names):
        return [Column(name, number, 0, signed) for number, name, signed in _numbered(definition)]
    return found


def _numbered(definition: FrameDefinition) -> Iterator[tuple[int, str, bool]]:
    return zip(range(len(definition.names)), definition.names, definition.signed, strict=True)


def _base(name: str) -> str:
    found = _ELEMENT.fullmatch(name)
    return "" if found is None or found["field"] in _NO_ARRAYS else found["field"]


def _index(name: str) -> int:
    found = _ELEMENT.fullmatch(name)
    return -1 if found is None else int(found["index"])


def table_dtype(definition: FrameDefinition) -> np.dtype[np.void]:
    """Return the type of the table of a kind of frame.

    Args:
        definition: The definition of the frame.
    """
    fields: list[Any] = [] if TIME in definition.names else [(TIME, "<i8")]
    for column in columns(definition):
        kind = "<i8" if column.name == TIME else "<i4" if column.signed else "<u4"
        fields.append((column.name, kind, (column.size,)) if column.size else (column.name, kind))
    return np.dtype([*_HEADER, *fields])


def table_rows(rows: Rows, definition: FrameDefinition) -> NDArray[np.void]:
    """Return rows as a structured array, without their UTC and the number of the flight.

    Args:
        rows: The rows.
        definition: The definition of their frame.
    """
    table = np.zeros(len(rows.times), table_dtype(definition))
    values = np.frombuffer(rows.values, np.int64).reshape(len(table), len(definition.names))
    table[TIME] = np.frombuffer(rows.times, np.int64)
    for column in columns(definition):
        if column.name == TIME:
            continue
        picked = values[:, column.first : column.first + (column.size or 1)].astype(np.uint32)
        picked = picked.view(np.int32) if column.signed else picked
        table[column.name] = picked if column.size else picked[:, 0]
    return table


def event_rows(events: Sequence[tuple[Any, int, int]]) -> NDArray[np.void]:
    """Return events as a structured array, without their UTC and the number of the flight.

    Args:
        events: The events with the time and the position of each.
    """
    table = np.zeros(len(events), EVENT_DTYPE)
    table[TIME] = [time for _, time, _ in events]
    for name, values in (
        ("event", [event.kind for event, _, _ in events]),
        ("value", [event.value for event, _, _ in events]),
        ("detail", [event.detail for event, _, _ in events]),
    ):
        table[name] = values
    return table
