"""The formats of parameter files, one file each, and which of them a file is in.

A format says of a text whether it is in it, reads it and writes it; its errors name the line, and `files`
adds the path. `FORMATS` is in the order in which a text is tried; the last takes any text.
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
    """A format by its name."""
    found = FORMATS.get(name.lower())
    if found is None:
        raise ParameterFileError(f"there is no format {name!r}; there are {', '.join(FORMATS)}")
    return found


def format_for(path: str) -> ParameterFormat:
    """The format to write a file in, by its suffix."""
    suffix = PurePath(path).suffix.lower()
    for each in FORMATS.values():
        if suffix in each.suffixes:
            return each
    known = ", ".join(f"{suffix} ({each.name})" for each in FORMATS.values() for suffix in each.suffixes)
    raise ParameterFileError(f"which format is meant? name the file with one of {known}", path)


def format_of(text: str) -> ParameterFormat:
    """The format that a text is in."""
    return next((each for each in FORMATS.values() if each.recognises(text)), mavproxy.FORMAT)
