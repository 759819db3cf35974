"""The statistics of several pings."""

from __future__ import annotations

from dataclasses import dataclass
from math import dist, fsum, sqrt


@dataclass(frozen=True, slots=True)
class PingStatistics:
    """The result of several pings.

    Attributes:
        sent: The number of requests.
        round_trips: The round-trip times of the answers in seconds, in order of arrival.
        duplicates: The number of answers that arrived more than once.
    """

    sent: int
    round_trips: tuple[float, ...]
    duplicates: int = 0

    @property
    def received(self) -> int:
        """The number of answers."""
        return len(self.round_trips)

    @property
    def loss(self) -> float:
        """The share of requests without an answer, 0 to 1."""
        return 1.0 - self.received / self.sent if self.sent else 0.0

    @property
    def minimum(self) -> float:
        """The shortest round trip, seconds."""
        return min(self.round_trips)

    @property
    def maximum(self) -> float:
        """The longest round trip, seconds."""
        return max(self.round_trips)

    @property
    def mean(self) -> float:
        """The mean round trip, seconds."""
        return fsum(self.round_trips) / self.received

    @property
    def deviation(self) -> float:
        """The standard deviation of the round trips, seconds."""
        return dist(self.round_trips, (self.mean,) * self.received) / sqrt(self.received)
