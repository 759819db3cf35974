"""The growth of a figure over time, beside its noise.

The growth is the median of the slopes between all pairs of values (Theil and Sen), which a few odd values do
not move. Its interval follows from their order alone (Sen 1968, by the distribution of Kendall's statistic),
so the noise may have any distribution.
"""

from __future__ import annotations

from itertools import combinations
from math import inf, sqrt
from statistics import median
from typing import TYPE_CHECKING, Final, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Sequence

#: Growth of a minute that is no fault, as a share of the median: 3 percent in half an hour.
TOLERANCE: Final = 0.001
#: Standard deviations of the normal distribution on each side of the mean, which hold 95 of 100 cases.
DEVIATIONS: Final = 1.96
#: With fewer values the bounds of the interval are not known.
MIN_VALUES: Final = 6


class Trend(NamedTuple):
    """The median of values at equal intervals, their growth, and its bounds in 95 of 100 cases."""

    middle: float
    slope: float
    low: float
    high: float

    @property
    def grows(self) -> bool:
        """True if the growth is more than the tolerance, even at the lower bound of its interval."""
        return self.low > TOLERANCE * self.middle

    def __str__(self) -> str:
        interval = f"{self.low:+.4f} to {self.high:+.4f}"
        return f"median {self.middle:9.2f}, growth {self.slope:+8.4f} ({interval}) a minute"


def trend(values: Sequence[float]) -> Trend:
    """Return the trend of values.

    Args:
        values: At least two values; fewer than `MIN_VALUES` never grow, because their interval has no bounds.
    """
    pairs = combinations(enumerate(values), 2)
    slopes = sorted((later - value) / (end - start) for (start, value), (end, later) in pairs)
    count = len(values)
    spread = DEVIATIONS * sqrt(count * (count - 1) * (2 * count + 5) / 18)
    beyond = int((len(slopes) - spread) / 2)
    bounds = (slopes[beyond - 1], slopes[-beyond]) if beyond >= 1 else (-inf, inf)
    return Trend(median(values), median(slopes), *bounds)
