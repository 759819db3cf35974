"""How a ratio is come by: turns taken, a ratio a turn, the median and the spread of the ratios.

The peers and we take turns on one core, and each turn gives one ratio against what the peer took in
that same turn, so that a machine which slows down slows both. What is told is the median of the ratios
and their least and greatest, never a single best.
"""

from __future__ import annotations

import gc
import os
import statistics
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

T = TypeVar("T")

OURS = "mavstack"
PYMAVLINK = "pymavlink"
MAVUTIL = "pymavlink.mavutil"
C = "C library"


@dataclass(frozen=True, slots=True)
class Ratio:
    """One promise: the ratios seen, turn by turn, and what they must reach."""

    label: str
    seen: tuple[float, ...]
    limit: float | None
    at_least: bool = True

    @property
    def median(self) -> float:
        """The figure that counts."""
        return statistics.median(self.seen)

    @property
    def reached(self) -> bool | None:
        """Whether the median keeps the promise; None where nothing is promised."""
        if self.limit is None:
            return None
        return self.median >= self.limit if self.at_least else self.median <= self.limit


@dataclass(frozen=True, slots=True)
class Row:
    """One line of the table: a piece of work, everyone's figure as text, and the ratios."""

    work: str
    figures: Mapping[str, str]
    ratios: tuple[Ratio, ...]


@contextmanager
def pinned() -> Iterator[None]:
    """Keep this process and its children on one core, the last one, where the system can."""
    if not hasattr(os, "sched_setaffinity"):
        yield
        return
    allowed = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {max(allowed)})
    try:
        yield
    finally:
        os.sched_setaffinity(0, allowed)


def take_turns(work: Mapping[str, Callable[[], T]], turns: int) -> dict[str, list[T]]:
    """Run everyone once unheard, then `turns` times in turn; what each run returned, by name."""
    for run in work.values():
        run()
    seen: dict[str, list[T]] = {name: [] for name in work}
    for _ in range(turns):
        for name, run in work.items():
            gc.collect()
            seen[name].append(run())
    return seen


def times_better(seen: Mapping[str, list[float]], peer: str, limit: float | None) -> Ratio:
    """How many times less than the peer we took, turn by turn."""
    ratios = tuple(theirs / ours for theirs, ours in zip(seen[peer], seen[OURS], strict=True))
    return Ratio(f"times {peer}", ratios, limit)


def rates(seen: Mapping[str, list[float]]) -> dict[str, str]:
    """Everyone's median as millions of messages a second."""
    return {name: f"{1e-6 / statistics.median(times):.3g} M/s" for name, times in seen.items()}
