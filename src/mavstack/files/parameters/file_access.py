"""Reading and writing parameter files."""

from __future__ import annotations

import codecs
import os
from typing import TYPE_CHECKING

from mavstack.atomic_file import write_file_atomically
from mavstack.bounded_file import read_file_bounded
from mavstack.errors import ParameterFileError
from mavstack.files.parameters.format import shown
from mavstack.files.parameters.parameter_file import is_name
from mavstack.files.parameters.registry import format_for, format_named, format_of

if TYPE_CHECKING:
    from mavstack.files.parameters.format import ParameterFormat
    from mavstack.files.parameters.parameter_file import ParameterFile

#: Maximum size of a parameter file in bytes.
MAX_BYTES = 16 << 20
_WIDE_MARKS = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)


def read_parameters(path: str | os.PathLike[str], format: str | None = None) -> ParameterFile:  # noqa: A002
    """Read a parameter file.

    Args:
        path: The file.
        format: The name of its format (see `FORMATS`); None detects the format from the content.

    Returns:
        The parameters of the file.

    Raises:
        ParameterFileError: The content is not valid; the error holds the line.
        OSError: The file cannot be read.
    """
    data = read_file_bounded(path, MAX_BYTES + 1)
    try:
        return parse_parameters(_decoded(data), format)
    except ParameterFileError as error:
        raise ParameterFileError(error.problem, os.fspath(path), error.line) from None


def parse_parameters(text: str, format: str | None = None) -> ParameterFile:  # noqa: A002
    """Read the text of a parameter file.

    Args:
        text: The text.
        format: The name of its format (see `FORMATS`); None detects the format.

    Returns:
        The parameters.

    Raises:
        ParameterFileError: The text is not valid; the error holds the line.
    """
    lines = text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n")
    chosen = format_of(lines) if format is None else format_named(format)
    file = chosen.read(lines)
    if not file.parameters:
        raise ParameterFileError("it holds no parameters")
    return file


def write_parameters(
    path: str | os.PathLike[str],
    file: ParameterFile,
    format: str | None = None,  # noqa: A002
) -> None:
    """Write a parameter file atomically.

    Args:
        path: The file.
        file: The parameters.
        format: The name of the format (see `FORMATS`); None: that of the file name's suffix.

    Raises:
        ParameterFileError: The format is not known, or a name cannot stand in a file.
        OSError: The file cannot be written.
    """
    chosen = _format_to_write(os.fspath(path), format)
    for each in file.parameters:
        if not is_name(each.name):
            raise ParameterFileError(
                f"{shown(each.name)} cannot be a parameter's name in a file", os.fspath(path)
            )
    write_file_atomically(path, chosen.write(file))


def _format_to_write(path: str, name: str | None) -> ParameterFormat:
    return format_for(path) if name is None else format_named(name)


def _decoded(data: bytes) -> str:
    if len(data) > MAX_BYTES:
        raise ParameterFileError(f"it is larger than {MAX_BYTES >> 20} MiB, so it is not a parameter file")
    wide = data.startswith(_WIDE_MARKS)
    text = data.decode("utf-16" if wide else "utf-8-sig", errors="replace")
    if "\0" in text:
        raise ParameterFileError("it is not a text file")
    return text
