"""MAVProxy's files, in the form of ArduPilot's default parameters: `NAME VALUE`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.files.parameters import name_value
from mavstack.files.parameters.format import ParameterFormat

if TYPE_CHECKING:
    from mavstack.files.parameters.parameter_file import ParameterFile


def recognises(text: str) -> bool:
    """Return True: this format is tried last."""
    return True


def write(file: ParameterFile) -> str:
    """Write a file."""
    return name_value.write(file, lambda name, value: f"{name:<16} {value}")


FORMAT: Final = ParameterFormat(
    "mavproxy", (".parm",), "MAVProxy and ArduPilot: NAME VALUE", recognises, name_value.read, write
)
