"""Helpers of shell commands: check and parse their words; the error of a failure that was reported."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.cli.common.errors import UsageError
from mavstack.errors import MavstackError

if TYPE_CHECKING:
    from collections.abc import Sequence


class AlreadyReported(MavstackError):  # noqa: N818 (the name says what happened)
    """A command failed and has printed the reason itself."""


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
