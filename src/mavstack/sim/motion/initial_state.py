"""Initial column of a body: at rest at its home, battery full, no faults."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from mavstack.sim.motion.battery import AMBIENT, CELL_VOLTAGE
from mavstack.sim.motion.estimate import BARO_DEVIATION, DRIFT_BIAS, GPS_DEVIATION
from mavstack.sim.motion.state import StateArray

if TYPE_CHECKING:
    from mavstack.sim.motion.airframes import Airframe
    from mavstack.sim.motion.arrays import Array
    from mavstack.sim.vehicle_types import Home

#: Fields of an airframe that are copied to the rows with the same names.
_COPIED_NAMES = """
    speed climb sink tilt turn_rate loiter_radius airspeed_cruise airspeed_min airspeed_max cells
    capacity drag_linear drag_quadratic lift drive drive_speed wing position_gain velocity_gain
    integral_gain heave_gain attitude_gain angular_acceleration floor ceiling friction rest_pitch
    power_idle power_lift power_drive resistance
    """
COPIED = tuple(_COPIED_NAMES.split())


def initial_column(airframe: Airframe, home: Home, slow_noise: Array, step: float, phase: int) -> Array:
    """Return all numbers of a new body."""
    one = StateArray(np.zeros((StateArray.ROW_COUNT, 1)))
    for name in COPIED:
        one.data[StateArray.ROWS[name][0]] = getattr(airframe, name)
    one.acceleration_limit[:] = airframe.acceleration
    one.rate_limit[:, 0] = airframe.roll_rate, airframe.pitch_rate, airframe.yaw_rate
    for response, lag in (
        (one.lift_response, airframe.lift_lag),
        (one.drive_response, airframe.drive_lag),
        (one.rate_response, airframe.rate_lag),
    ):
        response[:] = -math.expm1(-step / lag)
    one.speeds[:, 0] = airframe.speed, airframe.climb, airframe.sink, airframe.airspeed_cruise
    one.lift_left[:] = one.drive_left[:] = one.remaining[:] = one.authority[:] = one.on_ground[:] = 1.0
    one.voltage[:] = CELL_VOLTAGE[-1] * airframe.cells
    one.temperature[:] = AMBIENT
    one.gps_phase[:] = phase
    _initialize_estimate(one, home, slow_noise)
    return one.data[:, 0]


def _initialize_estimate(one: StateArray, home: Home, slow_noise: Array) -> None:
    """Set attitude and estimate, and the direction in which dead reckoning will drift."""
    one.slow_noise[:, 0] = slow_noise
    yaw = math.remainder(math.radians(home.heading), math.tau)
    one.attitude[2] = one.attitude_estimate[2] = one.yaw_demand[:] = yaw
    one.position_error[:2, 0] = GPS_DEVIATION * slow_noise[3:5]
    one.position_error[2] = BARO_DEVIATION * slow_noise[12]
    one.position_estimate[:] = one.position_error
    one.gps[:3] = one.gps_pending[:3] = one.position_error
    direction = math.atan2(slow_noise[3], slow_noise[4])
    one.drift_bias[:2, 0] = DRIFT_BIAS * math.cos(direction), DRIFT_BIAS * math.sin(direction)
