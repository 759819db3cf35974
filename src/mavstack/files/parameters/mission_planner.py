"""Mission Planner's files: `NAME,VALUE`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.files.parameters import name_value
from mavstack.files.parameters.format import ParameterFormat, content_lines

if TYPE_CHECKING:
    from mavstack.files.parameters.parameter_file import ParameterFile


def recognises(text: str) -> bool:
    """Return whether the first parameter's name ends at a comma."""
    return any("," in line for _, line in list(content_lines(text))[:1])


def write(file: ParameterFile) -> str:
    """Write a file."""
    return name_value.write(file, lambda name, value: f"{name},{value}")


FORMAT: Final = ParameterFormat(
    "mission-planner", (".param",), "Mission Planner: NAME,VALUE", recognises, name_value.read, write
)
