"""What the readers of plan files share: bounded input, lines, numbers, and errors that say where.

Whatever a file holds, reading it ends in a `PlanFile` or a `PlanFileError`. A file is bounded in size and a
plan in items, so that no file makes a program use more than it is worth.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from mavstack.errors import PlanFileError
from mavstack.services.mission.plan import MOST_ITEMS

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.services.mission import MissionItem

#: The largest plan that can be sent takes less than half of this in the wordiest format.
MOST_BYTES: Final = 64 * 1024 * 1024
_INTEGER: Final = re.compile(r"[+-]?[0-9]{1,18}(\.0*)?", re.ASCII)
_FLOAT: Final = re.compile(
    r"[+-]?([0-9]{1,400}(\.[0-9]{0,400})?|\.[0-9]{1,400})(e[+-]?[0-9]{1,5})?|[+-]?(nan|inf|infinity)",
    re.ASCII | re.IGNORECASE,
)
_BOMS: Final = ((b"\xff\xfe", "utf-16"), (b"\xfe\xff", "utf-16"), (b"\xef\xbb\xbf", "utf-8-sig"))


@dataclass(frozen=True, slots=True)
class Line:
    """A line that says something: its number, its words, and the file it is in."""

    number: int
    words: list[str]
    name: str = ""

    def wrong(self, problem: str) -> PlanFileError:
        """The error that this line is."""
        return PlanFileError(problem, self.name, f"line {self.number}")

    def integer(self, at: int, what: str, most: int, least: int = 0) -> int:
        """A word that is a whole number; programs that know only floats write 16.0."""
        word = self.words[at]
        if not _INTEGER.fullmatch(word):
            raise self.wrong(f"{what} is {shown(word)}, which is not a whole number")
        value = int(word.partition(".")[0])
        if not least <= value <= most:
            raise self.wrong(f"{what} is {shown(word)}, which is not between {least} and {most}")
        return value

    def number_at(self, at: int, what: str) -> float:
        """A word that is a number."""
        word = self.words[at]
        if not _FLOAT.fullmatch(word):
            raise self.wrong(f"{what} is {shown(word)}, which is not a number")
        return float(word)


def is_number(word: str) -> bool:
    """Whether a word is a number."""
    return _FLOAT.fullmatch(word) is not None


class Report:
    """What a writer tells: what its format cannot hold, and what it had to make up."""

    def __init__(self) -> None:
        self.losses: list[str] = []
        self.notes: list[str] = []

    def lost(self, text: str) -> None:
        """Something of the plan will not be in the file."""
        self.losses.append(text)

    def note(self, text: str) -> None:
        """Something will be in the file that is not in the plan."""
        self.notes.append(text)


def lines_of(text: str, name: str = "") -> Iterator[Line]:
    """The lines that say something: words apart by blanks, tabs or commas; from `#` on is comment."""
    for number, content in enumerate(text.split("\n"), 1):
        words = content.partition("#")[0].replace(",", " ").split()
        if words:
            yield Line(number, words, name)


def first_line(text: str) -> Line | None:
    """The first line that says something."""
    return next(lines_of(text[:65536]), None)


def decoded(data: bytes) -> str:
    """The text of a file, whatever its editor put around it; a comment may be in any encoding."""
    if len(data) > MOST_BYTES:
        raise PlanFileError(f"{len(data)} bytes are no file of plans: {MOST_BYTES} is the most that is read")
    encoding = next((name for mark, name in _BOMS if data.startswith(mark)), "utf-8")
    text = data.decode(encoding, errors="replace")
    return text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n")


def bounded(items: list[MissionItem], name: str, *, beside: int = 0) -> list[MissionItem]:
    """The items, unless they are more than a vehicle can be given; so many `beside` are no part of it."""
    if len(items) > MOST_ITEMS + beside:
        raise PlanFileError(f"{len(items)} items are more than the {MOST_ITEMS} that a plan can have", name)
    return items


def shown(text: object) -> str:
    """Something out of a file as an error shows it: short, and without what a terminal would obey."""
    return ascii(text) if len(str(text)) <= 40 else ascii(str(text)[:40]) + "…"


def number_text(value: float) -> str:
    """A number as text formats write it: exact, and no longer than it must be."""
    return repr(float(value)).removesuffix(".0")
