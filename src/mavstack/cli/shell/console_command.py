"""A command of the shell: its names, its help, the completion of its words, and the function that runs it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

from mavstack.cli.common.errors import UsageError
from mavstack.errors import MavstackError

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable, Iterable, Sequence

    from mavstack.cli.shell.session import Session

    Run: TypeAlias = Callable[[Session, list[str]], Awaitable[None]]
    #: Returns the candidates for a word, from the session, the words before it and its typed beginning.
    Completer: TypeAlias = Callable[[Session, Sequence[str], str], Awaitable[Iterable[str]]]


class AlreadyReported(MavstackError):  # noqa: N818 (the name says what happened)
    """A command failed and has printed the reason itself."""


@dataclass(frozen=True, slots=True)
class Command:
    """One command; `usage` follows its name in help texts, `run` raises a `MavstackError` if it fails."""

    name: str
    usage: str
    summary: str
    run: Run
    aliases: tuple[str, ...] = ()
    examples: tuple[str, ...] = ()
    details: str = ""
    complete: Completer | None = None

    @property
    def names(self) -> tuple[str, ...]:
        """The name and the aliases."""
        return (self.name, *self.aliases)

    @property
    def synopsis(self) -> str:
        """The name with the usage."""
        return f"{self.name} {self.usage}".rstrip()


def expect_words(words: Sequence[str], minimum: int, maximum: int | None, usage: str) -> None:
    """Raise `UsageError` unless the number of words is in the range; a maximum of None is no limit."""
    if len(words) < minimum or (maximum is not None and len(words) > maximum):
        raise UsageError(f"usage: {usage}")


def parse_number(text: str, name: str) -> float:
    """Parse a finite number; the error names the argument."""
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not abs(value) < float("inf"):
        raise UsageError(f"{text!r} is not a number for {name}")
    return value


def parse_integer(text: str, name: str, maximum: int) -> int:
    """Parse an integer from 0 to `maximum`; the error names the argument."""
    if not (text.isascii() and text.isdecimal() and len(text) <= 12 and int(text) <= maximum):
        raise UsageError(f"{text!r} is not a number from 0 to {maximum} for {name}")
    return int(text)
