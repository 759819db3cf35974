"""Steering without a leader: each member knows only itself and the neighbours that it receives.

The velocity is the sum of three wishes: that of the mission, the mean velocity of the neighbours
(alignment), and the mean of their slots as seen from this member (cohesion). With slots d_i the offsets
converge to d_i - d_j for every connected network of neighbours (consensus, Olfati-Saber 2007), without
anyone knowing all positions.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.swarm.arrays import Points


@dataclass(frozen=True, slots=True)
class Neighbour:
    """A member that was received.

    Attributes:
        position: Metres north, east, up.
        velocity: North, east, up in m/s.
        slot: Its offset in the formation, north, east, up in metres.
    """

    position: Points
    velocity: Points
    slot: Points


def steer(
    own: Neighbour,
    neighbours: Sequence[Neighbour],
    mission: Points,
    *,
    cohesion: float = 0.5,
    alignment: float = 0.5,
    speed: float = 5.0,
) -> Points:
    """Return the velocity of a member.

    Args:
        own: The member.
        neighbours: The members that it receives.
        mission: The velocity of the mission in m/s.
        cohesion: Part of the error of its place that is corrected in a second.
        alignment: Weight of the neighbours' velocity against that of the mission, 0 to 1.
        speed: Largest speed in m/s.

    Returns:
        North, east, up in m/s.
    """
    wanted = np.asarray(mission, dtype=float)
    if neighbours:
        velocities = np.mean([each.velocity for each in neighbours], axis=0)
        errors = [(each.position - each.slot) - (own.position - own.slot) for each in neighbours]
        wanted = (1.0 - alignment) * wanted + alignment * velocities + cohesion * np.mean(errors, axis=0)
    length = float(np.linalg.norm(wanted))
    limited: Points = wanted if length <= speed else wanted * (speed / length)
    return limited
