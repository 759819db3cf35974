"""Differences between logs: the parameters of the vehicle, and the mission that it flew."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING, Any, Final

import numpy as np

if TYPE_CHECKING:
    from mavstack.logs.log import Log
    from mavstack.logs.message_table import MessageTable

#: Fields of a mission item, by the table that holds it; the first one is its number.
_ITEM_FIELDS: Final = {
    "MISSION_ITEM_INT": (
        "seq", "command", "frame", "param1", "param2", "param3", "param4", "x", "y", "z",
    ),
    "MISSION_ITEM": ("seq", "command", "frame", "param1", "param2", "param3", "param4", "x", "y", "z"),
    "CMD": ("CNum", "CId", "Frame", "Prm1", "Prm2", "Prm3", "Prm4", "Lat", "Lng", "Alt"),
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Difference:
    """A value that differs; None where a log does not have it."""

    name: str
    first: float | str | None
    second: float | str | None


def parameter_differences(first: Log, second: Log) -> list[Difference]:
    """Return the parameters whose values at the end of two logs differ, by name.

    Args:
        first: A log.
        second: Another log.
    """
    one, other = last_parameters(first), last_parameters(second)
    return [
        Difference(name, one.get(name), other.get(name))
        for name in sorted(one.keys() | other.keys())
        if one.get(name) != other.get(name)
    ]


def last_parameters(log: Log) -> dict[str, float]:
    """Return the last value of each parameter in a log.

    Args:
        log: The log.
    """
    values = dict(log.parameters)
    values.update({change.name: change.value for change in log.parameter_changes})
    return values


def mission_differences(first: Log, second: Log) -> list[Difference]:
    """Return the mission items that differ between two logs, by their number.

    Args:
        first: A log.
        second: Another log.
    """
    one, other = mission_of(first), mission_of(second)
    return [
        Difference(f"item {number}", _text(one.get(number)), _text(other.get(number)))
        for number in sorted(one.keys() | other.keys())
        if one.get(number) != other.get(number)
    ]


def mission_of(log: Log) -> dict[int, tuple[float, ...]]:
    """Return the mission items in a log by number: command, frame, parameters, position.

    Args:
        log: The log.
    """
    for name, fields in _ITEM_FIELDS.items():
        if name in log and log.schema(name).has_numbers(fields[0]):
            return _items(log[name], fields)
    return {}


def _items(table: MessageTable, fields: tuple[str, ...]) -> dict[int, tuple[float, ...]]:
    names = table.dtype.names or ()
    if "mission_type" in names:
        table = table.where(np.asarray(table["mission_type"]) == 0)
    known = [name for name in fields if table.schema.has_numbers(name)]
    columns = [np.asarray(table[name]).astype(np.float64).tolist() for name in known]
    # A later transfer replaces the items of an earlier one.
    return {
        int(row[0]): tuple(_plain(value) for value in row[1:])
        for row in zip(*columns, strict=True)
        if isfinite(row[0])
    }


def _plain(value: float) -> float:
    """Return a value that equals itself: NaN stands for "not set"."""
    return 0.0 if value != value else round(value, 7)


def _text(item: tuple[Any, ...] | None) -> str | None:
    return None if item is None else " ".join(f"{value:.10g}" for value in item)
