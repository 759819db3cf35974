"""The offset between two clocks, from exchanges that took an unknown time each way.

An exchange that took `round_trip` in all, and saw the other clock ahead by `offset` if both ways took the
same time, proves that the true offset lies within half the round trip of it. So short exchanges tell more:
of the last few, those nearly as short as the shortest are averaged. A sample that cannot be true together
with the estimate means that one of the clocks was set; one alone may be an error, several in a row start
the estimate anew.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from statistics import fmean

WINDOW = 32
#: How much longer than the shortest exchange one may be to count, in part and in seconds.
RATIO, MARGIN = 1.25, 0.0005
#: How many samples in a row must contradict the estimate.
CONTRADICTIONS = 3
#: What two clocks may drift apart within the window, in seconds.
DRIFT = 0.002
CONVERGED_AFTER = 5


@dataclass(frozen=True, slots=True)
class TimeOffset:
    """How far the other clock is ahead of ours, and the shortest round trip, in seconds."""

    offset: float
    round_trip: float
    samples: int

    @property
    def converged(self) -> bool:
        """Whether enough samples went into it."""
        return self.samples >= CONVERGED_AFTER

    @property
    def uncertainty(self) -> float:
        """How wrong the offset can be."""
        return self.round_trip / 2


class OffsetEstimator:
    """Takes in exchanges, gives the estimate."""

    def __init__(self) -> None:
        self.estimate: TimeOffset | None = None
        self._samples: deque[tuple[float, float]] = deque(maxlen=WINDOW)  # round trip, offset
        self._contradicting: list[tuple[float, float]] = []
        self._taken = 0

    def add(self, offset: float, round_trip: float) -> bool:
        """Take in one exchange; True if it, and those before it, show that a clock was set."""
        if self._contradicts(offset, round_trip):
            self._contradicting.append((round_trip, offset))
            if len(self._contradicting) < CONTRADICTIONS:
                return False
            samples, self._contradicting = self._contradicting, []
            self._samples.clear()
            self._samples.extend(samples)
            self._taken = len(samples)
            self._update()
            return True
        self._contradicting.clear()
        self._samples.append((round_trip, offset))
        self._taken += 1
        self._update()
        return False

    def _contradicts(self, offset: float, round_trip: float) -> bool:
        known = self.estimate
        return known is not None and (abs(offset - known.offset) > round_trip / 2 + known.uncertainty + DRIFT)

    def _update(self) -> None:
        least = min(round_trip for round_trip, _ in self._samples)
        good = [offset for round_trip, offset in self._samples if round_trip <= least * RATIO + MARGIN]
        self.estimate = TimeOffset(fmean(good), least, self._taken)
