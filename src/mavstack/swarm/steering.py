"""One step of a swarm's controller: from a course and the members' states to their setpoints.

The preferred velocity of a member is that of its course, and a part of its error of place. Avoidance may
change it. Where it does not, the setpoint is the place and the velocity of the course, which a vehicle
tracks best; where it does, the setpoint is the changed velocity alone, since a place ahead would add to it.

A vehicle that is not a member avoids no member. Members take half of the change of velocity that is needed at
each step, and half of the rest at the next one, which the horizon of several seconds allows.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    import numpy.typing as npt

    from mavstack.swarm.arrays import Points
    from mavstack.swarm.avoidance import Avoidance

#: Gain in 1/s with which a position error is corrected.
_GAIN: Final = 0.8
#: A member leaves its course if avoidance changes its velocity by more than this, in m/s.
_DEVIATES: Final = 0.3
#: Positions and velocities if there are no vehicles besides the members.
NO_VEHICLES: Final = (np.empty((0, 3)), np.empty((0, 3)))


@dataclass(frozen=True, slots=True)
class Steering:
    """Setpoints of one step.

    Attributes:
        places: Metres north, east, up; an array of shape (n, 3), NaN for members that avoid another one.
        velocities: North, east, up in m/s.
        deviates: True for each member that avoids another one.
    """

    places: Points
    velocities: Points
    deviates: npt.NDArray[np.bool_]


def steer_members(
    positions: Points,
    velocities: Points,
    course: tuple[Points, Points],
    avoidance: Avoidance,
    others: tuple[Points, Points] = NO_VEHICLES,
) -> Steering:
    """Return the setpoints of all members.

    Args:
        positions: Metres north, east, up; an array of shape (n, 3).
        velocities: North, east, up in m/s.
        course: Places and velocities of the course now.
        avoidance: The parameters of the avoidance.
        others: Positions and velocities of vehicles that are not members.
    """
    places, motion = course
    preferred = _limited(motion + _GAIN * (places - positions), avoidance.speed)
    chosen = avoidance.targets(
        np.vstack((positions, others[0])),
        np.vstack((velocities, others[1])),
        np.vstack((preferred, others[1])),
    )[: len(positions)]
    deviates = np.linalg.norm(chosen - avoidance.undisturbed(preferred), axis=1) > _DEVIATES
    off_course = deviates[:, None]
    return Steering(
        np.where(off_course, np.nan, places),
        np.where(off_course, chosen, motion),
        deviates,
    )


def _limited(vectors: Points, limit: float) -> Points:
    length = np.maximum(np.linalg.norm(vectors, axis=1), 1e-9)
    limited: Points = vectors * np.minimum(1.0, limit / length)[:, None]
    return limited
