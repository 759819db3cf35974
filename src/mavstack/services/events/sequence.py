"""Sequence numbers of events: 16 bits that wrap."""

from __future__ import annotations

from typing import Final

NUMBERS: Final = 1 << 16
_HALF: Final = NUMBERS // 2


def after(sequence: int, count: int = 1) -> int:
    """Return the number that is `count` behind a number, or before it if `count` is negative."""
    return (sequence + count) % NUMBERS


def distance(first: int, last: int) -> int:
    """Return how many numbers `last` is newer than `first`; negative if it is older."""
    steps = (last - first) % NUMBERS
    return steps if steps < _HALF else steps - NUMBERS
