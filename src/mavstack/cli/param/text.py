"""Parameters for people and for programs: aligned columns, colours on a terminal, JSON."""

from __future__ import annotations

import json
from difflib import get_close_matches
from fnmatch import fnmatchcase
from math import isfinite
from typing import TYPE_CHECKING

from mavstack.cli.common.field_values import clean
from mavstack.cli.common.usage_error import UsageError
from mavstack.errors import MavstackError, ParameterFileError
from mavstack.files.parameters import read_number, value_text
from mavstack.services.parameters.value import type_name

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence
    from typing import TypeVar

    from mavstack.files.parameters import AnyParameter, ParameterFile, StoredParameter
    from mavstack.services.parameters import Value
    from mavstack.vehicle import Vehicle

    Item = TypeVar("Item")


def matching(patterns: Sequence[str], known: Mapping[str, Item]) -> dict[str, Item]:
    """Those whose names fit a pattern, such as `WPNAV*`; all if there is none."""
    for pattern in patterns:
        if not any(fits(name, [pattern]) for name in known):
            raise MavstackError(f"there is no parameter {pattern}{_hint(pattern.upper(), known)}")
    return {name: item for name, item in known.items() if fits(name, patterns)}


def fits(name: str, patterns: Sequence[str]) -> bool:
    """Whether a name fits one of the patterns, or there are none."""
    return not patterns or any(fnmatchcase(name.upper(), pattern.upper()) for pattern in patterns)


def _hint(name: str, known: Iterable[str]) -> str:
    near = get_close_matches(name, known, n=1)
    return f"; did you mean {near[0]}?" if near else ""


def columns(rows: Sequence[Sequence[str]], *, right: frozenset[int] = frozenset()) -> list[str]:
    """Rows as lines with aligned columns; those in `right` to the right."""
    rows = [[clean(cell) for cell in row] for row in rows]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [
        "  ".join(
            cell.rjust(width) if place in right else cell.ljust(width)
            for place, (cell, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in rows
    ]


def parameter_row(parameter: AnyParameter) -> tuple[str, str, str]:
    """Name, value and type."""
    kind = "" if parameter.type is None else type_name(int(parameter.type)).lower()
    return parameter.name, value_text(parameter), kind


def of_vehicle(file: ParameterFile, path: str, vehicle: Vehicle) -> dict[str, StoredParameter]:
    """What a file holds for a vehicle's autopilot; raises if it is of other components only."""
    found = file.by_name(vehicle.address.component)
    if not found:
        others = ", ".join(map(str, file.components))
        wanted = vehicle.address.component
        raise ParameterFileError(f"it is of component {others} only, and this is {wanted}", path)
    return found


def json_value(parameter: AnyParameter | None) -> Value | str | None:
    """The value for JSON: as few digits as it takes; what is not finite as a text, None for none."""
    if parameter is None:
        return None
    value = read_number(value_text(parameter))
    return value if value is None or isfinite(value) else str(value)


def json_parameter(parameter: AnyParameter) -> dict[str, object]:
    """A parameter for JSON."""
    kind = None if parameter.type is None else type_name(int(parameter.type))
    return {"name": parameter.name, "value": json_value(parameter), "type": kind}


def print_json(thing: object) -> None:
    """One line of JSON."""
    print(json.dumps(thing, allow_nan=False), flush=True)


def assignments(words: Sequence[str]) -> dict[str, Value]:
    """What `NAME VALUE NAME VALUE` or `NAME=VALUE NAME=VALUE` says."""
    if any("=" in word for word in words):
        pairs = [word.partition("=")[::2] for word in words]
    elif len(words) % 2 == 0:
        pairs = list(zip(words[::2], words[1::2], strict=True))
    else:
        raise UsageError(f"{words[-1]} has no value; give names and values in turn, or NAME=VALUE")
    return {name: _number(name, text) for name, text in pairs}


def _number(name: str, text: str) -> Value:
    value = read_number(text)
    if value is None:
        raise UsageError(f"{text!r} is no number for {name}")
    return value
