"""Messages of the state estimator: attitude, position, speed, airflow and the health of the estimate.

All values are the vehicle's estimate. Only SIMSTATE and HIL_STATE_QUATERNION contain the true motion, as in
the firmwares' own simulators.
"""

from __future__ import annotations

from math import atan2, cos, degrees, hypot, nan, sin
from typing import TYPE_CHECKING

from mavstack.dialects import ardupilotmega, common
from mavstack.rotation import from_euler
from mavstack.sim.telemetry.scaling import (
    centidegrees,
    degrees_e7,
    int16,
    int32,
    percent,
    uint16,
    whole_degrees,
)

if TYPE_CHECKING:
    from mavstack.dialects import Message
    from mavstack.sim.motion import EstimateHealth, Motion
    from mavstack.sim.telemetry.view import VehicleView

_EKF = ardupilotmega.EkfStatusFlags
#: Estimator flags that both firmwares set; plain integers, because they are combined for each message.
_ATTITUDE = int(_EKF.ATTITUDE)
_VELOCITY = int(_EKF.VELOCITY_HORIZ | _EKF.VELOCITY_VERT)
_HEIGHT = int(_EKF.POS_VERT_ABS | _EKF.POS_VERT_AGL)
_RELATIVE_FLAGS = int(_EKF.POS_HORIZ_REL | _EKF.PRED_POS_HORIZ_REL)
_ABSOLUTE_FLAGS = int(_EKF.POS_HORIZ_ABS | _EKF.PRED_POS_HORIZ_ABS)
_NO_POSITION_FLAG = int(_EKF.CONST_POS_MODE)
_UNINITIALIZED = int(_EKF.UNINITIALIZED)
_GLITCH = int(common.EstimatorStatusFlags.GPS_GLITCH)
#: Airspeed in m/s below which the flow angles are reported as zero.
_MIN_AIRSPEED = 2.0
#: Errors at which a test ratio is 1, in metres and m/s: the defaults of PX4.
_POSITION_GATE, _HEIGHT_GATE, _VELOCITY_GATE = 2.0, 2.0, 1.0
_MILLI_G = 1000.0 / 9.80665
_UNKNOWN_COVARIANCE = (nan,) * 21


