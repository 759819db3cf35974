"""Separation: distances in which height counts less than ground, since a multicopter blows downwards.

The air below a multicopter disturbs another one several metres lower, so the region that a vehicle claims
is an ellipsoid: its half axis along the vertical is `VERTICAL_FACTOR` times that across. All distances of
this package are measured in the space in which that ellipsoid is a sphere: heights are divided by the factor.

How large the region is follows from what may go wrong at the same time. Two vehicles that are planned
`distance` apart are really apart by at least

    distance - position error · √2 - 2 · tracking error - latency · speed

`Margins.planned_distance` solves that for `distance`. The position error is `SIGMAS` standard deviations of
the position estimate, since the smallest of many distances is measured, not the usual one; those of two
vehicles are independent. If all vehicles are late by the same time, distances do not change; if one is late
by the latency and the other is not, it is `latency · speed` away from its place.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack.errors import InvalidArgumentError, MissingExtraError

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

    from mavstack.swarm.arrays import Indices, Points

#: A vertical distance between multicopters counts as a horizontal distance divided by this factor.
VERTICAL_FACTOR: Final = 2.0
#: The largest expected position error, in standard deviations.
SIGMAS: Final = 4.0
#: Relative increase of the search radius of the tree, so that rounding loses no pair.
_ROUNDING: Final = 1e-9


@dataclass(frozen=True, slots=True)
class Margins:
    """Errors against which a planned distance protects.

    Attributes:
        minimum: Metres below which two vehicles must never come.
        position: Standard deviation of a vehicle's own position in metres.
        tracking: Metres between a setpoint and the vehicle's estimate of its position, in wind and in turns.
        latency: Seconds between a setpoint and its effect.
        speed: Largest speed in m/s.
    """

    minimum: float = 2.0
    position: float = 0.5
    tracking: float = 0.5
    latency: float = 0.2
    speed: float = 5.0

    def __post_init__(self) -> None:
        for name in self.__slots__:
            value: float = getattr(self, name)
            if not (np.isfinite(value) and value >= 0.0):
                raise InvalidArgumentError(f"{name} must be finite and at least 0, got {value:g}")

    @property
    def planned_distance(self) -> float:
        """Metres that a plan has to keep between two vehicles."""
        # The two position errors are independent, so their difference is larger by the square root of two.
        position: float = SIGMAS * self.position * math.sqrt(2.0)
        return self.minimum + position + 2.0 * self.tracking + self.latency * self.speed


def scaled(points: Points, vertical_factor: float = VERTICAL_FACTOR) -> Points:
    """Return positions in the space in which the region of a vehicle is a sphere."""
    space: Points = np.asarray(points, dtype=float) / (1.0, 1.0, vertical_factor)
    return space


def distances(points: Points) -> Points:
    """Return the scaled distance of each pair of vehicles, infinite of a vehicle and itself.

    Args:
        points: Positions in metres, an array of shape (n, 3).

    Returns:
        An array of shape (n, n) in metres of ground distance.
    """
    space = scaled(points)
    between: Points = np.linalg.norm(space[:, None] - space[None], axis=2)
    np.fill_diagonal(between, np.inf)
    return between


def nearest_pair(points: Points, members: int | None = None) -> tuple[float, int, int]:
    """Return the smallest scaled distance of two vehicles in metres, and their indices.

    With fewer than two known positions the distance is infinite.

    Args:
        points: Positions in metres, an array of shape (n, 3). NaN: unknown.
        members: Only pairs with one of this number of vehicles at the begin count; None: all pairs.

    Raises:
        MissingExtraError: scipy is not installed.
    """
    known, space = _known(points)
    among = len(known) if members is None else int(np.searchsorted(known, members))
    if len(known) < 2 or not among:
        return float("inf"), 0, 0
    between, neighbours = _tree(space).query(space[:among], k=2)
    first = int(between[:, 1].argmin())
    # Among vehicles at the same place, a vehicle may be listed second among its own neighbours.
    second = next(int(each) for each in neighbours[first] if each != first)
    low, high = sorted((int(known[first]), int(known[second])))
    return float(np.linalg.norm(space[first] - space[second])), low, high


def near_pairs(points: Points, limit: float, members: int | None = None) -> tuple[Indices, Points]:
    """Return the pairs of vehicles that are nearer than a limit, the nearest first.

    The work grows with the number of vehicles and of near pairs, not with that of all pairs.

    Args:
        points: Positions in metres, an array of shape (n, 3). NaN: unknown.
        limit: Metres, heights divided by `VERTICAL_FACTOR`.
        members: As in `nearest_pair`.

    Returns:
        Indices of the vehicles, an array of shape (m, 2), and the scaled distance of each pair.

    Raises:
        MissingExtraError: scipy is not installed.
    """
    known, space = _known(points)
    if len(known) < 2:
        return np.empty((0, 2), np.int64), np.empty(0)
    pairs = _tree(space).query_pairs(limit * (1.0 + _ROUNDING), output_type="ndarray")
    between = np.linalg.norm(space[pairs[:, 0]] - space[pairs[:, 1]], axis=1)
    order = np.lexsort((pairs[:, 1], pairs[:, 0], between))
    order = order[between[order] < limit]
    found, near = known[pairs[order]], between[order]
    if members is not None:
        counts = found.min(axis=1) < members
        found, near = found[counts], near[counts]
    return found, near


def import_libraries() -> None:
    """Import the parts of scipy that swarms need, which take a second at their first use.

    A program calls it before its vehicles need setpoints, in a thread: half a second without a setpoint ends
    PX4's offboard mode, also of vehicles that other parts of the program fly.

    Raises:
        MissingExtraError: scipy is not installed.
    """
    try:
        for name in ("scipy.optimize", "scipy.spatial"):
            import_module(name)
    except ImportError as error:
        raise MissingExtraError("swarms need scipy", "swarm") from error


def _known(points: Points) -> tuple[Indices, Points]:
    """Return the indices of the vehicles with a position, and their scaled positions."""
    space = scaled(points)
    known = np.flatnonzero(np.isfinite(space).all(axis=1))
    return known, space[known]


def _tree(space: Points) -> cKDTree:
    try:
        from scipy.spatial import cKDTree
    except ImportError as error:
        raise MissingExtraError("swarms need scipy", "swarm") from error
    return cKDTree(space)


def closest_approaches(starts: Points, ends: Points) -> Points:
    """Return the smallest scaled distance of each pair on straight lines that all fly in the same time.

    Args:
        starts: Positions at the start, an array of shape (n, 3).
        ends: Positions at the end.

    Returns:
        An array of shape (n, n) in metres, infinite of a vehicle and itself.
    """
    begin, finish = scaled(starts), scaled(ends)
    apart = begin[:, None] - begin[None]
    change = (finish[:, None] - finish[None]) - apart
    length = np.einsum("ijk,ijk->ij", change, change)
    along = -np.einsum("ijk,ijk->ij", apart, change)
    when = np.clip(np.divide(along, length, out=np.zeros_like(along), where=length > 0.0), 0.0, 1.0)
    nearest: Points = np.linalg.norm(apart + when[:, :, None] * change, axis=2)
    np.fill_diagonal(nearest, np.inf)
    return nearest


def pairs_below(between: Points, limit: float) -> Indices:
    """Return the pairs whose distance is below a limit, the nearest first: an array of shape (m, 2)."""
    first, second = np.nonzero(np.triu(between < limit, 1))
    order = np.argsort(between[first, second], kind="stable")
    return np.column_stack((first, second))[order]
