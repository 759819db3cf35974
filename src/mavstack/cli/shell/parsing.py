"""Splitting a line into commands: `mode guided; takeoff 10  # up` is two commands, each a list of words.

Words are split as in a POSIX shell (quotes, backslash). An unquoted `;` ends a command, and an unquoted `#`
at the beginning of a word begins a comment.
"""

from __future__ import annotations

import shlex
from typing import TYPE_CHECKING, NamedTuple

from mavstack.cli.common.errors import UsageError

if TYPE_CHECKING:
    from collections.abc import Iterator

_QUOTES = "'\""


class UnfinishedLine(NamedTuple):
    """A line that is being typed: the complete words, and the beginning of the word at the cursor."""

    words: list[str]
    word: str


def split_commands(line: str) -> list[list[str]]:
    """Return the commands of a line.

    Raises:
        UsageError: A quotation has no end.
    """
    return [words for segment in _segments(line) if (words := _words(segment))]


def split_unfinished(text: str) -> UnfinishedLine:
    """Return the words before the cursor of the command at the cursor."""
    *_, segment = ["", *_segments(text)]
    if text.rstrip().endswith(";"):
        segment = ""
    try:
        words = shlex.split(segment)
    except ValueError:
        words = segment.replace('"', "").replace("'", "").split()
    if not segment or segment[-1].isspace():
        return UnfinishedLine(words, "")
    return UnfinishedLine(words[:-1], words[-1] if words else "")


def _words(segment: str) -> list[str]:
    try:
        return shlex.split(segment)
    except ValueError as error:
        raise UsageError(f"{segment.strip()!r} has {str(error).lower()}") from None


def _segments(line: str) -> Iterator[str]:
    """Yield the parts of a line between semicolons, up to a comment."""
    quote, start, position = "", 0, 0
    while position < len(line):
        letter = line[position]
        if letter == "\\" and quote != "'":
            position += 1
        elif quote:
            quote = "" if letter == quote else quote
        elif letter in _QUOTES:
            quote = letter
        elif letter == ";":
            yield line[start:position]
            start = position + 1
        elif letter == "#" and (position == 0 or line[position - 1].isspace() or line[position - 1] == ";"):
            break
        position += 1
    yield line[start:position]
