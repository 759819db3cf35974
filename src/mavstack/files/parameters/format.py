"""The description of a parameter file format, and the helpers that formats share."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from mavstack.errors import ParameterFileError
from mavstack.files.parameters.numbers import read_number

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from mavstack.files.parameters.parameter_file import ParameterFile
    from mavstack.services.parameters import Value

#: Maximum number of characters of a line in an error text.
_SHOWN = 40


class ParameterFormat(NamedTuple):
    """A parameter file format: its name, its suffixes, and the functions that detect, read and write it."""

    name: str
    suffixes: tuple[str, ...]
    summary: str
    recognises: Callable[[str], bool]
    read: Callable[[str], ParameterFile]
    write: Callable[[ParameterFile], str]


def content_lines(text: str) -> Iterator[tuple[int, str]]:
    """Yield the lines with content and their numbers, without comments (from `#`)."""
    for number, line in enumerate(text.split("\n"), 1):
        content = line.partition("#")[0].strip()
        if content:
            yield number, content


def head_comments(text: str) -> tuple[str, ...]:
    """Return the comments before the first parameter."""
    found = []
    for line in text.split("\n"):
        if line.strip() and not line.lstrip().startswith("#"):
            break
        found.append(line.strip().lstrip("#").strip())
    return tuple(filter(None, found))


def comment_lines(comments: tuple[str, ...]) -> str:
    """Return comments as lines of a file."""
    return "".join(f"# {line}\n" for comment in comments for line in comment.splitlines())


def number_of(name: str, text: str, line: int) -> Value:
    """Return the value of a parameter; raise `ParameterFileError` if it is not a number."""
    value = read_number(text)
    if value is None:
        raise ParameterFileError(f"{shown(text)} is not a number; correct or remove {name}", line=line)
    return value


def shown(text: str) -> str:
    """Return a text from a file for an error: short, and without terminal control characters."""
    return ascii(text if len(text) <= _SHOWN else text[: _SHOWN - 1] + "~")
