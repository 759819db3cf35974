"""The growth of a figure over time, beside its noise."""

from __future__ import annotations

from math import inf, sqrt
from statistics import fmean, linear_regression
from typing import TYPE_CHECKING, Final, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Sequence

#: Growth of a minute that is no fault, as a share of the mean: 3 percent in half an hour.
TOLERANCE: Final = 0.001
#: Standard errors between the slope and the bounds of its interval, which holds the slope in 95 of 100 cases.
STANDARD_ERRORS: Final = 2.0


class Trend(NamedTuple):
    """The line through values at equal intervals: mean, growth per interval, its standard error."""

    mean: float
    slope: float
    error: float

    @property
    def grows(self) -> bool:
        """Whether the growth is more than the tolerance, even at the lower bound of its interval."""
        return self.slope - STANDARD_ERRORS * self.error > TOLERANCE * self.mean

    def __str__(self) -> str:
        return (
            f"mean {self.mean:9.2f}, growth {self.slope:+8.4f} ± {STANDARD_ERRORS * self.error:.4f} a minute"
        )


def trend(values: Sequence[float]) -> Trend:
    """Return the trend of values.

    Args:
        values: At least two values; with two, the error of the slope is not known and the figure never grows.
    """
    times = range(len(values))
    slope, start = linear_regression(times, values)
    mean = fmean(values)
    if len(values) < 3:
        return Trend(mean, slope, inf)
    middle = fmean(times)
    residuals = sum((value - start - slope * time) ** 2 for time, value in zip(times, values, strict=True))
    spread = sum((time - middle) ** 2 for time in times)
    return Trend(mean, slope, sqrt(residuals / (len(values) - 2) / spread))
