"""QGroundControl's files: vehicle id, component id, name, value and MAV_PARAM_TYPE, separated by tabs.

A file may hold the parameters of several components of one vehicle. Types are kept, so that a value of an
integer type is an exact int.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.errors import ParameterFileError
from mavstack.files.parameters.format import (
    ParameterFormat,
    comment_lines,
    content_lines,
    head_comments,
    number_of,
    shown,
)
from mavstack.files.parameters.parameter_file import ParameterFile, StoredParameter, is_name
from mavstack.services.parameters.value import fitted, is_known, type_name

if TYPE_CHECKING:
    from mavstack.services.parameters import Value

_HEAD = "Onboard parameters for Vehicle"
_COLUMNS = "Vehicle-Id Component-Id Name Value Type"
_LAST_ID = 255


def recognises(text: str) -> bool:
    """Return whether the first parameter has five columns, or the head is QGroundControl's."""
    first = next((line for _, line in content_lines(text)), None)
    if first is None:
        return any(comment.startswith(_HEAD) for comment in head_comments(text))
    words = first.split()
    return len(words) == 5 and words[0].isdecimal() and words[1].isdecimal()


def read(text: str) -> ParameterFile:
    """Read a file, which may hold the parameters of one vehicle only."""
    systems: set[int] = set()
    parameters = tuple(_read_line(line, number, systems) for number, line in content_lines(text))
    comments = tuple(line for line in head_comments(text) if not line.startswith((_HEAD, _COLUMNS)))
    return ParameterFile(parameters, min(systems, default=None), comments)


def write(file: ParameterFile) -> str:
    """Write a file; a type that is not known follows from the value."""
    system = file.system or 1
    lines = (
        f"{system}\t{each.component or 1}\t{each.name}\t{each.value_text}\t{_type_of(each)}\n"
        for each in file.parameters
    )
    head = f"# {_HEAD} {system}\n#\n{comment_lines(file.comments)}#\n# {_COLUMNS}\n"
    return head + "".join(lines)


def _read_line(line: str, number: int, systems: set[int]) -> StoredParameter:
    words = line.split()
    if len(words) != 5:
        raise ParameterFileError(f"{shown(line)} does not have the columns {_COLUMNS}", line=number)
    system, component, name, text, kind_text = words
    if not is_name(name):
        raise ParameterFileError(f"{shown(name)} cannot be a parameter's name", line=number)
    systems.add(_id(system, "vehicle", number))
    if len(systems) > 1:
        raise ParameterFileError("a second vehicle begins; split the file by its first column", line=number)
    kind = int(kind_text) if kind_text.isascii() and kind_text.isdecimal() and len(kind_text) < 4 else 0
    if not is_known(kind):
        raise ParameterFileError(f"{shown(kind_text)} is not a MAV_PARAM_TYPE, 1 to 10", line=number)
    value = _typed(name, number_of(name, text, number), kind, number)
    return StoredParameter(name, value, kind, _id(component, "component", number), text=text)


def _typed(name: str, value: Value, kind: int, line: int) -> Value:
    if kind == common.MavParamType.REAL32:
        return value if isinstance(value, float) else float(value)
    held = fitted(value, kind)
    if held is None:
        raise ParameterFileError(f"{name} = {value} does not fit into {type_name(kind)}", line=line)
    return held


def _type_of(parameter: StoredParameter) -> int:
    if parameter.type is not None:
        return int(parameter.type)
    kinds = common.MavParamType
    whole = isinstance(parameter.value, int) and fitted(parameter.value, kinds.INT32) is not None
    return int(kinds.INT32 if whole else kinds.REAL32)


def _id(text: str, label: str, line: int) -> int:
    if text.isascii() and text.isdecimal() and len(text) < 4 and int(text) <= _LAST_ID:
        return int(text)
    raise ParameterFileError(f"{shown(text)} is not a {label} id, 0 to {_LAST_ID}", line=line)


FORMAT: Final = ParameterFormat(
    "qgroundcontrol",
    (".params",),
    "QGroundControl: vehicle, component, NAME, VALUE, type",
    recognises,
    read,
    write,
)
