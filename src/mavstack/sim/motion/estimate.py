"""State estimate of the autopilot: the true motion plus the errors of its sensors.

Horizontally the estimated position follows the GPS receiver, its slow drift and any spoofed offset, with a
lag; vertically the barometer and its drift; the heading follows the compass. Each of them may be replaced by
an estimate from outside, such as visual odometry. Without GPS and such an estimate the error grows like that
of dead reckoning: an unknown acceleration bias integrates into velocity and position until the estimate no
longer reports its position as good. Control flies by this estimate, so a deceived sensor really moves the
body.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from mavstack.sim.motion.arrays import Array, wrap_angle
from mavstack.sim.motion.readings import EstimateHealth
from mavstack.sim.motion.state import StateArray

if TYPE_CHECKING:
    from collections.abc import Sequence

#: Time constants in seconds with which the position estimate follows the GPS, and the heading the compass.
POSITION_LAG, HEADING_LAG = 1.5, 2.0
#: Time constant in seconds with which the estimate follows an external estimate.
AID_LAG = 0.2
#: Standard deviations: GPS position horizontal and vertical, velocity, roll and pitch, yaw, barometer.
GPS_DEVIATION, GPS_HEIGHT_DEVIATION, VELOCITY_DEVIATION = 0.35, 0.7, 0.04
TILT_DEVIATION, YAW_DEVIATION, BARO_DEVIATION = 0.003, 0.01, 0.12
#: Seconds of dead reckoning after which velocity and position are no longer reported as good.
VELOCITY_TIMEOUT, POSITION_TIMEOUT = 10.0, 5.0
#: Errors of position, height, velocity (m, m/s) and heading (rad) at which the test ratio is 1.
POSITION_GATE, HEIGHT_GATE, VELOCITY_GATE, HEADING_GATE = 5.0, 10.0, 2.0, 0.5
#: Acceleration error in m/s2 that dead reckoning integrates.
DRIFT_BIAS = 0.05
_DEVIATIONS = np.array([TILT_DEVIATION, TILT_DEVIATION, YAW_DEVIATION])[:, None]


def update(state: StateArray, step: float) -> None:
    """Update the estimate for one step."""
    slow_noise, lost, error = state.slow_noise, _without_position(state), state.position_error
    drift = state.drift_velocity
    good = 1.0 - lost
    drift += step * (state.drift_bias * lost - drift * good)
    command = state.spoof + GPS_DEVIATION * (1.0 - state.gps_precision) * slow_noise[3:6]
    command[2] = state.baro_drift + BARO_DEVIATION * slow_noise[12]
    follow, turn = np.minimum(step / POSITION_LAG, 1.0), state.compass_offset
    if state.aid_position.any() or state.aid_height.any() or state.aid_heading.any():
        aided = state.aid_position > 0
        np.copyto(command[:2], state.aid_offset[:2], where=aided)
        np.copyto(command[2], state.aid_offset[2], where=state.aid_height > 0)
        follow = np.where(aided, min(step / AID_LAG, 1.0), follow)
        turn = np.where(state.aid_heading > 0, state.aid_turn, turn)
    error[:2] += (command[:2] - error[:2]) * (follow * good) + drift[:2] * lost * step
    error[2] += (command[2] - error[2]) * follow
    state.gps_lost_time[:] = (state.gps_lost_time + step) * lost
    state.yaw_error += (turn - state.yaw_error) * (step / HEADING_LAG)
    np.add(state.position, error, out=state.position_estimate)
    np.add(state.velocity, drift + VELOCITY_DEVIATION * slow_noise[6:9], out=state.velocity_estimate)
    np.add(state.attitude, _DEVIATIONS * slow_noise[9:12], out=state.attitude_estimate)
    state.attitude_estimate[2] = wrap_angle(state.attitude_estimate[2] + state.yaw_error)


def _without_position(state: StateArray) -> Array:
    """Return 1 for each body whose estimate has neither GPS nor a position from outside, else 0."""
    return np.maximum(state.gps_lost, state.gps_unused) * (1.0 - state.aid_position)


def update_gps(state: StateArray, tick: int, period: int) -> None:
    """Let the GPS receivers that are due report the measurement of one period ago."""
    ready = (state.gps_phase == tick % period) & (state.gps_lost == 0.0)
    if not ready.any():
        return
    np.copyto(state.gps, state.gps_pending, where=ready)
    fresh = np.empty_like(state.gps)
    error = GPS_DEVIATION * (1.0 - state.gps_precision)
    fresh[:3] = state.position + state.spoof + error * state.slow_noise[3:6]
    fresh[3:] = state.velocity + VELOCITY_DEVIATION * state.slow_noise[6:9]
    np.copyto(state.gps_pending, fresh, where=ready)


_ERROR, _DRIFT = StateArray.ROWS["position_error"][0], StateArray.ROWS["drift_velocity"][0]
_SPOOF, _COMPASS, _BARO = (
    StateArray.ROWS["spoof"][0],
    StateArray.ROWS["compass_offset"][0],
    StateArray.ROWS["baro_drift"][0],
)
_LOST, _LOST_TIME = StateArray.ROWS["gps_lost"][0], StateArray.ROWS["gps_lost_time"][0]
_UNUSED, _AIDED, _HEADED = (
    StateArray.ROWS[name][0] for name in ("gps_unused", "aid_position", "aid_heading")
)
_OFFSET, _TURN = StateArray.ROWS["aid_offset"][0], StateArray.ROWS["aid_turn"][0]


def assess(column: Sequence[float]) -> EstimateHealth:
    """Return the health of one body's estimate, given its readable column."""
    aided = column[_AIDED] > 0.0
    gps_lost_time, lost = column[_LOST_TIME], not aided and max(column[_LOST], column[_UNUSED]) > 0.0
    source = _OFFSET if aided else _SPOOF
    missed = math.hypot(column[source] - column[_ERROR], column[source + 1] - column[_ERROR + 1])
    position = 0.05 + (gps_lost_time / POSITION_TIMEOUT if lost else missed / POSITION_GATE)
    drifted = math.hypot(column[_DRIFT], column[_DRIFT + 1])
    velocity = 0.04 + (gps_lost_time / VELOCITY_TIMEOUT if lost else drifted / VELOCITY_GATE)
    height = 0.03 + abs(column[_BARO]) / HEIGHT_GATE
    turned = column[_TURN] if column[_HEADED] > 0.0 else column[_COMPASS]
    heading = 0.02 + abs(turned) / HEADING_GATE
    return EstimateHealth(
        attitude=True,
        heading=heading < 2.0,
        velocity=not lost or gps_lost_time < VELOCITY_TIMEOUT,
        horizontal=not lost or gps_lost_time < POSITION_TIMEOUT,
        vertical=True,
        velocity_variance=velocity,
        position_variance=position,
        height_variance=height,
        compass_variance=heading,
    )
