"""Effect of failed motors on a body.

A quad without one motor can no longer balance its yaw: it must nearly stop the opposite motor too, spins the
way the surplus pair turns it, leans to the failed corner and comes down. With two failed motors almost no
lift is left.
"""

from __future__ import annotations

from typing import NamedTuple

from mavstack.sim.motion.airframes import AIRFRAMES
from mavstack.sim.vehicle_types import VehicleType

#: Share of the full lift that remains, by the number of failed motors of a quad.
LIFT_LEFT = (1.0, 0.42, 0.15, 0.0, 0.0)
#: Spin rate and lean rate in rad/s of a quad with one failed motor.
SPIN, LEAN = 8.0, 0.6
#: By motor: the direction of roll and of pitch towards its corner, and the direction in which its failure
#: spins the body.
MOTOR_POSITIONS = {1: (1.0, -1.0, -1.0), 2: (-1.0, 1.0, -1.0), 3: (-1.0, -1.0, 1.0), 4: (1.0, 1.0, 1.0)}
PUSHER = 5


class MotorFailure(NamedTuple):
    """Shares of lift and drive left, the spin rate, and the lean rates in roll and pitch."""

    lift: float
    drive: float
    spin: float
    lean: tuple[float, float]


def motor_failure(vehicle_type: VehicleType, failed: set[int]) -> MotorFailure:
    """Return the effect of failed motors on a vehicle type."""
    if vehicle_type in (VehicleType.COPTER, VehicleType.VTOL):
        return _quad(failed)
    left = 1.0 - len(failed) / AIRFRAMES[vehicle_type].motors
    return MotorFailure(left, left, 0.0, (0.0, 0.0))


def _quad(failed: set[int]) -> MotorFailure:
    corners = [MOTOR_POSITIONS[number] for number in sorted(failed) if number in MOTOR_POSITIONS]
    lift = LIFT_LEFT[len(corners)]
    roll, pitch, spin = (sum(corner[axis] for corner in corners) for axis in range(3))
    direction = max(-1.0, min(1.0, spin))
    return MotorFailure(lift, 0.0 if PUSHER in failed else 1.0, SPIN * direction, (LEAN * roll, LEAN * pitch))
