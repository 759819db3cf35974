"""The common part of Mission Planner's and MAVProxy's files: a name and a value on each line.

Commas, blanks, tabs or `=` separate them, as all programs that read such files allow; ArduPilot's mark
@READONLY may follow. A name keeps its letter case, which comparisons with a vehicle's parameters ignore.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from mavstack.errors import ParameterFileError
from mavstack.files.parameters.format import comment_lines, content_lines, head_comments, number_of, shown
from mavstack.files.parameters.parameter_file import ParameterFile, StoredParameter, is_name

if TYPE_CHECKING:
    from collections.abc import Callable

READ_ONLY = "@READONLY"
_SEPARATORS = re.compile(r"[\s,=]+", re.ASCII)


def read(text: str) -> ParameterFile:
    """Read a file."""
    parameters = tuple(_read_line(line, number) for number, line in content_lines(text))
    return ParameterFile(parameters, comments=head_comments(text))


def write(file: ParameterFile, layout: Callable[[str, str], str]) -> str:
    """Write a file; `layout` joins a name and a value."""
    lines = (
        layout(each.name, each.value_text) + (f" {READ_ONLY}" if each.read_only else "") + "\n"
        for each in file.parameters
    )
    return comment_lines(file.comments) + "".join(lines)


def _read_line(line: str, number: int) -> StoredParameter:
    words = list(filter(None, _SEPARATORS.split(line)))
    if words and words[0].lower() == "@include":
        raise ParameterFileError("@include is not supported; read the other file itself", line=number)
    read_only = words[-1:] == [READ_ONLY]
    if read_only:
        words.pop()
    if len(words) != 2:
        raise ParameterFileError(f"{shown(line)} is not a name and a value", line=number)
    name, text = words
    if not is_name(name):
        raise ParameterFileError(f"{shown(name)} cannot be a parameter's name", line=number)
    return StoredParameter(name, number_of(name, text, number), read_only=read_only, text=text)
