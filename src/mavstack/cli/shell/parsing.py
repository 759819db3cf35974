"""From a line to commands: `mode guided; takeoff 10  # up` is two, each a list of words.

Words are split as a POSIX shell does it (quotes, backslash); an unquoted `;` ends a command, and an unquoted
`#` at the beginning of a word begins a comment.
"""

from __future__ import annotations

import shlex
from typing import TYPE_CHECKING, NamedTuple

from mavstack.cli.common.errors import UsageError

if TYPE_CHECKING:
    from collections.abc import Iterator

_QUOTES = "'\""


class Unfinished(NamedTuple):
    """A line that is being typed: the words that are whole, and the one at the cursor as it was typed."""

    words: list[str]
    word: str


def commands_of(line: str) -> list[list[str]]:
    """The commands of a line; raises `UsageError` if a quotation has no end."""
    return [words for segment in _segments(line) if (words := _words(segment))]


def unfinished_of(text: str) -> Unfinished:
    """What stands before the cursor, of the command that it is in."""
    *_, segment = ["", *_segments(text)]
    if text.rstrip().endswith(";"):
        segment = ""
    try:
        words = shlex.split(segment)
    except ValueError:
        words = segment.replace('"', "").replace("'", "").split()
    if not segment or segment[-1].isspace():
        return Unfinished(words, "")
    return Unfinished(words[:-1], words[-1] if words else "")


def _words(segment: str) -> list[str]:
    try:
        return shlex.split(segment)
    except ValueError as error:
        raise UsageError(f"{segment.strip()!r} has {str(error).lower()}") from None


def _segments(line: str) -> Iterator[str]:
    """The parts of a line between semicolons, up to a comment."""
    quote, begun, place = "", 0, 0
    while place < len(line):
        letter = line[place]
        if letter == "\\" and quote != "'":
            place += 1
        elif quote:
            quote = "" if letter == quote else quote
        elif letter in _QUOTES:
            quote = letter
        elif letter == ";":
            yield line[begun:place]
            begun = place + 1
        elif letter == "#" and (place == 0 or line[place - 1].isspace() or line[place - 1] == ";"):
            break
        place += 1
    yield line[begun:place]
