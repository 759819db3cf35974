"""Transitions: from one set of positions to another without coming too close.

All vehicles fly straight lines in the same time with the same profile of speed. If the assignment minimises
the sum of squared distances and both starts and goals are at least √2 · d apart, no two come nearer than d
(Turpin et al. 2014): the ways need no avoidance in flight. Where that fails, since the goals are given or
too near to each other, two other ways are tried, and each is checked before it is used:

- `layers`: vehicles whose ways conflict cross at different heights. Each climbs to its layer, moves, and
  descends.
- `staggered`: vehicles start one after the other, each as early as those before it allow.

The profile is the polynomial of least jerk: the speed peaks at 1.875 times the mean, the acceleration at
5.77 · L / T².
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal

import numpy as np

from mavstack.errors import InvalidArgumentError
from mavstack.swarm.assignment import assign_slots
from mavstack.swarm.separation import (
    VERTICAL_FACTOR,
    closest_approaches,
    distances,
    nearest_pair,
    pairs_below,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy.typing as npt

    from mavstack.swarm.arrays import Indices, Points

Method = Literal["straight", "layers", "staggered"]
#: Peak speed (m/s) and peak acceleration (m/s2) of the motion profile for one metre in one second.
PEAK_SPEED: Final = 1.875
PEAK_ACCELERATION: Final = 10.0 / math.sqrt(3.0)
#: Samples per second in the check of a finished plan.
CHECK_RATE: Final = 25.0
#: Share by which distances may be too short because of rounding.
_TOLERANCE: Final = 1e-6
#: Starts are delayed in steps of this size, in seconds, until the paths keep their distance.
_STAGGER_STEP: Final = 0.5


@dataclass(frozen=True, slots=True)
class Limits:
    """Limits of the motion of a vehicle.

    Attributes:
        speed: Largest speed over ground in m/s.
        climb: Largest vertical speed in m/s.
        acceleration: Largest acceleration in m/s².
    """

    speed: float = 5.0
    climb: float = 2.0
    acceleration: float = 2.0

    def duration(self, way: Points) -> float:
        """Return the seconds that the longest of some straight ways takes; `way` has shape (n, 3)."""
        if not len(way):
            return 0.0
        across, up = np.hypot(way[:, 0], way[:, 1]).max(), np.abs(way[:, 2]).max()
        length = float(np.linalg.norm(way, axis=1).max())
        return max(
            PEAK_SPEED * float(across) / self.speed,
            PEAK_SPEED * float(up) / self.climb,
            math.sqrt(PEAK_ACCELERATION * length / self.acceleration),
        )


@dataclass(frozen=True, slots=True)
class Leg:
    """A part of a transition: straight lines, each in its own time.

    Attributes:
        starts: Positions at the start, an array of shape (n, 3).
        ends: Positions at the end.
        begin: Seconds from the start of the transition to that of each vehicle's line.
        duration: Seconds of each line.
    """

    starts: Points
    ends: Points
    begin: Points
    duration: Points

    @property
    def end(self) -> float:
        """Seconds from the start of the transition to the end of this part."""
        return float((self.begin + self.duration).max(initial=0.0))

    @property
    def is_simultaneous(self) -> bool:
        """True if all vehicles fly their lines in the same time."""
        return bool(np.ptp(self.begin) == 0.0 and np.ptp(self.duration) == 0.0)

    def separation(self, rate: float) -> float:
        """Return the smallest scaled distance of two vehicles; sampled at `rate` if not simultaneous."""
        if self.is_simultaneous:
            return float(closest_approaches(self.starts, self.ends).min(initial=math.inf))
        times = np.arange(float(self.begin.min()), self.end + 1.0 / rate, 1.0 / rate)
        return min(nearest_pair(self.state(float(time))[0])[0] for time in times)

    def state(self, time: float) -> tuple[Points, Points]:
        """Return positions and velocities at a time."""
        safe = np.maximum(self.duration, 1e-9)
        share = np.clip((time - self.begin) / safe, 0.0, 1.0)
        way = self.ends - self.starts
        place = share**3 * (10.0 + share * (-15.0 + 6.0 * share))
        speed = 30.0 * share**2 * (1.0 - share) ** 2 / safe
        return self.starts + place[:, None] * way, speed[:, None] * way


@dataclass(frozen=True, slots=True)
class Transition:
    """A plan: positions and velocities of all vehicles at any time.

    Attributes:
        method: How the ways are kept apart.
        slots: The goal of each vehicle, as an index.
        legs: The parts, one after the other.
    """

    method: Method
    slots: Indices
    legs: tuple[Leg, ...]

    @property
    def duration(self) -> float:
        """Seconds until the last vehicle has arrived."""
        return self.legs[-1].end if self.legs else 0.0

    def state(self, time: float) -> tuple[Points, Points]:
        """Return positions and velocities at a time.

        Args:
            time: Seconds since the start; before it and after the end the vehicles stand.

        Returns:
            Metres north, east, up and m/s, two arrays of shape (n, 3).
        """
        leg = next((each for each in self.legs if time < each.end), self.legs[-1])
        return leg.state(time)

    def separation(self, rate: float = CHECK_RATE) -> float:
        """Return the smallest scaled distance of two vehicles over the whole plan in metres.

        Args:
            rate: Times a second at which lines are sampled that do not begin and end together.
        """
        return min((leg.separation(rate) for leg in self.legs), default=math.inf)


def plan_transition(
    starts: Points,
    goals: Points,
    distance: float,
    *,
    limits: Limits | None = None,
    slots: Sequence[int] | Indices | None = None,
    closest_start: float | None = None,
) -> Transition:
    """Plan the ways of all vehicles.

    Args:
        starts: Positions in metres north, east, up; an array of shape (n, 3).
        goals: At least n goals.
        distance: Metres that two vehicles keep, heights divided by `VERTICAL_FACTOR`; see `Margins`.
        limits: Speeds and accelerations; None: 5 m/s, 2 m/s up and down, 2 m/s².
        slots: The goal of each vehicle; None: the assignment with the least sum of squared distances.
        closest_start: Metres to which vehicles may be near at the start; None: `distance`. Those that are
            nearer than `distance` do not come nearer than they are.

    Returns:
        The plan, which keeps the distance.

    Raises:
        InvalidArgumentError: Starts or goals are nearer than the distance, or no way was found.
        MissingExtraError: scipy is not installed.
    """
    begin, limit = _positions("starts", starts), limits or Limits()
    targets = _positions("goals", goals)
    chosen = assign_slots(begin, targets) if slots is None else np.asarray(slots, dtype=np.int64)
    ends = targets[chosen]
    _check_apart("starts", begin, distance if closest_start is None else closest_start)
    _check_apart("goals", ends, distance)
    between, kept = (
        closest_approaches(begin, ends),
        np.minimum(distances(begin), distance) * (1.0 - _TOLERANCE),
    )
    conflicts = between < kept
    if not conflicts.any():
        return Transition("straight", chosen, (_leg(begin, ends, limit),))
    lowest = float(kept.min(initial=math.inf))
    layered = _layered(begin, ends, chosen, distance, limit, conflicts)
    if layered.separation() >= lowest:
        return layered
    staggered = _staggered(begin, ends, chosen, distance, limit)
    if staggered is not None and staggered.separation() >= lowest:
        return staggered
    raise InvalidArgumentError(
        f"no transition keeps {distance:g} m between all vehicles; the straight lines come within "
        f"{between.min():.1f} m: let the vehicles choose their slots, or increase the spacing"
    )


def straight_transition(starts: Points, ends: Points, limits: Limits | None = None) -> Transition:
    """Return straight lines for all vehicles, which are not checked: parallel ones keep their distances."""
    begin, end = _positions("starts", starts), _positions("ends", ends)
    return Transition("straight", np.arange(len(begin)), (_leg(begin, end, limits or Limits()),))


def _positions(name: str, points: Points) -> Points:
    array = np.asarray(points, dtype=float)
    if array.ndim != 2 or array.shape[1] != 3 or not np.isfinite(array).all():
        raise InvalidArgumentError(f"{name} must be finite positions north, east, up")
    return array


def _check_apart(name: str, points: Points, distance: float) -> None:
    found, first, second = nearest_pair(points)
    if found < distance * (1.0 - _TOLERANCE):
        raise InvalidArgumentError(
            f"{name} must be at least {distance:.1f} m apart (heights divided by {VERTICAL_FACTOR:g}), "
            f"number {first} and {second} are {found:.1f} m apart"
        )


def _leg(starts: Points, ends: Points, limits: Limits, begin: float = 0.0) -> Leg:
    """Return straight lines that all vehicles fly at the same time."""
    count = len(starts)
    return Leg(starts, ends, np.full(count, begin), np.full(count, limits.duration(ends - starts)))


def _layered(
    starts: Points,
    ends: Points,
    slots: Indices,
    distance: float,
    limits: Limits,
    conflicts: npt.NDArray[np.bool_],
) -> Transition:
    """Let vehicles whose ways conflict cross in layers of height."""
    layers = _layers(starts, distance, conflicts)
    base = max(float(starts[:, 2].max()), float(ends[:, 2].max()))
    height = base + layers * distance * VERTICAL_FACTOR
    up, down = starts.copy(), ends.copy()
    up[:, 2] = down[:, 2] = height
    climb = _leg(starts, up, limits)
    across = _leg(up, down, limits, climb.end)
    return Transition("layers", slots, (climb, across, _leg(down, ends, limits, across.end)))


def _layers(starts: Points, distance: float, conflicts: npt.NDArray[np.bool_]) -> Indices:
    """Return a layer for each vehicle; those in conflict differ, those above each other keep their order."""
    ground = np.linalg.norm(starts[:, None, :2] - starts[None, :, :2], axis=2)
    above = (ground < distance) & (starts[:, None, 2] > starts[None, :, 2])
    layers = np.full(len(starts), -1, dtype=np.int64)
    for vehicle in np.argsort(starts[:, 2], kind="stable"):
        taken = set(layers[conflicts[vehicle]].tolist())
        lowest = int(layers[above[vehicle]].max(initial=-1)) + 1
        layers[vehicle] = next(layer for layer in range(lowest, lowest + len(starts)) if layer not in taken)
    return layers


def _staggered(
    starts: Points, ends: Points, slots: Indices, distance: float, limits: Limits
) -> Transition | None:
    """Let vehicles start one after the other, those that block the goals of others first."""
    count, lines = len(starts), ends - starts
    duration = np.array([limits.duration(line[None]) for line in lines])
    begin = np.zeros(count)
    placed: list[int] = []
    for vehicle in _departure_order(starts, ends, distance):
        latest = max((begin[other] + duration[other] for other in placed), default=0.0)
        for delay in np.arange(0.0, latest + _STAGGER_STEP, _STAGGER_STEP):
            begin[vehicle] = delay
            if _keeps(Leg(starts, ends, begin, duration), vehicle, placed, distance):
                break
        else:
            return None
        placed.append(vehicle)
    return Transition("staggered", slots, (Leg(starts, ends, begin, duration),))


def _departure_order(starts: Points, ends: Points, distance: float) -> list[int]:
    """Return the vehicles so that one leaves before another one flies over its start."""
    lengths = np.linalg.norm(ends - starts, axis=1)
    blocked = np.array(
        [len(pairs_below(_to_others(starts, ends, vehicle), distance)) for vehicle in range(len(starts))]
    )
    return [int(vehicle) for vehicle in np.lexsort((lengths, blocked))]


def _to_others(starts: Points, ends: Points, vehicle: int) -> Points:
    """Return the distances of one vehicle's line to all that still stand at their starts."""
    still = starts.copy()
    moving = still.copy()
    moving[vehicle] = ends[vehicle]
    return closest_approaches(still, moving)


def _keeps(leg: Leg, vehicle: int, placed: list[int], distance: float) -> bool:
    if not placed:
        return True
    group = [vehicle, *placed]
    end = float((leg.begin + leg.duration)[group].max())
    for time in np.arange(0.0, end + 0.1, 0.1):
        if distances(leg.state(float(time))[0][group])[0].min() < distance:
            return False
    return True
