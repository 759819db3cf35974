"""Parameters as text and as JSON, patterns of their names, and assignments on the command line."""

from __future__ import annotations

from difflib import get_close_matches
from fnmatch import fnmatchcase
from math import isfinite
from typing import TYPE_CHECKING

from mavstack.cli.common.errors import CommandError, UsageError
from mavstack.errors import ParameterFileError
from mavstack.files.parameters import read_number, value_text
from mavstack.services.parameters.value import type_name

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence
    from typing import TypeVar

    from mavstack.files.parameters import AnyParameter, ParameterFile, StoredParameter
    from mavstack.services.parameters import Value
    from mavstack.vehicle import Vehicle

    Item = TypeVar("Item")


def matching(patterns: Sequence[str], known: Mapping[str, Item], noun: str = "parameter") -> dict[str, Item]:
    """Return the items whose names match a pattern such as `WPNAV*`; all items if there is no pattern.

    Raises:
        CommandError: A pattern matches no name.
    """
    for pattern in patterns:
        if not any(matches_any(name, [pattern]) for name in known):
            raise CommandError(f"there is no {noun} {pattern}{_hint(pattern.upper(), known)}")
    return {name: item for name, item in known.items() if matches_any(name, patterns)}


def matches_any(name: str, patterns: Sequence[str]) -> bool:
    """Return whether a name matches one of the patterns, or there are none."""
    return not patterns or any(fnmatchcase(name.upper(), pattern.upper()) for pattern in patterns)


def _hint(name: str, known: Iterable[str]) -> str:
    near = get_close_matches(name, known, n=1)
    return f"; did you mean {near[0]}?" if near else ""


def parameter_row(parameter: AnyParameter) -> tuple[str, str, str]:
    """Return name, value and type of a parameter as texts."""
    kind = "" if parameter.type is None else type_name(int(parameter.type)).lower()
    return parameter.name, value_text(parameter), kind


def parameters_for(file: ParameterFile, path: str, vehicle: Vehicle) -> dict[str, StoredParameter]:
    """Return the parameters of a file that are for the vehicle's autopilot.

    Raises:
        ParameterFileError: The file has only parameters of other components.
    """
    found = file.by_name(vehicle.address.component)
    if not found:
        others = ", ".join(map(str, file.components))
        wanted = vehicle.address.component
        raise ParameterFileError(f"it has only parameters of component {others}, not of {wanted}", path)
    return found


def json_value(parameter: AnyParameter | None) -> Value | str | None:
    """Return a value for JSON with the fewest digits; a value that is not finite is a text."""
    if parameter is None:
        return None
    value = read_number(value_text(parameter))
    return value if value is None or isfinite(value) else str(value)


def json_parameter(parameter: AnyParameter) -> dict[str, object]:
    """Return a parameter for JSON."""
    kind = None if parameter.type is None else type_name(int(parameter.type))
    return {"name": parameter.name, "value": json_value(parameter), "type": kind}


def assignments(words: Sequence[str]) -> dict[str, Value]:
    """Parse `NAME VALUE NAME VALUE` or `NAME=VALUE NAME=VALUE`."""
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
        raise UsageError(f"{text!r} is not a number for {name}")
    return value
