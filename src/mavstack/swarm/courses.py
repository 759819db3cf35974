"""Courses: where each member has to be at each time, and how it moves there.

A course is a function of the seconds since it began. `Transition` is one; here are the others: to stand, to
turn the whole formation, and to follow a leader that another program flies, which has no end.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np

from mavstack.errors import InvalidArgumentError
from mavstack.swarm.transitions import PEAK_ACCELERATION, PEAK_SPEED

if TYPE_CHECKING:
    from mavstack.swarm.arrays import Points
    from mavstack.swarm.leader import LeaderFrame
    from mavstack.swarm.transitions import Limits


class Course(Protocol):
    """Positions and velocities over time."""

    @property
    def duration(self) -> float:
        """Seconds until the course ends; infinite if it does not."""

    def state(self, time: float) -> tuple[Points, Points]:
        """Return positions in metres and velocities in m/s, north, east, up, at seconds since the begin."""


@dataclass(frozen=True, slots=True)
class Standing:
    """Stay at places.

    Attributes:
        places: Metres north, east, up; an array of shape (n, 3).
    """

    places: Points
    duration: float = 0.0

    def state(self, time: float) -> tuple[Points, Points]:
        """Return the places, without motion."""
        return self.places, np.zeros_like(self.places)


@dataclass(frozen=True, slots=True)
class Turn:
    """Turn a formation around a centre.

    Attributes:
        places: Metres north, east, up at the begin.
        centre: Metres north and east of the centre.
        angle: Degrees, clockwise if positive.
        limits: Limits of the members' motion.
    """

    places: Points
    centre: tuple[float, float]
    angle: float
    limits: Limits

    def __post_init__(self) -> None:
        if not math.isfinite(self.angle):
            raise InvalidArgumentError(f"angle must be finite, got {self.angle:g}")

    @property
    def duration(self) -> float:
        """Seconds until the turn ends."""
        radius = max(float(np.hypot(*(self.places[:, :2] - self.centre).T).max(initial=0.0)), 1.0)
        way, acceleration = abs(math.radians(self.angle)) * radius, self.limits.acceleration / math.sqrt(2.0)
        # Centripetal and tangential acceleration are at right angles, so each may use the limit divided by
        # the root of two.
        speed = min(self.limits.speed, math.sqrt(acceleration * radius))
        return max(PEAK_SPEED * way / speed, math.sqrt(PEAK_ACCELERATION * way / acceleration))

    def state(self, time: float) -> tuple[Points, Points]:
        """Return positions and velocities."""
        total = max(self.duration, 1e-9)
        share = min(max(time / total, 0.0), 1.0)
        angle = math.radians(self.angle) * share**3 * (10.0 + share * (-15.0 + 6.0 * share))
        rate = math.radians(self.angle) * 30.0 * share**2 * (1.0 - share) ** 2 / total
        cosine, sine = math.cos(angle), math.sin(angle)
        north, east = (self.places[:, :2] - self.centre).T
        turned = self.places.copy()
        turned[:, 0] = self.centre[0] + cosine * north - sine * east
        turned[:, 1] = self.centre[1] + sine * north + cosine * east
        motion = np.zeros_like(turned)
        motion[:, 0] = -rate * (turned[:, 1] - self.centre[1])
        motion[:, 1] = rate * (turned[:, 0] - self.centre[0])
        return turned, motion


@dataclass(frozen=True, slots=True)
class Following:
    """Follow a leader that another program flies.

    Attributes:
        leader: The moving frame, to which positions of the leader are given.
        offsets: The slots: metres forward, right, up.
        begin: Time at which the course begins, on the clock of the frame.
    """

    leader: LeaderFrame
    offsets: Points
    begin: float
    duration: float = math.inf

    def state(self, time: float) -> tuple[Points, Points]:
        """Return positions and velocities."""
        return self.leader.slots(self.offsets, self.begin + time)
