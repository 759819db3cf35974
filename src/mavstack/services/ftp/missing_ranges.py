"""The byte ranges of a file that are still missing."""

from __future__ import annotations

from bisect import bisect_right
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator


class MissingRanges:
    """Disjoint ranges (start, end) in ascending order."""

    def __init__(self, start: int, end: int) -> None:
        self._ranges: list[tuple[int, int]] = [(start, end)] if end > start else []
        self.total = max(end - start, 0)

    def __bool__(self) -> bool:
        return bool(self._ranges)

    def __iter__(self) -> Iterator[tuple[int, int]]:
        return iter(self._ranges)

    def remove(self, start: int, end: int) -> list[tuple[int, int]]:
        """Remove a range; returns the parts of it that were missing."""
        if end <= start:
            return []
        first = max(bisect_right(self._ranges, (start, start)) - 1, 0)
        removed: list[tuple[int, int]] = []
        kept: list[tuple[int, int]] = []
        last = first
        while last < len(self._ranges) and self._ranges[last][0] < end:
            low, high = self._ranges[last]
            last += 1
            if high <= start:
                kept.append((low, high))
                continue
            removed.append((max(low, start), min(high, end)))
            kept += [(a, b) for a, b in ((low, start), (end, high)) if a < b]
        self._ranges[first:last] = kept
        self.total -= sum(high - low for low, high in removed)
        return removed

    def after(self, start: int) -> Iterator[tuple[int, int]]:
        """Yield the ranges from a position on; the first is cut there."""
        for low, high in self._ranges[max(bisect_right(self._ranges, (start, start)) - 1, 0) :]:
            if high > start:
                yield max(low, start), high