class MotionMessages:
    """Producers of messages about the vehicle's motion."""

    def __init__(self, view: VehicleView) -> None:
        self._view = view
        self._body = view.body

    # Attitude

    def attitude(self, now: float) -> Message:
        """Return ATTITUDE."""
        estimate = self._body.estimate
        return common.Attitude(
            self._view.milliseconds(now),
            estimate.roll,
            estimate.pitch,
            estimate.yaw,
            estimate.roll_rate,
            estimate.pitch_rate,
            estimate.yaw_rate,
        )

    def attitude_quaternion(self, now: float) -> Message:
        """Return ATTITUDE_QUATERNION."""
        estimate = self._body.estimate
        rates = (estimate.roll_rate, estimate.pitch_rate, estimate.yaw_rate)
        w, x, y, z = from_euler(estimate.roll, estimate.pitch, estimate.yaw)
        return common.AttitudeQuaternion(self._view.milliseconds(now), w, x, y, z, *rates)

    def simstate(self, now: float) -> Message:
        """Return SIMSTATE: the true motion."""
        true, position = self._body.truth, self._view.true_position
        readings = self._view.sensors
        return ardupilotmega.Simstate(
            true.roll,
            true.pitch,
            true.yaw,
            readings.acceleration_x,
            readings.acceleration_y,
            readings.acceleration_z,
            true.roll_rate,
            true.pitch_rate,
            true.yaw_rate,
            degrees_e7(position.latitude),
            degrees_e7(position.longitude),
        )

    def ground_truth(self, now: float) -> Message:
        """Return HIL_STATE_QUATERNION: the true motion, as PX4's own simulator sends it."""
        true, position, readings = self._body.truth, self._view.true_position, self._view.sensors
        airspeed = uint16(self._body.airspeed * 100.0)
        return common.HilStateQuaternion(
            self._view.microseconds(now),
            from_euler(true.roll, true.pitch, true.yaw),
            true.roll_rate,
            true.pitch_rate,
            true.yaw_rate,
            degrees_e7(position.latitude),
            degrees_e7(position.longitude),
            int32(position.altitude * 1e3),
            int16(true.velocity_north * 100.0),
            int16(true.velocity_east * 100.0),
            int16(true.velocity_down * 100.0),
            airspeed,
            airspeed,
            int16(readings.acceleration_x * _MILLI_G),
            int16(readings.acceleration_y * _MILLI_G),
            int16(readings.acceleration_z * _MILLI_G),
        )

    def ahrs(self, now: float) -> Message:
        """Return AHRS: the last corrections of the estimate."""
        health = self._view.health
        return ardupilotmega.Ahrs(
            error_rp=0.003 * (1.0 + health.velocity_variance), error_yaw=0.01 * health.compass_variance
        )

    def ahrs2(self, now: float) -> Message:
        """Return AHRS2: the secondary estimator, which has no position of its own."""
        estimate, known = self._body.estimate, self._view.was_positioned
        position = self._view.position
        return ardupilotmega.Ahrs2(
            estimate.roll,
            estimate.pitch,
            estimate.yaw,
            position.altitude,
            degrees_e7(position.latitude) if known else 0,
            degrees_e7(position.longitude) if known else 0,
        )

    # Position and speed

    def global_position(self, now: float) -> Message:
        """Return GLOBAL_POSITION_INT as ArduPilot sends it: always, with zeros before the first position."""
        view = self._view
        estimate, position, known = self._body.estimate, view.position, view.was_positioned
        return common.GlobalPositionInt(
            view.milliseconds(now),
            degrees_e7(position.latitude) if known else 0,
            degrees_e7(position.longitude) if known else 0,
            int32(position.altitude * 1e3),
            int32(view.reported_height * 1e3),
            int16(estimate.velocity_north * 100.0),
            int16(estimate.velocity_east * 100.0),
            int16(estimate.velocity_down * 100.0),
            centidegrees(estimate.yaw),
        )

    def global_position_if_known(self, now: float) -> Message | None:
        """Return GLOBAL_POSITION_INT as PX4 sends it: only with a valid global position."""
        return self.global_position(now) if self._view.has_global_position else None

    def local_position(self, now: float) -> Message:
        """Return LOCAL_POSITION_NED."""
        estimate = self._body.estimate
        return common.LocalPositionNed(
            self._view.milliseconds(now),
            estimate.north,
            estimate.east,
            estimate.down,
            estimate.velocity_north,
            estimate.velocity_east,
            estimate.velocity_down,
        )

    def local_position_if_known(self, now: float) -> Message | None:
        """Return LOCAL_POSITION_NED, only while the estimate has a position."""
        return self.local_position(now) if self._view.has_position else None

    def odometry(self, now: float) -> Message:
        """Return ODOMETRY: position and velocity in the local frame, as PX4 sends it."""
        estimate, health = self._body.estimate, self._view.health
        return common.Odometry(
            time_usec=self._view.microseconds(now),
            frame_id=common.MavFrame.LOCAL_NED,
            child_frame_id=common.MavFrame.LOCAL_NED,
            x=estimate.north,
            y=estimate.east,
            z=estimate.down,
            q=from_euler(estimate.roll, estimate.pitch, estimate.yaw),
            vx=estimate.velocity_north,
            vy=estimate.velocity_east,
            vz=estimate.velocity_down,
            rollspeed=estimate.roll_rate,
            pitchspeed=estimate.pitch_rate,
            yawspeed=estimate.yaw_rate,
            pose_covariance=_pose_covariance(health),
            velocity_covariance=_diagonal(health.velocity_variance * 0.1, health.velocity_variance * 0.1),
            estimator_type=common.MavEstimatorType.AUTOPILOT,
        )

    def altitude(self, now: float) -> Message:
        """Return ALTITUDE."""
        view, estimate = self._view, self._body.estimate
        distance = self._view.sensors.distance
        return common.Altitude(
            view.microseconds(now),
            pressure_altitude(self._view.sensors.pressure),
            view.position.altitude,
            -estimate.down,
            view.altitude,
            -estimate.down - distance,
            distance,
        )

    def vfr_hud(self, now: float) -> Message:
        """Return VFR_HUD of a vehicle that always knows its airspeed, measured or estimated."""
        return self._vfr_hud(self._body.airspeed)

    def vfr_hud_with_sensor(self, now: float) -> Message:
        """Return VFR_HUD of a vehicle that knows its airspeed only from a sensor."""
        return self._vfr_hud(self._body.airspeed if self._view.winged else nan)

    def _vfr_hud(self, airspeed: float) -> Message:
        """Return VFR_HUD with an airspeed in m/s."""
        body = self._body
        estimate = body.estimate
        return common.VfrHud(
            airspeed,
            hypot(estimate.velocity_north, estimate.velocity_east),
            whole_degrees(estimate.yaw),
            percent(abs(body.throttle), 0),
            self._view.position.altitude,
            -estimate.velocity_down,
        )

    # Airflow

    def wind(self, now: float) -> Message:
        """Return WIND: the direction of origin in degrees, and the speed."""
        air = self._body.wind
        return ardupilotmega.Wind(degrees(atan2(-air.east, -air.north)), hypot(air.north, air.east), air.down)

    def wind_covariance(self, now: float) -> Message:
        """Return WIND_COV: the velocity of the air as a vector."""
        air = self._body.wind
        return common.WindCov(
            time_usec=self._view.microseconds(now),
            wind_x=air.north,
            wind_y=air.east,
            var_horiz=0.04,
            wind_alt=self._view.position.altitude if self._view.has_position else nan,
        )

    def flow_angles(self, now: float) -> Message:
        """Return AOA_SSA: angle of attack and sideslip angle in degrees."""
        attack, slip = _flow_angles(self._body.estimate, *self._body.wind)
        return ardupilotmega.AoaSsa(self._view.microseconds(now), degrees(attack), degrees(slip))

    # Health of the estimate

    def ekf_status(self, now: float) -> Message:
        """Return EKF_STATUS_REPORT."""
        health = self._view.health
        return ardupilotmega.EkfStatusReport(
            flags=self._flags(health, not self._view.autopilot.booted, _UNINITIALIZED),
            velocity_variance=health.velocity_variance,
            pos_horiz_variance=health.position_variance,
            pos_vert_variance=health.height_variance,
            compass_variance=health.compass_variance,
        )

    def estimator_status(self, now: float) -> Message:
        """Return ESTIMATOR_STATUS."""
        health = self._view.health
        glitch = health.position_variance > 1.0
        return common.EstimatorStatus(
            time_usec=self._view.microseconds(now),
            flags=self._flags(health, glitch, _GLITCH),
            vel_ratio=health.velocity_variance,
            pos_horiz_ratio=health.position_variance,
            pos_vert_ratio=health.height_variance,
            mag_ratio=health.compass_variance,
            hagl_ratio=0.0,
            tas_ratio=0.0 if self._view.winged else nan,
            pos_horiz_accuracy=0.3 + _POSITION_GATE * health.position_variance,
            pos_vert_accuracy=0.2 + _HEIGHT_GATE * health.height_variance,
        )

    def _flags(self, health: EstimateHealth, special: bool, special_flag: int) -> int:
        """Return the flags that both firmwares share, and one of their own."""
        flags = special_flag if special else 0
        if health.attitude:
            flags |= _ATTITUDE
        if health.velocity:
            flags |= _VELOCITY
        if health.vertical:
            flags |= _HEIGHT
        if not self._view.has_position:
            return flags | _NO_POSITION_FLAG
        flags |= _RELATIVE_FLAGS
        return flags | _ABSOLUTE_FLAGS if self._view.has_global_position else flags


