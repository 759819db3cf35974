"""What dead motors leave of a body.

A quad without one motor can no longer balance its yaw: it must nearly stop the opposite one too, spins the
way the surplus pair pushes it, leans to the dead corner and comes down. Two dead ones leave next to nothing.
"""

from __future__ import annotations

from typing import NamedTuple

from mavstack.sim.kinds import VehicleType
from mavstack.sim.motion.airframes import AIRFRAMES

#: Share of the full lift a quad keeps with so many motors dead.
LIFT_LEFT = (1.0, 0.42, 0.15, 0.0, 0.0)
#: How fast one dead motor of a quad lets it spin, and lean, in rad/s.
SPIN, LEAN = 8.0, 0.6
#: Where each motor sits: right or left, front or rear; and where its loss spins the body.
CORNERS = {1: (1.0, -1.0, -1.0), 2: (-1.0, 1.0, -1.0), 3: (-1.0, -1.0, 1.0), 4: (1.0, 1.0, 1.0)}
PUSHER = 5


class Damage(NamedTuple):
    """Shares of lift and drive left, the spin, and the lean in roll and pitch."""

    lift: float
    drive: float
    spin: float
    lean: tuple[float, float]


def damage(kind: VehicleType, dead: set[int]) -> Damage:
    """Say what the dead motors do to a body of a type."""
    if kind in (VehicleType.COPTER, VehicleType.VTOL):
        return _quad(dead)
    left = 1.0 - len(dead) / AIRFRAMES[kind].motors
    return Damage(left, left, 0.0, (0.0, 0.0))


def _quad(dead: set[int]) -> Damage:
    corners = [CORNERS[number] for number in sorted(dead) if number in CORNERS]
    lift = LIFT_LEFT[len(corners)]
    roll, pitch, spin = (sum(corner[axis] for corner in corners) for axis in range(3))
    way = max(-1.0, min(1.0, spin))
    return Damage(lift, 0.0 if PUSHER in dead else 1.0, SPIN * way, (LEAN * roll, LEAN * pitch))
