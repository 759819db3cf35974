"""Files with the parameters of a radio: one NAME=value per line, and comments after #.

The lines of a reply to ATI5 (`S3: NETID=25`) are read too, so that a list from a terminal program can be
loaded.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Final

from mavstack.atomic_file import write_file_atomically
from mavstack.bounded_file import read_file_bounded
from mavstack.errors import InvalidArgumentError, ParameterFileError
from mavstack.radio.parameters import MAX_VALUE, PARAMETERS, check_value

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping

#: Maximum size in bytes of a file that is read.
MAX_SIZE: Final = 64 << 10
_LINE: Final = re.compile(r"(?:S\d{1,3}\s*:\s*)?([A-Za-z][A-Za-z0-9_/&]{0,31})\s*=\s*(\d{1,10})", re.ASCII)


def parse_values(text: str, path: str | None = None) -> dict[str, int]:
    """Return the values in the text of a file, by name.

    Args:
        text: The text.
        path: Path for errors.

    Returns:
        Values by name in capital letters, without those that the firmware sets itself.

    Raises:
        ParameterFileError: A line is no parameter, has an invalid value, or repeats a name.
    """
    values: dict[str, int] = {}
    for number, line in enumerate(text.splitlines(), 1):
        content = line.partition("#")[0].strip()
        if not content:
            continue
        match = _LINE.fullmatch(content)
        if match is None or int(match[2]) > MAX_VALUE:
            raise ParameterFileError(f"{content[:40]!r} is no parameter, such as NETID=25", path, number)
        name, value = match[1].upper(), int(match[2])
        if name in values:
            raise ParameterFileError(f"{name} is set twice", path, number)
        if name in PARAMETERS and not PARAMETERS[name].writable:
            continue
        try:
            check_value(name, value)
        except InvalidArgumentError as error:
            raise ParameterFileError(str(error), path, number) from None
        values[name] = value
    return values


def load_values(path: str | os.PathLike[str]) -> dict[str, int]:
    """Read a file.

    Args:
        path: The file.

    Returns:
        Values by name.

    Raises:
        ParameterFileError: The content is not valid, or too large.
        OSError: The file cannot be read.
    """
    data = read_file_bounded(path, MAX_SIZE + 1)
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError:
        text = "\0"
    if len(data) > MAX_SIZE or "\0" in text:
        raise ParameterFileError("not a file of radio parameters", str(path))
    values = parse_values(text, str(path))
    if not values:
        raise ParameterFileError("it has no parameters; `mav radio save` writes such files", str(path))
    return values


def save_values(path: str | os.PathLike[str], values: Mapping[str, int], comment: str) -> None:
    """Write a file.

    Args:
        path: The file, which is written completely or not at all.
        values: Values by name.
        comment: First line.

    Raises:
        OSError: The file cannot be written.
    """
    lines = [f"# {comment}", *(f"{name}={value}" for name, value in values.items())]
    write_file_atomically(path, "\n".join(lines) + "\n")