def pressure_altitude(pressure: float) -> float:
    """Return the altitude in metres in the standard atmosphere at a pressure in hPa."""
    return 44_330.77 * (1.0 - (pressure / 1013.25) ** 0.190263) if pressure > 0 else nan


def _pose_covariance(health: EstimateHealth) -> tuple[float, ...]:
    """Return the covariance of position and attitude."""
    return _diagonal(
        0.04 + health.position_variance,
        0.04 + health.height_variance,
        0.0004,
        0.03 + 0.1 * health.compass_variance,
    )


def _diagonal(horizontal: float, vertical: float, tilt: float = 0.0, yaw: float = 0.0) -> tuple[float, ...]:
    """Return the upper right triangle of a diagonal 6 x 6 matrix, row by row."""
    h, v = horizontal, vertical
    first = (h, 0.0, 0.0, 0.0, 0.0, 0.0, h, 0.0, 0.0, 0.0, 0.0, v, 0.0, 0.0, 0.0)
    return (*first, tilt, 0.0, 0.0, tilt, 0.0, yaw)


def _flow_angles(estimate: Motion, north: float, east: float, down: float) -> tuple[float, float]:
    """Return angle of attack and sideslip angle in radians, from the airspeed in body axes."""
    n, e, d = estimate.velocity_north - north, estimate.velocity_east - east, estimate.velocity_down - down
    sy, cy, sp, cp = sin(estimate.yaw), cos(estimate.yaw), sin(estimate.pitch), cos(estimate.pitch)
    sr, cr = sin(estimate.roll), cos(estimate.roll)
    ahead, aside = cy * n + sy * e, cy * e - sy * n
    forward, below = cp * ahead - sp * d, sp * ahead + cp * d
    right, under = cr * aside + sr * below, cr * below - sr * aside
    if hypot(forward, right, under) < _MIN_AIRSPEED:
        return 0.0, 0.0
    return atan2(under, forward), atan2(right, hypot(forward, under))
