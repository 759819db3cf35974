"""Avoidance: optimal reciprocal collision avoidance (van den Berg et al. 2011), in three dimensions.

For each pair there is a set of relative velocities that lead to a collision within `horizon` seconds. The
smallest change that leaves the set is shared: each vehicle changes its velocity by at least half of it, so
its new velocity lies in a half space. The velocity nearest to the preferred one in all half spaces, and in
the ball of the largest speed, is the new one; where there is none, it violates them as little as possible.
If all vehicles choose so, none collide within the horizon.

That proof needs velocities that change at once. A vehicle that needs `speed / acceleration` seconds to stop
is safe if the horizon is at least that and the latency, and the distance contains the errors of `Margins`.

- Heights are divided by `VERTICAL_FACTOR` (see `separation`), so the region of a vehicle is the ellipsoid
  of its downwash.
- Vehicles that meet head-on would hesitate, and those of one plane would not find the ways above and below
  it. Preferred velocities are turned a little to the right, as in the rules of the air, and tilted up or
  down, each by another angle.
- The core solves the linear programs (`rust/swarm`): a thousand vehicles in one step of a controller.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack._core import avoiding_velocities
from mavstack.errors import InvalidArgumentError
from mavstack.swarm.separation import VERTICAL_FACTOR, scaled

if TYPE_CHECKING:
    from mavstack.swarm.arrays import Points

#: Angle in radians by which preferred velocities are turned to the right, and the largest tilt up or down as
#: a tangent.
_RIGHT_HAND: Final = math.radians(3.0)
_TILT: Final = 0.05
#: Step of the tilt from one vehicle to the next: multiples of the golden ratio never repeat, so all tilts
#: differ.
_GOLDEN_RATIO: Final = (5.0**0.5 - 1.0) / 2.0
#: Vehicles that are too close to each other must separate within this number of steps.
_SEPARATION_STEPS: Final = 5.0
_TINY: Final = 1e-9
#: Metres north, east and up in one unit of the scaled space.
_AXES: Final = (1.0, 1.0, VERTICAL_FACTOR)


@dataclass(frozen=True, slots=True)
class Avoidance:
    """Parameters of the avoidance.

    Attributes:
        distance: Metres that two vehicles keep, heights divided by `VERTICAL_FACTOR`.
        horizon: Seconds within which no collision may happen.
        speed: Largest speed over ground in m/s; the vertical one is `VERTICAL_FACTOR` times as large.
        acceleration: Largest acceleration in m/s².
        neighbours: The number of nearest vehicles that are considered.
        step: Seconds until the next call.
    """

    distance: float = 4.0
    horizon: float = 5.0
    speed: float = 5.0
    acceleration: float = 3.0
    neighbours: int = 30
    step: float = 0.1

    def __post_init__(self) -> None:
        for name in self.__slots__:
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0):
                raise InvalidArgumentError(f"{name} must be finite and more than 0, got {value}")

    def velocities(self, positions: Points, velocities: Points, preferred: Points) -> Points:
        """Return the next velocity of each vehicle, as far as the acceleration allows within a step.

        Args:
            positions: Metres north, east, up; an array of shape (n, 3).
            velocities: Present velocities in m/s.
            preferred: Velocities that the vehicles would choose alone.

        Returns:
            Velocities in m/s, an array of shape (n, 3).

        Raises:
            InvalidArgumentError: The arrays differ in shape, or a number is not finite.
        """
        present = _checked(velocities)
        change = scaled(self.targets(positions, velocities, preferred)) - present
        chosen: Points = (present + _limited(change, self.acceleration * self.step)) * _AXES
        return chosen

    def targets(self, positions: Points, velocities: Points, preferred: Points) -> Points:
        """Return the velocity that each vehicle should reach.

        Args:
            positions: Metres north, east, up; an array of shape (n, 3).
            velocities: Present velocities in m/s.
            preferred: Velocities that the vehicles would choose alone.

        Returns:
            Velocities in m/s, an array of shape (n, 3).

        Raises:
            InvalidArgumentError: The arrays differ in shape, or a number is not finite.
        """
        place, present, wanted = (_checked(each) for each in (positions, velocities, preferred))
        if not place.shape == present.shape == wanted.shape:
            raise InvalidArgumentError("positions, velocities and preferred must have one shape")
        chosen = avoiding_velocities(
            place.tobytes(),
            present.tobytes(),
            _without_symmetry(wanted).tobytes(),
            distance=self.distance,
            horizon=self.horizon,
            speed=self.speed,
            neighbours=self.neighbours,
            separation_time=_SEPARATION_STEPS * self.step,
        )
        targets: Points = np.frombuffer(chosen).reshape(-1, 3) * _AXES
        return targets

    def undisturbed(self, preferred: Points) -> Points:
        """Return the targets of vehicles without neighbours, in m/s."""
        alone: Points = _limited(_without_symmetry(_checked(preferred)), self.speed) * _AXES
        return alone


def _checked(vectors: Points) -> Points:
    array = scaled(vectors)
    if array.ndim != 2 or array.shape[1] != 3 or not np.isfinite(array).all():
        raise InvalidArgumentError("positions and velocities must be finite, three for each vehicle")
    return array


def _without_symmetry(velocities: Points) -> Points:
    cosine, sine = math.cos(_RIGHT_HAND), math.sin(_RIGHT_HAND)
    north, east, up = velocities.T
    tilt = _TILT * (2.0 * (np.arange(len(velocities)) * _GOLDEN_RATIO % 1.0) - 1.0)
    return np.column_stack(
        (cosine * north - sine * east, sine * north + cosine * east, up + tilt * np.hypot(north, east))
    )


def _limited(vectors: Points, limit: float) -> Points:
    """Return vectors that are shortened to a length."""
    length = np.sqrt((vectors * vectors).sum(axis=1))
    shortened: Points = vectors * np.minimum(1.0, limit / np.maximum(length, _TINY))[:, None]
    return shortened
