"""How long to wait for an answer before asking again.

A fixed time is too long on a fast link that loses packets and too short on a slow radio. `RoundTrip` learns
it from answers as TCP does (RFC 6298): a smoothed round trip and its deviation, doubled for each attempt
that got no answer. Only an answer that surely belongs to its question is measured (Karn's rule).
"""

from __future__ import annotations

#: Seconds that calls which wait for something to appear (`wait_for_…`) wait when no timeout is given.
DEFAULT_WAIT_TIMEOUT = 60.0

#: For so long the same bytes of one source are one packet that the network doubled. Longer, and they may be
#: the same request again: sequence numbers begin anew after 256, and in each process that is started.
DOUBLED_WITHIN = 0.5


class RoundTrip:
    """The round trips to one peer, and the patience that follows from them, all in seconds."""

    def __init__(self, initial: float = 1.0, *, least: float = 0.05, most: float = 5.0) -> None:
        self.smoothed: float | None = None
        self._deviation = 0.0
        self._initial = initial
        self._least = least
        self._most = most

    def measured(self, seconds: float) -> None:
        """Take in one round trip."""
        if self.smoothed is None:
            self.smoothed, self._deviation = seconds, seconds / 2
            return
        self._deviation += (abs(self.smoothed - seconds) - self._deviation) / 4
        self.smoothed += (seconds - self.smoothed) / 8

    def timeout(self, attempt: int = 1) -> float:
        """How long to wait for the answer to the given attempt, the first being 1."""
        base = self._initial
        if self.smoothed is not None:
            base = max(self.smoothed + max(4 * self._deviation, 0.01), self._least)
        return min(base * 2.0 ** min(attempt - 1, 10), max(self._most, self._initial))
