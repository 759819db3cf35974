"""Measuring ratios: interleaved turns, one ratio per turn, and the median and spread of the ratios.

Mavstack and the peers take turns on one core. Each turn gives one ratio to the time of the peer in the same
turn, so that a machine that slows down affects both sides. Reported are the median, minimum and maximum of
the ratios, never a best single turn.
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
    """The ratios to one peer, turn by turn, and the target that their median must reach."""

    label: str
    values: tuple[float, ...]
    target: float | None
    higher_is_better: bool = True

    @property
    def median(self) -> float:
        """Median of the ratios."""
        return statistics.median(self.values)

    @property
    def reached(self) -> bool | None:
        """True if the median reaches the target; None without a target."""
        if self.target is None:
            return None
        return self.median >= self.target if self.higher_is_better else self.median <= self.target


@dataclass(frozen=True, slots=True)
class Row:
    """A row of the table: the measured work, the figure of each library as text, and the ratios."""

    work: str
    figures: Mapping[str, str]
    ratios: tuple[Ratio, ...]


def last_core() -> int:
    """Return the last core that this process may use, where the system supports it."""
    return max(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else 0


@contextmanager
def pinned() -> Iterator[None]:
    """Pin this process and its children to the last core, where the system supports it."""
    with _on_cores(lambda allowed: {max(allowed)}):
        yield


@contextmanager
def apart() -> Iterator[None]:
    """Keep this process and its children from the last core, where a receiver runs, if there are others."""
    with _on_cores(lambda allowed: allowed - {max(allowed)} or allowed):
        yield


@contextmanager
def _on_cores(choose: Callable[[set[int]], set[int]]) -> Iterator[None]:
    if not hasattr(os, "sched_setaffinity"):
        yield
        return
    allowed = os.sched_getaffinity(0)
    os.sched_setaffinity(0, choose(allowed))
    try:
        yield
    finally:
        os.sched_setaffinity(0, allowed)


def take_turns(work: Mapping[str, Callable[[], T]], turns: int) -> dict[str, list[T]]:
    """Run everything once as warm-up, then `turns` times in turn; return the results by name."""
    for run in work.values():
        run()
    results: dict[str, list[T]] = {name: [] for name in work}
    for _ in range(turns):
        for name, run in work.items():
            gc.collect()
            results[name].append(run())
    return results


def speed_ratio(results: Mapping[str, list[float]], peer: str, target: float | None) -> Ratio:
    """Return the time of the peer over ours, turn by turn."""
    ratios = tuple(theirs / ours for theirs, ours in zip(results[peer], results[OURS], strict=True))
    return Ratio(f"times {peer}", ratios, target)


def rates(results: Mapping[str, list[float]]) -> dict[str, str]:
    """Return the medians as millions of messages per second."""
    return {name: f"{1e-6 / statistics.median(times):.3g} M/s" for name, times in results.items()}
