"""Which bytes of a file are still missing."""

from __future__ import annotations

from bisect import bisect_right
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator


class Ranges:
    """Disjoint ranges (start, end) in order."""

    def __init__(self, start: int, end: int) -> None:
        self._ranges: list[tuple[int, int]] = [(start, end)] if end > start else []
        self.total = max(end - start, 0)

    def __bool__(self) -> bool:
        return bool(self._ranges)

    def __iter__(self) -> Iterator[tuple[int, int]]:
        return iter(self._ranges)

    def take(self, start: int, end: int) -> list[tuple[int, int]]:
        """Remove what lies between; gives the parts that were there."""
        if end <= start:
            return []
        first = max(bisect_right(self._ranges, (start, start)) - 1, 0)
        taken: list[tuple[int, int]] = []
        kept: list[tuple[int, int]] = []
        last = first
        while last < len(self._ranges) and self._ranges[last][0] < end:
            low, high = self._ranges[last]
            last += 1
            if high <= start:
                kept.append((low, high))
                continue
            taken.append((max(low, start), min(high, end)))
            kept += [(a, b) for a, b in ((low, start), (end, high)) if a < b]
        self._ranges[first:last] = kept
        self.total -= sum(high - low for low, high in taken)
        return taken

    def after(self, start: int) -> Iterator[tuple[int, int]]:
        """The ranges from a position on, the first cut there."""
        for low, high in self._ranges[max(bisect_right(self._ranges, (start, start)) - 1, 0) :]:
            if high > start:
                yield max(low, start), high
