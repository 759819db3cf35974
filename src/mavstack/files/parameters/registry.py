"""The parameter file formats, one module each, and the detection of a file's format.

A format detects, reads and writes texts; its errors name the line, and `file_access` adds the path. `FORMATS`
is in the order of detection; the last format takes any text.
"""

from __future__ import annotations

from pathlib import PurePath
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.errors import ParameterFileError
from mavstack.files.parameters import mavproxy, mission_planner, px4_script, qgroundcontrol

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.files.parameters.format import ParameterFormat

FORMATS: Final[Mapping[str, ParameterFormat]] = MappingProxyType(
    {
        each.name: each
        for each in (qgroundcontrol.FORMAT, px4_script.FORMAT, mission_planner.FORMAT, mavproxy.FORMAT)
    }
)


def format_named(name: str) -> ParameterFormat:
    """Return the format with a name."""
    found = FORMATS.get(name.lower())
    if found is None:
        raise ParameterFileError(f"there is no format {name!r}; there are {', '.join(FORMATS)}")
    return found


def format_for(path: str) -> ParameterFormat:
    """Return the format of a file name's suffix."""
    suffix = PurePath(path).suffix.lower()
    for each in FORMATS.values():
        if suffix in each.suffixes:
            return each
    known = ", ".join(f"{suffix} ({each.name})" for each in FORMATS.values() for suffix in each.suffixes)
    raise ParameterFileError(f"the suffix names no format; use one of {known}", path)


def format_of(text: str) -> ParameterFormat:
    """Return the format of a text."""
    return next((each for each in FORMATS.values() if each.recognises(text)), mavproxy.FORMAT)
