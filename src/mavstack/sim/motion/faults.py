"""What dead motors leave of a body.

A quad without one motor can no longer balance its yaw: it must nearly stop the opposite one too, spins the
way the surplus pair pushes it, leans to the dead corner and comes down. Two dead ones leave next to nothing.
"""

from __future__ import annotations

from typing import NamedTuple

from mavstack.sim.motion.airframes import AIRFRAMES
from mavstack.sim.vehicle_types import VehicleType

#: Share of the full lift a quad keeps with so many motors dead.
LIFT_LEFT = (1.0, 0.42, 0.15, 0.0, 0.0)
#: How fast one dead motor of a quad lets it spin, and lean, in rad/s.
SPIN, LEAN = 8.0, 0.6
#: Where each motor sits: right or left, front or rear; and where its loss spins the body.
MOTOR_POSITIONS = {1: (1.0, -1.0, -1.0), 2: (-1.0, 1.0, -1.0), 3: (-1.0, -1.0, 1.0), 4: (1.0, 1.0, 1.0)}
PUSHER = 5


class MotorFailure(NamedTuple):
    """Shares of lift and drive left, the spin, and the lean in roll and pitch."""

    lift: float
    drive: float
    spin: float
    lean: tuple[float, float]


def motor_failure(vehicle_type: VehicleType, dead: set[int]) -> MotorFailure:
    """Say what the dead motors do to a body of a type."""
    if vehicle_type in (VehicleType.COPTER, VehicleType.VTOL):
        return _quad(dead)
    left = 1.0 - len(dead) / AIRFRAMES[vehicle_type].motors
    return MotorFailure(left, left, 0.0, (0.0, 0.0))


def _quad(dead: set[int]) -> MotorFailure:
    corners = [MOTOR_POSITIONS[number] for number in sorted(dead) if number in MOTOR_POSITIONS]
    lift = LIFT_LEFT[len(corners)]
    roll, pitch, spin = (sum(corner[axis] for corner in corners) for axis in range(3))
    way = max(-1.0, min(1.0, spin))
    return MotorFailure(lift, 0.0 if PUSHER in dead else 1.0, SPIN * way, (LEAN * roll, LEAN * pitch))
