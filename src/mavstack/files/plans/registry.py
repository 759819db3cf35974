"""The plan file formats by name, and the functions that read and write with them.

The format of a file is detected from its content; a file is written in the format of its suffix, or in a
named one. A new format is a module with `recognise`, `parse` and `write`, and an entry here.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Final, NamedTuple

from mavstack.atomic_file import write_file_atomically
from mavstack.bounded_file import read_file_bounded
from mavstack.errors import PlanFileError
from mavstack.files.plans import fence_list, mavstack_json, qgc, rally_list, waypoints
from mavstack.files.plans.parsing import MAX_BYTES, Report, decoded

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from mavstack.files.plans.model import PlanFile


@dataclass(frozen=True, slots=True)
class Format:
    """A plan file format: its suffixes, and the functions that detect, read and write it."""

    summary: str
    suffixes: tuple[str, ...]
    recognise: Callable[[str], bool]
    parse: Callable[[str, str], PlanFile]
    write: Callable[[PlanFile, Report], str]


class Written(NamedTuple):
    """A plan as text, with the parts that the format could not hold, and the values that were assumed."""

    text: str
    lost: tuple[str, ...]
    notes: tuple[str, ...]


#: The formats by name, in the order in which they are tried.
FORMATS: Final[Mapping[str, Format]] = MappingProxyType(
    {
        "json": Format(
            "Mavstack, without loss",
            (".json",),
            mavstack_json.recognise,
            mavstack_json.parse,
            mavstack_json.write,
        ),
        "plan": Format("QGroundControl", (".plan", ".mission"), qgc.recognise, qgc.parse, qgc.write),
        "waypoints": Format(
            "Mission Planner and MAVProxy (QGC WPL), one type of plan",
            (".waypoints", ".wpl", ".txt"),
            waypoints.recognise,
            waypoints.parse,
            waypoints.write,
        ),
        "rally": Format(
            "older rally points", (".rally", ".ral"), rally_list.recognise, rally_list.parse, rally_list.write
        ),
        "fence": Format(
            "older fences: a return point and one polygon",
            (".fence", ".fen", ".poly"),
            fence_list.recognise,
            fence_list.parse,
            fence_list.write,
        ),
    }
)


def read_plan(source: str | os.PathLike[str] | bytes) -> PlanFile:
    """Read a plan file in any of the formats.

    Args:
        source: The path of a file; bytes, and a string of several lines or of JSON, are its content.

    Returns:
        The plans of the file.

    Raises:
        PlanFileError: The file cannot be read, or its content is not valid.
    """
    if isinstance(source, bytes):
        return parse_plan(source)
    if isinstance(source, str) and ("\n" in source or source.lstrip().startswith("{")):
        return parse_plan(source)
    path = os.fspath(source)
    try:
        data = read_file_bounded(path, MAX_BYTES + 1)
    except OSError as error:
        raise PlanFileError(error.strerror or "it cannot be read", str(path)) from error
    except ValueError as error:
        raise PlanFileError(str(error), ascii(path)) from error
    return parse_plan(data, str(path))


def parse_plan(content: str | bytes, name: str = "") -> PlanFile:
    """Read the content of a plan file.

    Args:
        content: The content.
        name: The name of the file in errors.

    Returns:
        The plans.

    Raises:
        PlanFileError: The content is not valid; the error holds the line or the key.
    """
    try:
        text = decoded(content if isinstance(content, bytes) else content.encode("utf-8", "replace"))
    except PlanFileError as error:
        raise PlanFileError(error.problem, name, error.where) from None
    found = next((each for each in FORMATS.values() if each.recognise(text)), None)
    if found is None:
        known = "QGroundControl's JSON, QGC WPL, RALLY lines, nor a list of latitudes and longitudes"
        problem = f"it is neither {known}" if text.strip() else "it is empty"
        raise PlanFileError(problem, name)
    return found.parse(text, name)


def write_plan(
    path: str | os.PathLike[str],
    plan: PlanFile,
    format: str | None = None,  # noqa: A002 (its name)
) -> Written:
    """Write a plan file atomically.

    Args:
        path: The file.
        plan: The plans.
        format: The name of the format (see `FORMATS`); None: that of the file name's suffix.

    Returns:
        The text, with the parts of the plans that the format could not hold.

    Raises:
        PlanFileError: The format is not known or holds no part of the plans, or the file is not writable.
    """
    written = format_plan(plan, format or format_of(path))
    try:
        write_file_atomically(path, written.text)
    except OSError as error:
        raise PlanFileError(error.strerror or "it cannot be written", os.fspath(path)) from error
    return written


def format_plan(plan: PlanFile, format: str) -> Written:  # noqa: A002 (its name)
    """Write plans as a text.

    Args:
        plan: The plans.
        format: The name of the format (see `FORMATS`).

    Returns:
        The text, with the parts of the plans that the format could not hold.

    Raises:
        PlanFileError: The format is not known, or can hold no part of the plans.
    """
    if format not in FORMATS:
        raise PlanFileError(f"there is no format {format!r}; there are {', '.join(FORMATS)}")
    report = Report()
    text = FORMATS[format].write(plan, report)
    return Written(text, tuple(report.losses), tuple(report.notes))


def format_of(path: str | os.PathLike[str]) -> str:
    """Return the name of the format of a file name's suffix; raise `PlanFileError` if there is none."""
    suffix = Path(path).suffix.lower()
    for name, each in FORMATS.items():
        if suffix in each.suffixes:
            return name
    known = ", ".join(suffix for each in FORMATS.values() for suffix in each.suffixes)
    raise PlanFileError(f"its suffix names no format: use one of {known}, or name one", os.fspath(path))
