"""The frame of a formation: where its leader is, where it moves, and how its slots move with it.

A slot r metres from the leader moves with the leader's velocity, and by r times the turning rate across. A
leader that turns at once would ask its followers for any speed, so the frame turns at a limited rate, and
behind it: `turn_rate` is the rate at which the outermost slot still keeps its speed limit (`turn_rate_for`).

The course is that of the velocity, and is kept below `MIN_COURSE_SPEED`, where a velocity is mostly noise.
Positions are carried on by the velocity between two measurements, at most `MAX_EXTRAPOLATION` seconds.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from mavstack.errors import InvalidArgumentError
from mavstack.swarm.formations import rotate_to_course

if TYPE_CHECKING:
    from mavstack.swarm.arrays import Points

#: Speed in m/s below which the velocity of the leader does not give a course.
MIN_COURSE_SPEED: Final = 0.5
#: Seconds for which the leader's position is extrapolated.
MAX_EXTRAPOLATION: Final = 1.0
#: Time constant in seconds with which the course approaches the direction of the velocity.
COURSE_TIME: Final = 0.5


def turn_rate_for(offsets: Points, speed: float, max_speed: float) -> float:
    """Return the largest turning rate at which every slot keeps a speed, in degrees a second.

    Args:
        offsets: The slots in metres, an array of shape (n, 3).
        speed: Speed of the leader in m/s.
        max_speed: Largest speed of a follower in m/s.
    """
    if not 0.0 <= speed < max_speed:
        raise InvalidArgumentError(
            f"max_speed must be more than the leader's {speed:g} m/s, got {max_speed:g}"
        )
    radius = float(np.hypot(offsets[:, 0], offsets[:, 1]).max(initial=0.0))
    return math.degrees((max_speed - speed) / radius) if radius else 360.0


class LeaderFrame:
    """The moving frame of a formation.

    Args:
        course: Direction at the start in degrees.
        turn_rate: Largest turning rate in degrees a second.
        course_time: Time constant in seconds with which the course approaches the direction of the velocity.
    """

    def __init__(
        self, course: float = 0.0, turn_rate: float = 20.0, course_time: float = COURSE_TIME
    ) -> None:
        if not turn_rate > 0.0:
            raise InvalidArgumentError(f"turn_rate must be more than 0 degrees a second, got {turn_rate:g}")
        self.course = course
        self.turn_rate = turn_rate
        self._course_time = course_time
        self._rate = 0.0
        self._position: Points = np.zeros(3)
        self._velocity: Points = np.zeros(3)
        self._measured_at = self._turned_at = -math.inf

    def update(self, position: Points, velocity: Points, now: float) -> None:
        """Take a measurement of the leader.

        Args:
            position: Metres north, east, up.
            velocity: North, east, up in m/s.
            now: Time of the measurement in seconds.
        """
        self._position, self._velocity = np.asarray(position, float), np.asarray(velocity, float)
        self._measured_at = now

    def turn(self, degrees: float) -> None:
        """Turn the course by what the leader has turned, beside what its velocity says."""
        self.course = (self.course + degrees) % 360.0

    def slots(self, offsets: Points, now: float) -> tuple[Points, Points]:
        """Return where the slots are and how they move.

        Args:
            offsets: Metres forward, right, up; an array of shape (n, 3).
            now: Seconds; it never decreases.

        Returns:
            Positions in metres and velocities in m/s, north, east, up.
        """
        self._turn(now)
        age = min(max(now - self._measured_at, 0.0), MAX_EXTRAPOLATION)
        turned = rotate_to_course(offsets, self.course)
        rate = math.radians(self._rate)
        across = np.column_stack((-rate * turned[:, 1], rate * turned[:, 0], np.zeros(len(turned))))
        return self._position + age * self._velocity + turned, self._velocity + across

    def _turn(self, now: float) -> None:
        step = now - self._turned_at
        self._turned_at, self._rate = now, 0.0
        north, east = self._velocity[:2]
        if not (0.0 < step < math.inf) or math.hypot(north, east) < MIN_COURSE_SPEED:
            return
        error = math.remainder(math.degrees(math.atan2(east, north)) - self.course, 360.0)
        wanted = error * min(1.0, step / self._course_time)
        change = math.copysign(min(abs(wanted), self.turn_rate * step), wanted)
        self.course = (self.course + change) % 360.0
        self._rate = change / step
