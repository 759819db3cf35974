"""PX4's scripts (airframes, etc/config.txt): `param set NAME VALUE` and `param set-default NAME VALUE`.

Other lines of such a script are not about parameters, or decide on the vehicle whether one is set; a file
with such lines is refused as a whole.
"""

from __future__ import annotations

import re
from typing import Final

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

_LINE = re.compile(r"param\s+(?:set|set-default)\s+(?:-s\s+)?(\S+)\s+(\S+)", re.ASCII)


def recognises(text: str) -> bool:
    """Return whether a line of the text sets a parameter."""
    return any(_LINE.fullmatch(line) for _, line in content_lines(text))


def read(text: str) -> ParameterFile:
    """Read a script whose lines all set parameters."""
    parameters = tuple(_read_line(line, number) for number, line in content_lines(text))
    return ParameterFile(parameters, comments=head_comments(text))


def write(file: ParameterFile) -> str:
    """Write a script."""
    lines = (f"param set {each.name} {each.value_text}\n" for each in file.parameters)
    return comment_lines(file.comments) + "".join(lines)


def _read_line(line: str, number: int) -> StoredParameter:
    found = _LINE.fullmatch(line)
    if found is None:
        problem = f"{shown(line)} does not set a parameter; keep only the lines `param set NAME VALUE`"
        raise ParameterFileError(problem, line=number)
    name, text = found.groups()
    if not is_name(name):
        raise ParameterFileError(f"{shown(name)} cannot be a parameter's name", line=number)
    return StoredParameter(name, number_of(name, text, number), text=text)


FORMAT: Final = ParameterFormat(
    "px4-script", (".sh",), "PX4 scripts: param set NAME VALUE", recognises, read, write
)
