"""Timeouts of requests, adapted to the measured round trip.

A fixed timeout is too long on a fast link that loses packets and too short on a slow radio. `RoundTrip`
derives it from answers as TCP does (RFC 6298): a smoothed round-trip time and its deviation, doubled for each
attempt without an answer. Only an answer that surely belongs to its request is a sample (Karn's algorithm).
"""

from __future__ import annotations

#: The default timeout in seconds of calls that wait for something to appear (`wait_for_…`).
DEFAULT_WAIT_TIMEOUT = 60.0

#: Seconds within which identical bytes of one source are one packet that the network duplicated. Later they
#: may be a new request, because sequence numbers wrap after 256 packets, and start at 0 in each process.
DUPLICATE_WINDOW = 0.5


class RoundTrip:
    """The smoothed round-trip time to one peer, and the timeouts that follow from it, all in seconds.

    Args:
        initial: The first timeout while no round trip is known.
        minimum: The smallest first timeout.
        maximum: The largest timeout of any attempt.
    """

    def __init__(self, initial: float = 1.0, *, minimum: float = 0.05, maximum: float = 5.0) -> None:
        self.smoothed: float | None = None
        self._deviation = 0.0
        self._initial = initial
        self._minimum = minimum
        self._maximum = maximum

    def add_sample(self, seconds: float) -> None:
        """Add one measured round trip, seconds."""
        if self.smoothed is None:
            self.smoothed, self._deviation = seconds, seconds / 2
            return
        self._deviation += (abs(self.smoothed - seconds) - self._deviation) / 4
        self.smoothed += (seconds - self.smoothed) / 8

    def timeout(self, attempt: int = 1) -> float:
        """Return the seconds to wait for an answer to attempt number `attempt`, the first being 1."""
        base = self._initial
        if self.smoothed is not None:
            base = max(self.smoothed + max(4 * self._deviation, 0.01), self._minimum)
        return min(base * 2.0 ** min(attempt - 1, 10), max(self._maximum, self._initial))
