"""The formats by name, and reading and writing with any of them.

A file is read by what is in it, whatever it is called; it is written by its suffix or by a named format.
Another format is one file with `recognise`, `parse` and `write`, and an entry here.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Final, NamedTuple

from mavstack.errors import PlanFileError
from mavstack.files.plans import fence_list, own, qgc, rally_list, waypoints
from mavstack.files.plans.reading import MOST_BYTES, Report, decoded

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from mavstack.files.plans.model import PlanFile


@dataclass(frozen=True, slots=True)
class Format:
    """A way to write plans down."""

    summary: str
    suffixes: tuple[str, ...]
    recognise: Callable[[str], bool]
    parse: Callable[[str, str], PlanFile]
    write: Callable[[PlanFile, Report], str]


class Written(NamedTuple):
    """A plan as text, what the format could not hold of it, and what had to be made up."""

    text: str
    lost: tuple[str, ...]
    notes: tuple[str, ...]


#: In the order in which a file is tried.
FORMATS: Final[Mapping[str, Format]] = MappingProxyType(
    {
        "json": Format("everything, nothing lost", (".json",), own.recognise, own.parse, own.write),
        "plan": Format("QGroundControl", (".plan", ".mission"), qgc.recognise, qgc.parse, qgc.write),
        "waypoints": Format(
            "Mission Planner and MAVProxy (QGC WPL), one kind of plan",
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
    """Read plans from a file; bytes, and a text of several lines or of JSON, are read themselves.

    Raises `PlanFileError`, whatever is wrong.
    """
    if isinstance(source, bytes):
        return parse_plan(source)
    if isinstance(source, str) and ("\n" in source or source.lstrip().startswith("{")):
        return parse_plan(source)
    path = os.fspath(source)
    try:
        with Path(path).open("rb") as file:
            data = file.read(MOST_BYTES + 1)
    except OSError as error:
        raise PlanFileError(error.strerror or "it cannot be read", str(path)) from error
    except ValueError as error:
        raise PlanFileError(str(error), ascii(path)) from error
    return parse_plan(data, str(path))


def parse_plan(content: str | bytes, name: str = "") -> PlanFile:
    """Read plans from a text; `name` is what errors call it."""
    try:
        text = decoded(content if isinstance(content, bytes) else content.encode("utf-8", "replace"))
    except PlanFileError as error:
        raise PlanFileError(error.problem, name, error.where) from None
    found = next((each for each in FORMATS.values() if each.recognise(text)), None)
    if found is None:
        known = "QGroundControl's JSON, QGC WPL, RALLY lines, nor a list of latitudes and longitudes"
        what = f"it is neither {known}" if text.strip() else "it is empty"
        raise PlanFileError(what, name)
    return found.parse(text, name)


def write_plan(
    path: str | os.PathLike[str],
    plan: PlanFile,
    format: str | None = None,  # noqa: A002 (its name)
) -> Written:
    """Write plans into a file, in the format of its suffix or a named one; the result tells what was lost.

    Raises `PlanFileError` if there is no such format, or the plan is nothing that it could hold.
    """
    written = format_plan(plan, format or format_of(path))
    try:
        Path(path).write_text(written.text, encoding="utf-8", newline="\n")
    except OSError as error:
        raise PlanFileError(error.strerror or "it cannot be written", os.fspath(path)) from error
    return written


def format_plan(plan: PlanFile, format: str) -> Written:  # noqa: A002 (its name)
    """Plans as a text of a format."""
    if format not in FORMATS:
        raise PlanFileError(f"there is no format {format!r}; there are {', '.join(FORMATS)}")
    report = Report()
    text = FORMATS[format].write(plan, report)
    return Written(text, tuple(report.losses), tuple(report.notes))


def format_of(path: str | os.PathLike[str]) -> str:
    """The format of a file that is to be written, by its suffix."""
    suffix = Path(path).suffix.lower()
    for name, each in FORMATS.items():
        if suffix in each.suffixes:
            return name
    known = ", ".join(suffix for each in FORMATS.values() for suffix in each.suffixes)
    raise PlanFileError(f"its suffix names no format: use one of {known}, or name one", os.fspath(path))
