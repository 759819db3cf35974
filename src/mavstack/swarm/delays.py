"""How late each vehicle follows its setpoints, and setpoints that make up for it.

A setpoint needs time to arrive, and the vehicle needs time to follow it: at 5 m/s a vehicle that is 0.2 s
late is a metre behind its slot. The delay of each vehicle is learned from its own flight: the distance by
which it is behind its course, divided by the speed of the course. A setpoint is the place where the course
will be after the delay, so that the vehicle is there when it has followed it.

A delay is corrected slowly, as an integrator does, and is limited: wind, or a vehicle that cannot fly as fast
as its course, does not move the setpoint far ahead.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from mavstack.swarm.arrays import Indices, Points

#: The largest delay in seconds.
MAX_DELAY: Final = 0.5
#: Seconds in which a delay is learned.
_LEARNING_TIME: Final = 3.0
#: Speed of a course in m/s below which no delay is learned.
_MIN_SPEED: Final = 1.0


class Delays:
    """The delays of vehicles in seconds.

    Args:
        count: The number of vehicles.
        expected: The delay at the begin.
    """

    def __init__(self, count: int, expected: float) -> None:
        #: The delay of each vehicle.
        self.seconds: Points = np.full(count, min(expected, MAX_DELAY))

    def learn(self, vehicles: Indices, behind: Points, motion: Points, step: float) -> None:
        """Take how far vehicles are behind their courses.

        Args:
            vehicles: Their indices, each once.
            behind: Metres north, east, up from each vehicle to its place in the course.
            motion: Velocities of the courses in m/s.
            step: Seconds since the last call.
        """
        square = np.einsum("ij,ij->i", motion, motion)
        late = np.einsum("ij,ij->i", behind, motion) / np.maximum(square, _MIN_SPEED**2)
        known = np.isfinite(late) & (square > _MIN_SPEED**2)
        change = np.where(known, np.clip(late, -1.0, 1.0), 0.0) * step / _LEARNING_TIME
        self.seconds[vehicles] = np.clip(self.seconds[vehicles] + change, 0.0, MAX_DELAY)

    def lead(
        self, vehicles: Indices, course: tuple[Points, Points, Points], after: float = 0.0
    ) -> tuple[Points, Points]:
        """Return places and velocities of courses after the delays.

        Args:
            vehicles: The indices of the vehicles.
            course: Places in metres, velocities in m/s and accelerations in m/s² at a time near the delays.
            after: Seconds from now to this time.
        """
        places, motion, acceleration = course
        rest = self.seconds[vehicles][:, None] - after
        return places + rest * motion + 0.5 * rest**2 * acceleration, motion + rest * acceleration
