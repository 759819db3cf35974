"""What the autopilot believes: the truth with the errors its sensors leave.

Horizontally the place follows the GPS receiver, its slow wander and whatever it is spoofed to, with a lag;
vertically the barometer and its drift; the heading the compass. Without GPS the error grows as that of dead
reckoning does: an unknown bias of the acceleration integrates into velocity and place, until the estimate
no longer calls its place good. Control flies by this estimate, so what deceives it moves the body.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from mavstack.sim.motion.arrays import wrapped
from mavstack.sim.motion.fleet import Fleet
from mavstack.sim.motion.readings import EstimateHealth

if TYPE_CHECKING:
    from collections.abc import Sequence

#: Time constants in seconds: of the place following the GPS, of the heading following the compass.
PLACE_LAG, HEADING_LAG = 1.5, 2.0
#: Deviations: GPS place horizontal and vertical, velocity, roll and pitch, yaw, barometer.
GPS_DEVIATION, GPS_HEIGHT_DEVIATION, VELOCITY_DEVIATION = 0.35, 0.7, 0.04
TILT_DEVIATION, YAW_DEVIATION, BARO_DEVIATION = 0.003, 0.01, 0.12
#: Seconds of dead reckoning after which velocity, and place, are no longer called good.
VELOCITY_PATIENCE, PLACE_PATIENCE = 10.0, 5.0
#: The errors at which a test ratio is 1: of place, height, velocity and heading.
PLACE_GATE, HEIGHT_GATE, VELOCITY_GATE, HEADING_GATE = 5.0, 10.0, 2.0, 0.5
#: The largest error of the acceleration dead reckoning integrates, in m/s2.
DRIFT_BIAS = 0.05
_DEVIATIONS = np.array([TILT_DEVIATION, TILT_DEVIATION, YAW_DEVIATION])[:, None]


def update(fleet: Fleet, step: float) -> None:
    """Follow the truth and the errors for a step."""
    wander, lost, error = fleet.wander, fleet.gps_lost, fleet.position_error
    drift = fleet.drift_velocity
    good = 1.0 - lost
    drift += step * (fleet.drift_bias * lost - drift * good)
    aim = fleet.spoof + GPS_DEVIATION * wander[3:6]
    aim[2] = fleet.baro_drift + BARO_DEVIATION * wander[12]
    follow = np.minimum(step / PLACE_LAG, 1.0)
    error[:2] += (aim[:2] - error[:2]) * (follow * good) + drift[:2] * lost * step
    error[2] += (aim[2] - error[2]) * follow
    fleet.lost_time[:] = (fleet.lost_time + step) * lost
    fleet.yaw_error += (fleet.compass_turn - fleet.yaw_error) * (step / HEADING_LAG)
    np.add(fleet.position, error, out=fleet.position_estimate)
    np.add(fleet.velocity, drift + VELOCITY_DEVIATION * wander[6:9], out=fleet.velocity_estimate)
    np.add(fleet.attitude, _DEVIATIONS * wander[9:12], out=fleet.attitude_estimate)
    fleet.attitude_estimate[2] = wrapped(fleet.attitude_estimate[2] + fleet.yaw_error)


def receive(fleet: Fleet, tick: int, period: int) -> None:
    """Let GPS receivers whose turn it is report what they measured one period ago."""
    ready = (fleet.gps_phase == tick % period) & (fleet.gps_lost == 0.0)
    if not ready.any():
        return
    np.copyto(fleet.gps, fleet.gps_pending, where=ready)
    fresh = np.empty_like(fleet.gps)
    fresh[:3] = fleet.position + fleet.spoof + GPS_DEVIATION * fleet.wander[3:6]
    fresh[3:] = fleet.velocity + VELOCITY_DEVIATION * fleet.wander[6:9]
    np.copyto(fleet.gps_pending, fresh, where=ready)


_ERROR, _DRIFT = Fleet.ROWS["position_error"][0], Fleet.ROWS["drift_velocity"][0]
_SPOOF, _TURN, _BARO = Fleet.ROWS["spoof"][0], Fleet.ROWS["compass_turn"][0], Fleet.ROWS["baro_drift"][0]
_LOST, _LOST_TIME = Fleet.ROWS["gps_lost"][0], Fleet.ROWS["lost_time"][0]


def health(column: Sequence[float]) -> EstimateHealth:
    """Judge the estimate of one body, of its readable column."""
    lost_time, lost = column[_LOST_TIME], column[_LOST] > 0.0
    missed = math.hypot(column[_SPOOF] - column[_ERROR], column[_SPOOF + 1] - column[_ERROR + 1])
    place = 0.05 + (lost_time / PLACE_PATIENCE if lost else missed / PLACE_GATE)
    drifted = math.hypot(column[_DRIFT], column[_DRIFT + 1])
    velocity = 0.04 + (lost_time / VELOCITY_PATIENCE if lost else drifted / VELOCITY_GATE)
    height = 0.03 + abs(column[_BARO]) / HEIGHT_GATE
    heading = 0.02 + abs(column[_TURN]) / HEADING_GATE
    return EstimateHealth(
        attitude=True,
        heading=heading < 2.0,
        velocity=not lost or lost_time < VELOCITY_PATIENCE,
        horizontal=not lost or lost_time < PLACE_PATIENCE,
        vertical=True,
        velocity_variance=velocity,
        position_variance=place,
        height_variance=height,
        compass_variance=heading,
    )
