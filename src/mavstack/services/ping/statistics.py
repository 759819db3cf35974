"""What became of a number of pings."""

from __future__ import annotations

from dataclasses import dataclass
from statistics import fmean, pstdev


@dataclass(frozen=True, slots=True)
class PingStatistics:
    """How many were sent, and the round trips of those that came back, in seconds, in order of arrival."""

    sent: int
    round_trips: tuple[float, ...]
    doubled: int = 0

    @property
    def received(self) -> int:
        """How many came back."""
        return len(self.round_trips)

    @property
    def loss(self) -> float:
        """The part that did not come back, 0 to 1."""
        return 1.0 - self.received / self.sent if self.sent else 0.0

    @property
    def least(self) -> float:
        """The shortest round trip."""
        return min(self.round_trips)

    @property
    def most(self) -> float:
        """The longest round trip."""
        return max(self.round_trips)

    @property
    def mean(self) -> float:
        """The mean round trip."""
        return fmean(self.round_trips)

    @property
    def deviation(self) -> float:
        """The standard deviation of the round trips."""
        return pstdev(self.round_trips)
