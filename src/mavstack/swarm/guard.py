"""The guard of a swarm: it knows positions and limits, and nothing of plans.

At each step it returns what is wrong, so that a fault of the planner, of a vehicle or of the link is found
where its effect is. The controller stops the vehicles that a finding names. A finding is returned once, and
again after it had ended.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING

import numpy as np

from mavstack.errors import InvalidArgumentError
from mavstack.swarm.separation import near_pairs, nearest_pair

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy.typing as npt

    from mavstack.swarm.arrays import Points


class Breach(StrEnum):
    """The limit that was passed."""

    SEPARATION = "separation"
    FENCE = "fence"
    HEIGHT = "height"
    LINK = "link"


@dataclass(frozen=True, slots=True)
class Finding:
    """A limit that vehicles passed.

    Attributes:
        breach: The limit.
        members: The indices of the vehicles.
        text: A sentence for people.
    """

    breach: Breach
    members: tuple[int, ...]
    text: str


@dataclass(frozen=True, slots=True)
class GuardLimits:
    """Limits of a swarm.

    Attributes:
        separation: Metres between two vehicles, heights divided by `VERTICAL_FACTOR`.
        radius: Metres from the origin over ground; None: no limit.
        lowest: Metres above the origin.
        highest: Metres above the origin.
        link_age: Seconds since the last position.
        fence: Corners of a polygon in metres north and east; empty: no limit.
    """

    separation: float = 2.0
    radius: float | None = None
    lowest: float = -math.inf
    highest: float = math.inf
    link_age: float = 2.5
    fence: Sequence[tuple[float, float]] = field(default=())

    def __post_init__(self) -> None:
        if not self.separation > 0.0 or not self.link_age > 0.0 or not self.lowest < self.highest:
            raise InvalidArgumentError("separation and link_age must be more than 0, lowest below highest")

    @property
    def is_unbounded(self) -> bool:
        """True if every place is allowed."""
        return self.radius is None and not self.fence and math.isinf(self.lowest) and math.isinf(self.highest)


class Guard:
    """Watches a swarm.

    Args:
        limits: The limits.
    """

    def __init__(self, limits: GuardLimits | None = None) -> None:
        self.limits = limits or GuardLimits()
        #: The smallest scaled distance between two vehicles since the start, in metres.
        self.smallest_separation = math.inf
        self._present: set[tuple[Breach, tuple[int, ...]]] = set()

    def check(self, positions: Points, ages: Sequence[float] | Points) -> list[Finding]:
        """Return the limits that were passed since the last call.

        Args:
            positions: Metres north, east, up of the origin; an array of shape (n, 3). NaN: unknown.
            ages: Seconds since each position of a member was measured. Positions beyond the last age are of
                vehicles that are not members: only their separation from members counts.
        """
        members = np.asarray(ages)
        found = [
            *self._separations(positions, len(members)),
            *self._places(positions[: len(members)]),
            *self._links(members),
        ]
        present = {(each.breach, each.members) for each in found}
        fresh = [each for each in found if (each.breach, each.members) not in self._present]
        self._present = present
        return fresh

    @property
    def is_breached(self) -> bool:
        """True if a limit was passed at the last call."""
        return bool(self._present)

    def _separations(self, positions: Points, members: int) -> list[Finding]:
        nearest, _, _ = nearest_pair(positions, members)
        self.smallest_separation = min(self.smallest_separation, nearest)
        if nearest >= self.limits.separation:
            return []
        pairs, between = near_pairs(positions, self.limits.separation, members)
        return [
            Finding(
                Breach.SEPARATION,
                (first, second),
                f"{metres:.1f} m apart, at least {self.limits.separation:g} m are kept",
            )
            for (first, second), metres in zip(pairs.tolist(), between.tolist(), strict=True)
        ]

    def _places(self, positions: Points) -> list[Finding]:
        limits, found = self.limits, list[Finding]()
        if limits.is_unbounded:
            return found
        north, east, up = positions.T
        far = np.hypot(north, east)
        beyond = far > (math.inf if limits.radius is None else limits.radius)
        outside = ~is_inside(limits.fence, north, east) if limits.fence else np.zeros_like(beyond)
        wrong_height = (up < limits.lowest) | (up > limits.highest)
        for index in np.flatnonzero(beyond | outside | wrong_height).tolist():
            if beyond[index]:
                found.append(_finding(Breach.FENCE, index, f"{far[index]:.0f} m from the origin"))
            elif outside[index]:
                found.append(_finding(Breach.FENCE, index, "outside of the fence"))
            if wrong_height[index]:
                found.append(_finding(Breach.HEIGHT, index, f"{up[index]:.1f} m above the origin"))
        return found

    def _links(self, ages: Points) -> list[Finding]:
        late = np.nonzero(~(ages <= self.limits.link_age))[0]
        return [_finding(Breach.LINK, int(each), f"no position for {ages[each]:.1f} s") for each in late]


def is_inside(fence: Sequence[tuple[float, float]], north: Points, east: Points) -> npt.NDArray[np.bool_]:
    """Return which places are inside a polygon; a place without a position is.

    Args:
        fence: Corners in metres north and east.
        north: Metres of each place.
        east: Metres of each place.
    """
    inside = np.zeros(len(north), bool)
    for (north1, east1), (north2, east2) in zip(fence, [*fence[1:], fence[0]], strict=True):
        if east1 != east2:
            crossing = (north2 - north1) * (east - east1) / (east2 - east1) + north1
            inside ^= ((east1 > east) != (east2 > east)) & (north < crossing)
    unknown: npt.NDArray[np.bool_] = np.isnan(north) | np.isnan(east)
    return inside | unknown


def _finding(breach: Breach, index: int, text: str) -> Finding:
    return Finding(breach, (index,), text)
