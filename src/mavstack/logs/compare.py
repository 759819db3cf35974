"""Differences between logs: the parameters of the vehicle, and the mission that it flew."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING, Any, Final

import numpy as np

if TYPE_CHECKING:
    from mavstack.logs.log import Log
    from mavstack.logs.message_table import MessageTable

#: Fields of a mission item, by the table that holds it; the first field is the item number.
_ITEM_FIELDS: Final = {
    "MISSION_ITEM_INT": (
        "seq", "command", "frame", "param1", "param2", "param3", "param4", "x", "y", "z",
    ),
    "MISSION_ITEM": ("seq", "command", "frame", "param1", "param2", "param3", "param4", "x", "y", "z"),
    "navigator_mission_item": (
        "sequence_current", "nav_cmd", "frame", "time_inside", "acceptance_radius", "loiter_radius", "yaw",
        "latitude", "longitude", "altitude",
    ),
    "CMD": ("CNum", "CId", "Frame", "Prm1", "Prm2", "Prm3", "Prm4", "Lat", "Lng", "Alt"),
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Difference:
    """A value that differs; None where a log does not have it."""

    name: str
    first: float | str | None
    second: float | str | None


def parameter_differences(first: Log, second: Log, *, system: int | None = None) -> list[Difference]:
    """Return the parameters whose values at the end of two logs differ, by name.

    Args:
        first: A log.
        second: Another log.
        system: System id of the vehicle; None for the first one in each log.
    """
    one, other = last_parameters(first, system), last_parameters(second, system)
    return [
        Difference(name, one.get(name), other.get(name))
        for name in sorted(one.keys() | other.keys())
        if one.get(name) != other.get(name)
    ]


def last_parameters(log: Log, system: int | None = None) -> dict[str, float]:
    """Return the last value of each parameter of a vehicle in a log.

    Args:
        log: The log.
        system: System id of the vehicle; None for the first one.
    """
    log = log if system is None else log.select(system=system)
    values = dict(log.parameters)
    values.update({change.name: change.value for change in log.parameter_changes})
    return values


def mission_differences(first: Log, second: Log, *, system: int | None = None) -> list[Difference]:
    """Return the mission items that differ between two logs, by their number.

    Args:
        first: A log.
        second: Another log.
        system: System id of the vehicle; None for the first one in each log.
    """
    one, other = mission_of(first, system), mission_of(second, system)
    return [
        Difference(f"item {number}", _text(one.get(number)), _text(other.get(number)))
        for number in sorted(one.keys() | other.keys())
        if one.get(number) != other.get(number)
    ]


def mission_of(log: Log, system: int | None = None) -> dict[int, tuple[float, ...]]:
    """Return the mission items of a vehicle in a log by number: command, frame, parameters, position.

    A ULog holds the items that were flown.

    Args:
        log: The log.
        system: System id of the vehicle; None for the first one.
    """
    vehicle = next(iter(log.vehicles), None) if system is None else system
    for name, fields in _ITEM_FIELDS.items():
        if name in log and log.schema(name).has_numbers(fields[0]):
            items = _items(_of_vehicle(log[name], vehicle), fields)
            if items:  # otherwise only another vehicle used this message
                return items
    return {}


def _of_vehicle(table: MessageTable, system: int | None) -> MessageTable:
    """Return the items that a vehicle sent or received; only of the last mission if the table shows it."""
    names = table.dtype.names or ()
    if system is not None and {"_system", "target_system"} <= set(names):
        table = table.where((table["_system"] == system) | (table["target_system"] == system))
    if table.schema.has_numbers("nav_sub_cmd"):  # PX4 adds steps, such as a takeoff to a waypoint
        table = table.where(np.asarray(table["nav_sub_cmd"]) == 0)
    if table.schema.has_numbers("instance_count") and len(table):
        table = table.where(table["instance_count"] == table["instance_count"][-1])
    return table


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
    """Return a value that equals itself: NaN means "not set"."""
    return 0.0 if value != value else round(value, 7)


def _text(item: tuple[Any, ...] | None) -> str | None:
    return None if item is None else " ".join(f"{value:.10g}" for value in item)
