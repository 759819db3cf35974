"""The common parts of the plan file readers: bounded input, lines, numbers, and errors with their location.

Reading any file ends in a `PlanFile` or a `PlanFileError`. The size of a file and the number of items of a
plan are bounded, so that no file exhausts memory.
"""

from __future__ import annotations

import re
import reprlib
from dataclasses import dataclass
from math import isinf
from typing import TYPE_CHECKING, Final

from mavstack.errors import PlanFileError
from mavstack.services.mission.plan import MAX_ITEMS

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.services.mission import MissionItem

#: Maximum size of a plan file in bytes: more than twice the largest uploadable plan in the longest format.
MAX_BYTES: Final = 64 * 1024 * 1024
#: Maximum number of lines that are not empty (four plans of the maximum size, with comments), and of
#: characters in a line.
MAX_LINES: Final = 300_000
MAX_LINE_LENGTH: Final = 1_000_000
_NOT_EMPTY: Final = re.compile(r"[^\n]+")
_INTEGER: Final = re.compile(r"[+-]?[0-9]{1,18}(\.0*)?", re.ASCII)
_FLOAT: Final = re.compile(
    r"[+-]?([0-9]{1,400}(\.[0-9]{0,400})?|\.[0-9]{1,400})(e[+-]?[0-9]{1,5})?|[+-]?(nan|inf|infinity)",
    re.ASCII | re.IGNORECASE,
)
_BOMS: Final = ((b"\xff\xfe", "utf-16"), (b"\xfe\xff", "utf-16"), (b"\xef\xbb\xbf", "utf-8-sig"))


@dataclass(frozen=True, slots=True)
class Line:
    """A line with content: its number, its words, and the name of its file."""

    number: int
    words: list[str]
    name: str = ""

    def wrong(self, problem: str) -> PlanFileError:
        """Return the error for a problem of this line."""
        return PlanFileError(problem, self.name, f"line {self.number}")

    def integer(self, at: int, label: str, maximum: int, minimum: int = 0) -> int:
        """Return a word as a whole number; programs that know only floats write 16.0."""
        word = self.words[at]
        if not _INTEGER.fullmatch(word):
            raise self.wrong(f"{label} is {shown(word)}, which is not a whole number")
        value = int(word.partition(".")[0])
        if not minimum <= value <= maximum:
            raise self.wrong(f"{label} is {shown(word)}, which is not between {minimum} and {maximum}")
        return value

    def number_at(self, at: int, label: str) -> float:
        """Return a word as a number; `nan` is one, an infinity is refused, since no item has one."""
        word = self.words[at]
        if not _FLOAT.fullmatch(word):
            raise self.wrong(f"{label} is {shown(word)}, which is not a number")
        if isinf(value := float(word)):
            raise self.wrong(f"{label} is {shown(word)}, which is infinite")
        return value


def is_number(word: str) -> bool:
    """Return whether a word is a number."""
    return _FLOAT.fullmatch(word) is not None


class Report:
    """The report of a writer: the parts that its format cannot hold, and the values that it assumed."""

    def __init__(self) -> None:
        self.losses: list[str] = []
        self.notes: list[str] = []


def lines_of(text: str, name: str = "") -> Iterator[Line]:
    """Yield the lines with content: words separated by blanks, tabs or commas, without comments (`#`).

    Raises:
        PlanFileError: There are more lines than any plan has, or a line is too long.
    """
    number, end = 1, 0
    for count, found in enumerate(_NOT_EMPTY.finditer(text), 1):
        number += text.count("\n", end, found.start())
        end = found.end()
        if count > MAX_LINES:
            raise PlanFileError(f"it has more than {MAX_LINES} lines", name)
        if end - found.start() > MAX_LINE_LENGTH:
            raise PlanFileError(f"it is longer than {MAX_LINE_LENGTH} characters", name, f"line {number}")
        words = found[0].partition("#")[0].replace(",", " ").split()
        if words:
            yield Line(number, words, name)


def first_line(text: str) -> Line | None:
    """Return the first line with content."""
    return next(lines_of(text[:65536]), None)


def decoded(data: bytes) -> str:
    """Return the text of a file without marks of encodings; a comment may be in any encoding."""
    if len(data) > MAX_BYTES:
        raise PlanFileError(f"{len(data)} bytes are too many for a plan file: at most {MAX_BYTES} are read")
    encoding = next((name for mark, name in _BOMS if data.startswith(mark)), "utf-8")
    text = data.decode(encoding, errors="replace")
    return text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n")


def bounded(items: list[MissionItem], name: str, *, beside: int = 0) -> list[MissionItem]:
    """Return the items; raise if there are too many to upload, not counting `beside` of them."""
    if len(items) > MAX_ITEMS + beside:
        raise PlanFileError(f"{len(items)} items are more than the {MAX_ITEMS} that a plan can have", name)
    return items


def shown(text: object) -> str:
    """Return a value from a file for an error: short, and without terminal control characters."""
    if isinstance(text, list | dict):  # shorten it before its conversion to a text, which may be long
        text = reprlib.repr(text)
    return ascii(text) if len(str(text)) <= 40 else ascii(str(text)[:40]) + "…"


def number_text(value: float) -> str:
    """Return a number as text formats hold it: exact, with the fewest digits."""
    return repr(float(value)).removesuffix(".0")
