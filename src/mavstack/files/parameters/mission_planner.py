"""Mission Planner's files: `NAME,VALUE`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.files.parameters import plain
from mavstack.files.parameters.format import ParameterFormat, content_lines

if TYPE_CHECKING:
    from mavstack.files.parameters.stored import ParameterFile


def recognises(text: str) -> bool:
    """Whether the first parameter stands before a comma."""
    return any("," in line for _, line in list(content_lines(text))[:1])


def write(file: ParameterFile) -> str:
    """Write a file."""
    return plain.write(file, lambda name, value: f"{name},{value}")


FORMAT: Final = ParameterFormat(
    "mission-planner", (".param",), "Mission Planner: NAME,VALUE", recognises, plain.read, write
)
