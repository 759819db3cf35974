"""MAVProxy's files, which ArduPilot's own defaults are like: `NAME VALUE`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.files.parameters import plain
from mavstack.files.parameters.format import ParameterFormat

if TYPE_CHECKING:
    from mavstack.files.parameters.stored import ParameterFile


def recognises(text: str) -> bool:
    """Any text may be one."""
    return True


def write(file: ParameterFile) -> str:
    """Write a file."""
    return plain.write(file, lambda name, value: f"{name:<16} {value}")


FORMAT: Final = ParameterFormat(
    "mavproxy", (".parm",), "MAVProxy and ArduPilot: NAME VALUE", recognises, plain.read, write
)
