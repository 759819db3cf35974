"""A show: the trajectory and the lights of each vehicle over one time.

A trajectory is a chain of Bézier curves of at most degree 7, as in the files of Skybrush. Its coordinates are
those of the show: x ahead, y to the left, z up, in metres; `placed` turns them to north, east, up.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.swarm.arrays import Indices, Points

#: Maximum degree of a curve.
MAX_DEGREE: Final = 7
#: Maximum coordinate in metres, duration in seconds, and number of curves of one vehicle.
MAX_COORDINATE: Final = 1e5
MAX_DURATION: Final = 4 * 3600.0
MAX_CURVES: Final = 100_000


@dataclass(frozen=True, slots=True)
class Curve:
    """A Bézier curve.

    Attributes:
        begin: Seconds since the start of the show.
        duration: Seconds.
        points: Control points, the ends included: x, y, z in metres.
    """

    begin: float
    duration: float
    points: Sequence[tuple[float, float, float]]


class Trajectory:
    """A chain of curves, each beginning where the one before ends.

    Args:
        curves: The curves in order; at least one.

    Raises:
        InvalidArgumentError: A curve does not follow the one before in time, or has numbers that are not
            possible.
    """

    def __init__(self, curves: Sequence[Curve]) -> None:
        if not 1 <= len(curves) <= MAX_CURVES:
            raise InvalidArgumentError(f"a trajectory must have 1 to {MAX_CURVES} curves, got {len(curves)}")
        self.curves = tuple(curves)
        self._begins = np.array([each.begin for each in curves])
        self._durations = np.array([each.duration for each in curves])
        ends = self._begins + self._durations
        if not (np.isfinite(ends).all() and (self._durations > 0.0).all() and ends[-1] <= MAX_DURATION):
            raise InvalidArgumentError("curves must have times in order, within four hours")
        if self._begins[0] < 0.0 or np.abs(self._begins[1:] - ends[:-1]).max(initial=0.0) > 1e-6:
            raise InvalidArgumentError("each curve must begin when the one before ends")
        self._powers = np.array([_powers(each.points) for each in curves])

    @property
    def begin(self) -> float:
        """Seconds at which the first curve begins."""
        return float(self._begins[0])

    @property
    def end(self) -> float:
        """Seconds at which the last curve ends."""
        return float(self._begins[-1] + self._durations[-1])

    def positions(self, times: Points) -> Points:
        """Return x, y, z in metres at times in seconds; before the begin and after the end it rests."""
        index, share = self._shares(times)
        return _horner(self._powers[index], share)

    def velocities(self, times: Points) -> Points:
        """Return the velocity in m/s at times in seconds."""
        index, share = self._shares(times)
        degrees = np.arange(MAX_DEGREE + 1, dtype=float)[:, None]
        slopes: Points = (self._powers[index] * degrees)[:, 1:]
        speed: Points = _horner(slopes, share) / self._durations[index][:, None]
        speed[(np.asarray(times) < self.begin) | (np.asarray(times) > self.end)] = 0.0
        return speed

    def _shares(self, times: Points) -> tuple[Indices, Points]:
        found = np.searchsorted(self._begins, times, side="right") - 1
        index: Indices = np.clip(found, 0, len(self.curves) - 1).astype(np.int64)
        return index, np.clip((times - self._begins[index]) / self._durations[index], 0.0, 1.0)


@dataclass(frozen=True, slots=True)
class ShowVehicle:
    """The part of one vehicle.

    Attributes:
        name: Its name in the file.
        trajectory: Its trajectory.
        lights: Its light program, in the bytes of Skybrush; empty: no lights.
    """

    name: str
    trajectory: Trajectory
    lights: bytes = b""


@dataclass(frozen=True, slots=True)
class Show:
    """A show.

    Attributes:
        name: Its title.
        vehicles: The vehicles.
    """

    name: str
    vehicles: Sequence[ShowVehicle]

    def __post_init__(self) -> None:
        if not self.vehicles:
            raise InvalidArgumentError("a show must have at least one vehicle")

    @property
    def duration(self) -> float:
        """Seconds until the last vehicle has ended."""
        return max(each.trajectory.end for each in self.vehicles)

    def positions(self, time: float) -> Points:
        """Return the positions of all vehicles at a time, an array of shape (n, 3)."""
        times = np.array([time])
        return np.array([each.trajectory.positions(times)[0] for each in self.vehicles])

    def velocities(self, time: float) -> Points:
        """Return the velocities of all vehicles at a time, an array of shape (n, 3)."""
        times = np.array([time])
        return np.array([each.trajectory.velocities(times)[0] for each in self.vehicles])

    def airborne(self, height: float, rate: float = 10.0) -> tuple[float, float]:
        """Return the first and the last time at which all vehicles are above a height.

        Args:
            height: Metres.
            rate: Times a second at which heights are compared.

        Raises:
            InvalidArgumentError: They are never above it at the same time.
        """
        times = np.arange(0.0, self.duration, 1.0 / rate)
        heights = np.array([each.trajectory.positions(times)[:, 2] for each in self.vehicles])
        above = np.nonzero((heights >= height).all(axis=0))[0]
        if not len(above):
            raise InvalidArgumentError(f"the vehicles are never {height:g} m high at the same time")
        return float(times[above[0]]), float(times[above[-1]])


@dataclass(frozen=True, slots=True)
class ShowCourse:
    """A part of a show as the course of a swarm.

    Attributes:
        show: The show.
        first: Seconds of the show at which the course begins.
        last: Seconds of the show at which it ends.
        origin: Metres north, east, up of the show's origin.
        orientation: Direction of the x axis in degrees, clockwise from north.
        order: The vehicle of the show that each member flies.
    """

    show: Show
    first: float
    last: float
    origin: tuple[float, float, float]
    orientation: float
    order: Sequence[int]

    @property
    def duration(self) -> float:
        """Seconds until the course ends."""
        return self.last - self.first

    def state(self, time: float) -> tuple[Points, Points]:
        """Return positions and velocities, north, east, up."""
        now = self.first + min(max(time, 0.0), self.duration)
        order = np.asarray(self.order, dtype=np.int64)
        places = placed(self.show.positions(now)[order], self.orientation) + np.asarray(self.origin)
        motion = placed(self.show.velocities(now)[order], self.orientation)
        return places, motion if 0.0 <= time < self.duration else np.zeros_like(motion)


def placed(points: Points, orientation: float) -> Points:
    """Return coordinates of a show as metres north, east, up.

    Args:
        points: x ahead, y to the left, z up; an array of shape (n, 3).
        orientation: Direction of the x axis in degrees, clockwise from north.
    """
    angle = math.radians(orientation)
    cosine, sine = math.cos(angle), math.sin(angle)
    ahead, left = points[:, 0], points[:, 1]
    return np.column_stack((cosine * ahead + sine * left, sine * ahead - cosine * left, points[:, 2]))


def _powers(points: Sequence[tuple[float, float, float]]) -> Points:
    """Return a Bézier curve as coefficients of powers of its share, padded to `MAX_DEGREE`."""
    control = np.asarray(points, dtype=float)
    if control.ndim != 2 or control.shape[1] != 3 or not 2 <= len(control) <= MAX_DEGREE + 1:
        raise InvalidArgumentError(f"a curve must have 2 to {MAX_DEGREE + 1} points of three numbers")
    if not (np.abs(control) <= MAX_COORDINATE).all():
        raise InvalidArgumentError(f"coordinates must be finite and at most {MAX_COORDINATE:g} m")
    degree = len(control) - 1
    powers = np.zeros((MAX_DEGREE + 1, 3))
    for power in range(degree + 1):
        for index in range(power + 1):
            sign = (-1) ** (power - index)
            weight = math.comb(degree, power) * math.comb(power, index)
            powers[power] += sign * weight * control[index]
    return powers


def _horner(powers: Points, share: Points) -> Points:
    value = powers[:, -1]
    for power in range(powers.shape[1] - 2, -1, -1):
        value = value * share[:, None] + powers[:, power]
    return np.array(value)
