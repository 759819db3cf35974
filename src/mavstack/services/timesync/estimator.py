"""The estimator of the offset between two clocks, from exchanges with unknown delays.

An exchange that took `round_trip`, and showed the remote clock ahead by `offset` if both ways took equally
long, proves that the true offset lies within half the round trip of it. So short exchanges are
more precise: of the last few, those nearly as short as the shortest are averaged. A sample that contradicts
the estimate means that one of the clocks was set; a single one may be an error, several in a row restart the
estimate.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from math import fsum

WINDOW = 32
#: An exchange counts if its round trip is at most this multiple of the shortest one, plus this margin in
#: seconds.
RATIO, MARGIN = 1.25, 0.0005
#: The number of consecutive samples that must contradict the estimate.
MIN_CONTRADICTIONS = 3
#: How far two clocks may drift apart within the window, in seconds.
MAX_DRIFT = 0.002
CONVERGED_AFTER = 5


@dataclass(frozen=True, slots=True)
class TimeOffset:
    """The estimated offset of a remote clock.

    Attributes:
        offset: Seconds by which the remote clock is ahead of the local one.
        round_trip: The shortest round trip, seconds.
        samples: The number of exchanges behind the estimate.
    """

    offset: float
    round_trip: float
    samples: int

    @property
    def converged(self) -> bool:
        """True if the estimate has enough samples."""
        return self.samples >= CONVERGED_AFTER

    @property
    def uncertainty(self) -> float:
        """The largest error of the offset, seconds."""
        return self.round_trip / 2


class OffsetEstimator:
    """The estimator of one clock offset."""

    def __init__(self) -> None:
        self.estimate: TimeOffset | None = None
        self._samples: deque[tuple[float, float]] = deque(maxlen=WINDOW)  # pairs: round trip, offset
        self._contradicting: list[tuple[float, float]] = []
        self._count = 0

    def add(self, offset: float, round_trip: float) -> bool:
        """Add one exchange; returns True if it, with those before it, shows that a clock was set."""
        if self._contradicts(offset, round_trip):
            self._contradicting.append((round_trip, offset))
            if len(self._contradicting) < MIN_CONTRADICTIONS:
                return False
            samples, self._contradicting = self._contradicting, []
            self._samples.clear()
            self._samples.extend(samples)
            self._count = len(samples)
            self._update()
            return True
        self._contradicting.clear()
        self._samples.append((round_trip, offset))
        self._count += 1
        self._update()
        return False

    def _contradicts(self, offset: float, round_trip: float) -> bool:
        known = self.estimate
        return known is not None and (
            abs(offset - known.offset) > round_trip / 2 + known.uncertainty + MAX_DRIFT
        )

    def _update(self) -> None:
        shortest = min(round_trip for round_trip, _ in self._samples)
        good = [offset for round_trip, offset in self._samples if round_trip <= shortest * RATIO + MARGIN]
        self.estimate = TimeOffset(fsum(good) / len(good), shortest, self._count)
