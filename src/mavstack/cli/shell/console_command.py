"""A command of the shell: its names, its help, how its words are completed, and the function that runs it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

from mavstack.cli.common.errors import UsageError
from mavstack.errors import MavstackError

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable, Iterable, Sequence

    from mavstack.cli.shell.session import Session

    Run: TypeAlias = Callable[[Session, list[str]], Awaitable[None]]
    #: Of the session, the words of the command before, and the word that is typed: what it may become.
    Completer: TypeAlias = Callable[[Session, Sequence[str], str], Awaitable[Iterable[str]]]


class AlreadyReported(MavstackError):  # noqa: N818 (it says what happened)
    """A command failed and has said so itself."""


@dataclass(frozen=True, slots=True)
class Command:
    """One command; `usage` is what follows its name, `run` raises a `MavstackError` if it fails."""

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
        """All that it is called."""
        return (self.name, *self.aliases)

    @property
    def synopsis(self) -> str:
        """Its name and what follows it."""
        return f"{self.name} {self.usage}".rstrip()

    def misused(self, problem: str = "") -> UsageError:
        """What to raise for words that make no sense."""
        return UsageError(f"{problem + '; ' if problem else ''}usage: {self.synopsis}")


def expect(words: Sequence[str], fewest: int, most: int | None, usage: str) -> None:
    """Raise `UsageError` unless there are so many words."""
    if len(words) < fewest or (most is not None and len(words) > most):
        raise UsageError(f"usage: {usage}")


def number_of(text: str, what: str) -> float:
    """A word as a finite number."""
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    if not abs(value) < float("inf"):
        raise UsageError(f"{text!r} is no number for {what}")
    return value


def whole_number_of(text: str, what: str, most: int) -> int:
    """A word as a whole number from 0 to `most`."""
    if not (text.isascii() and text.isdecimal() and len(text) <= 12 and int(text) <= most):
        raise UsageError(f"{text!r} is no number from 0 to {most} for {what}")
    return int(text)
