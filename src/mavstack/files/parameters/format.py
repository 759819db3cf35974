"""What a format of parameter files is, and what they share: lines, comments and numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from mavstack.errors import ParameterFileError
from mavstack.files.parameters.numbers import read_number

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from mavstack.files.parameters.stored import ParameterFile
    from mavstack.services.parameters import Value

#: So much of a line is shown in an error.
_SHOWN = 40


class ParameterFormat(NamedTuple):
    """A format: its name, the suffixes of its files, and how it is recognised, read and written."""

    name: str
    suffixes: tuple[str, ...]
    summary: str
    recognises: Callable[[str], bool]
    read: Callable[[str], ParameterFile]
    write: Callable[[ParameterFile], str]


def content_lines(text: str) -> Iterator[tuple[int, str]]:
    """The lines that hold something, with their numbers, without what follows a `#`."""
    for number, line in enumerate(text.split("\n"), 1):
        content = line.partition("#")[0].strip()
        if content:
            yield number, content


def head_comments(text: str) -> tuple[str, ...]:
    """The comments before the first parameter."""
    found = []
    for line in text.split("\n"):
        if line.strip() and not line.lstrip().startswith("#"):
            break
        found.append(line.strip().lstrip("#").strip())
    return tuple(filter(None, found))


def comment_lines(comments: tuple[str, ...]) -> str:
    """Comments as they are written."""
    return "".join(f"# {line}\n" for comment in comments for line in comment.splitlines())


def number_of(name: str, text: str, line: int) -> Value:
    """The value of a parameter; raises if it is no number."""
    value = read_number(text)
    if value is None:
        raise ParameterFileError(f"{shown(text)} is no number; correct or remove {name}", line=line)
    return value


def shown(text: str) -> str:
    """A text of a file in an error: short, and without what a terminal would obey."""
    return ascii(text if len(text) <= _SHOWN else text[: _SHOWN - 1] + "~")
