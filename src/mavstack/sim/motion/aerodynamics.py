"""Wings: lift, drag and side force by the angle of the air, and what the air does to the attitude.

With u, v, w the airspeed along the body's axes, the angle of attack is atan2(w, u). Up to the stall the
lift coefficient is linear in it; beyond, it goes over to that of a flat plate, sin(2 alpha), and the drag
gains 1.2 sin(alpha)^2. A slipping body is pushed back sideways and turned into the wind. Surfaces have the
authority of the dynamic pressure: below the stall the nose falls into the airflow, whatever is commanded.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mavstack.sim.motion.arrays import Array, bounded
from mavstack.sim.motion.battery import GRAVITY, strength

if TYPE_CHECKING:
    from mavstack.sim.motion.fleet import Fleet

LIFT_AT_ZERO = 0.2
LIFT_SLOPE = 4.6
STALL_ANGLE = 0.24
#: The lift coefficient at the stall, and how far beyond it the flat plate has taken over.
MOST_LIFT = LIFT_AT_ZERO + LIFT_SLOPE * STALL_ANGLE
STALL_WIDTH = 0.12
DRAG_AT_ZERO = 0.04
INDUCED_DRAG = 0.066
PLATE_LIFT, PLATE_DRAG = 1.0, 1.3
SIDE_SLOPE = 0.6
#: How fast the nose follows the air, in 1/s, at full dynamic pressure.
WEATHERCOCK = 2.0
NOSE_DROP = 2.5


def feel(fleet: Fleet) -> None:
    """Add the wing's forces, and set authority and the air's own turning."""
    relative = fleet.velocity - fleet.air
    u, v, w = (_along(relative, axis) for axis in (fleet.forward, fleet.right, fleet.below))
    speed = np.maximum(fleet.airspeed, 0.1)
    plane_speed = np.maximum(np.sqrt(u * u + w * w), 0.05)
    sine, cosine = w / plane_speed, u / plane_speed
    attack = np.arctan2(w, u)
    stalled = bounded((np.abs(attack + 0.05) - STALL_ANGLE) * (1 / STALL_WIDTH), 0.0, 1.0)
    lift_coefficient = (LIFT_AT_ZERO + LIFT_SLOPE * attack) * (1.0 - stalled)
    lift_coefficient += (2.0 * PLATE_LIFT) * sine * cosine * stalled
    drag_coefficient = (
        DRAG_AT_ZERO + INDUCED_DRAG * lift_coefficient * lift_coefficient + PLATE_DRAG * stalled * sine * sine
    )
    pressure = fleet.wing * plane_speed * plane_speed
    lift, drag = pressure * lift_coefficient, pressure * drag_coefficient
    side = -fleet.wing * speed * SIDE_SLOPE * v
    along = lift * sine - drag * cosine
    down = -lift * cosine - drag * sine
    wing = fleet.forward * along + fleet.right * side + fleet.below * down
    fleet.wing_up[:] = -wing[2]
    fleet.force += wing
    _turn(fleet, attack, stalled, v / speed)


def _along(vector: Array, axis: Array) -> Array:
    return np.asarray(vector[0] * axis[0] + vector[1] * axis[1] + vector[2] * axis[2])


def _turn(fleet: Fleet, attack: Array, stalled: Array, slip: Array) -> None:
    """Set the authority of the surfaces and what the air turns by itself."""
    stall_pressure = GRAVITY / (fleet.wing * MOST_LIFT)
    flow = np.minimum(fleet.airspeed * fleet.airspeed / stall_pressure, 1.0)
    authority = flow * (1.0 - 0.8 * stalled)
    fleet.authority[:] = authority
    trim = (GRAVITY / np.maximum(fleet.wing * 324.0, 1e-3) - LIFT_AT_ZERO) * (1 / LIFT_SLOPE)
    fleet.push[0] = 0.0
    fleet.push[1] = (1.0 - authority) * NOSE_DROP * (trim - attack) * flow
    # wheels hold it on its way against the wind
    fleet.push[2] = WEATHERCOCK * slip * flow * (fleet.on_ground == 0.0)


def drive(fleet: Fleet, wanted: Array) -> None:
    """Spin the driving motor towards the share wanted, and let it pull."""
    aim = bounded(wanted, 0.0, 1.0) * strength(fleet) * fleet.drive_left
    fleet.drive_thrust += (aim - fleet.drive_thrust) * fleet.drive_response
    fade = bounded(1.0 - fleet.airspeed / fleet.drive_speed, 0.0, 1.0)
    fleet.force += fleet.forward * (fleet.drive * fade * fleet.drive_thrust)
