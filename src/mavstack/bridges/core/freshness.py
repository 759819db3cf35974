"""The age of samples from a network that may hold them back, without synchronised clocks.

A network that was cut delivers afterwards what it kept. The time in a sample is that of its source, whose
clock may be wrong, so the age of a sample is how much later it arrives than the fastest sample of that
source. A network that is slow for long must not become the measure, so only a delay that no network has
shows that the clock of a source was set back: then the fastest sample since counts.
"""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass
from typing import Final

#: Growth per second of the shortest measured delay, because clocks drift.
DRIFT: Final = 0.0001
#: Maximum delay of a network in seconds: a longer delay means that the clock of the source was set.
MAX_DELAY: Final = 60.0
#: Seconds with only longer delays, after which the delay of the source is measured again.
RESET_TIME: Final = 5.0
#: Maximum number of sources that are remembered.
MAX_SOURCES: Final = 256


@dataclass(slots=True)
class _Source:
    shortest: float
    updated: float
    late_since: float | None = None
    late_shortest: float = 0.0


class Freshness:
    """The ages of samples by their sources."""

    def __init__(self) -> None:
        self._sources: OrderedDict[str, _Source] = OrderedDict()

    def age(self, source: str, stamp: float, now: float) -> float:
        """Return how much later a sample arrives than the fastest one of its source.

        Args:
            source: The name of the clock that made the stamp.
            stamp: The time in the sample, in seconds.
            now: The local time in seconds.

        Returns:
            Seconds, at least 0; 0 for the first sample of a source.
        """
        delay = now - stamp
        known = self._sources.get(source)
        if known is None:
            self._remember(source, _Source(delay, now))
            return 0.0
        self._sources.move_to_end(source)
        known.shortest += max(now - known.updated, 0.0) * DRIFT
        known.updated = now
        age = delay - known.shortest
        if age <= 0.0:
            known.shortest = delay
        if age < MAX_DELAY:
            known.late_since = None
            return max(age, 0.0)
        return self._implausible(known, delay, now)

    def _implausible(self, known: _Source, delay: float, now: float) -> float:
        if known.late_since is None:
            known.late_since, known.late_shortest = now, delay
        known.late_shortest = min(known.late_shortest, delay)
        if now - known.late_since > RESET_TIME:
            known.shortest, known.late_since = known.late_shortest, None
        return max(delay - known.shortest, 0.0)

    def _remember(self, source: str, found: _Source) -> None:
        self._sources[source] = found
        if len(self._sources) > MAX_SOURCES:
            self._sources.popitem(last=False)
