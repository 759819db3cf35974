"""What the estimator tells: attitude, place, speed, air and what of it can be trusted.

Everything here is the vehicle's belief. Only SIMSTATE and HIL_STATE_QUATERNION tell the truth, as the
firmwares' own simulators do.
"""

from __future__ import annotations

from math import atan2, cos, degrees, hypot, nan, sin
from typing import TYPE_CHECKING

from mavstack.dialects import ardupilotmega, common
from mavstack.sim.telemetry.scaling import (
    centidegrees,
    degrees_e7,
    int16,
    int32,
    percent,
    uint16,
    whole_degrees,
)
from mavstack.sim.telemetry.view import quaternion

if TYPE_CHECKING:
    from mavstack.dialects import Message
    from mavstack.sim.motion import EstimateHealth, Motion
    from mavstack.sim.telemetry.view import View

_EKF = ardupilotmega.EkfStatusFlags
#: Flags that both firmwares have in common, and as plain numbers: they are put together for each message.
_ATTITUDE = int(_EKF.ATTITUDE)
_VELOCITY = int(_EKF.VELOCITY_HORIZ | _EKF.VELOCITY_VERT)
_HEIGHT = int(_EKF.POS_VERT_ABS | _EKF.POS_VERT_AGL)
_PLACE = int(_EKF.POS_HORIZ_REL | _EKF.POS_HORIZ_ABS | _EKF.PRED_POS_HORIZ_REL | _EKF.PRED_POS_HORIZ_ABS)
_NO_PLACE = int(_EKF.CONST_POS_MODE)
_UNINITIALIZED = int(_EKF.UNINITIALIZED)
_GLITCH = int(common.EstimatorStatusFlags.GPS_GLITCH)
#: Below this air speed the air's direction at the vehicle means nothing.
_LEAST_AIRSPEED = 2.0
#: A ratio of 1 is this far from the estimate, in metres and m/s: PX4's usual gates.
_POSITION_GATE, _HEIGHT_GATE, _VELOCITY_GATE = 2.0, 2.0, 1.0
_MILLI_G = 1000.0 / 9.80665
_UNKNOWN_COVARIANCE = (nan,) * 21


class MotionMessages:
    """Producers of messages about how the vehicle moves."""

    def __init__(self, view: View) -> None:
        self._view = view
        self._body = view.body

    # Attitude

    def attitude(self, now: float) -> Message:
        """ATTITUDE."""
        own = self._body.estimate
        return common.Attitude(
            self._view.milliseconds(now),
            own.roll,
            own.pitch,
            own.yaw,
            own.roll_rate,
            own.pitch_rate,
            own.yaw_rate,
        )

    def attitude_quaternion(self, now: float) -> Message:
        """ATTITUDE_QUATERNION."""
        own = self._body.estimate
        rates = (own.roll_rate, own.pitch_rate, own.yaw_rate)
        w, x, y, z = quaternion(own.roll, own.pitch, own.yaw)
        return common.AttitudeQuaternion(self._view.milliseconds(now), w, x, y, z, *rates)

    def simstate(self, now: float) -> Message:
        """SIMSTATE: the truth."""
        true, place = self._body.truth, self._view.true_place
        felt = self._view.sensors
        return ardupilotmega.Simstate(
            true.roll,
            true.pitch,
            true.yaw,
            felt.acceleration_x,
            felt.acceleration_y,
            felt.acceleration_z,
            true.roll_rate,
            true.pitch_rate,
            true.yaw_rate,
            degrees_e7(place.latitude),
            degrees_e7(place.longitude),
        )

    def ground_truth(self, now: float) -> Message:
        """HIL_STATE_QUATERNION: the truth, as PX4's own simulator sends it."""
        true, place, felt = self._body.truth, self._view.true_place, self._view.sensors
        airspeed = uint16(self._body.airspeed * 100.0)
        return common.HilStateQuaternion(
            self._view.microseconds(now),
            quaternion(true.roll, true.pitch, true.yaw),
            true.roll_rate,
            true.pitch_rate,
            true.yaw_rate,
            degrees_e7(place.latitude),
            degrees_e7(place.longitude),
            int32(place.altitude * 1e3),
            int16(true.velocity_north * 100.0),
            int16(true.velocity_east * 100.0),
            int16(true.velocity_down * 100.0),
            airspeed,
            airspeed,
            int16(felt.acceleration_x * _MILLI_G),
            int16(felt.acceleration_y * _MILLI_G),
            int16(felt.acceleration_z * _MILLI_G),
        )

    def ahrs(self, now: float) -> Message:
        """AHRS: how far the estimate was corrected last."""
        health = self._view.health
        return ardupilotmega.Ahrs(
            error_rp=0.003 * (1.0 + health.velocity_variance),
            error_yaw=0.01 * health.compass_variance,
        )

    def ahrs2(self, now: float) -> Message:
        """AHRS2: the estimator that stands by, which keeps no place of its own."""
        own, known = self._body.estimate, self._view.was_positioned
        place = self._view.place
        return ardupilotmega.Ahrs2(
            own.roll,
            own.pitch,
            own.yaw,
            place.altitude,
            degrees_e7(place.latitude) if known else 0,
            degrees_e7(place.longitude) if known else 0,
        )

    # Place and speed

    def global_position(self, now: float) -> Message:
        """GLOBAL_POSITION_INT, as ArduPilot sends it: always, with zeros before the first position."""
        view = self._view
        own, place, known = self._body.estimate, view.place, view.was_positioned
        return common.GlobalPositionInt(
            view.milliseconds(now),
            degrees_e7(place.latitude) if known else 0,
            degrees_e7(place.longitude) if known else 0,
            int32(place.altitude * 1e3),
            int32(view.altitude * 1e3),
            int16(own.velocity_north * 100.0),
            int16(own.velocity_east * 100.0),
            int16(own.velocity_down * 100.0),
            centidegrees(own.yaw),
        )

    def global_position_if_known(self, now: float) -> Message | None:
        """GLOBAL_POSITION_INT, as PX4 sends it: only while the estimate has a global position."""
        return self.global_position(now) if self._view.has_position else None

    def local_position(self, now: float) -> Message:
        """LOCAL_POSITION_NED."""
        own = self._body.estimate
        return common.LocalPositionNed(
            self._view.milliseconds(now),
            own.north,
            own.east,
            own.down,
            own.velocity_north,
            own.velocity_east,
            own.velocity_down,
        )

    def local_position_if_known(self, now: float) -> Message | None:
        """LOCAL_POSITION_NED, only while the estimate has a position."""
        return self.local_position(now) if self._view.has_position else None

    def odometry(self, now: float) -> Message:
        """ODOMETRY: place in the local frame, velocity in the same as PX4 sends it."""
        own, health = self._body.estimate, self._view.health
        return common.Odometry(
            time_usec=self._view.microseconds(now),
            frame_id=common.MavFrame.LOCAL_NED,
            child_frame_id=common.MavFrame.LOCAL_NED,
            x=own.north,
            y=own.east,
            z=own.down,
            q=quaternion(own.roll, own.pitch, own.yaw),
            vx=own.velocity_north,
            vy=own.velocity_east,
            vz=own.velocity_down,
            rollspeed=own.roll_rate,
            pitchspeed=own.pitch_rate,
            yawspeed=own.yaw_rate,
            pose_covariance=_pose_covariance(health),
            velocity_covariance=_diagonal(health.velocity_variance * 0.1, health.velocity_variance * 0.1),
            estimator_type=common.MavEstimatorType.AUTOPILOT,
        )

    def altitude(self, now: float) -> Message:
        """ALTITUDE."""
        view, own = self._view, self._body.estimate
        distance = self._view.sensors.distance
        return common.Altitude(
            view.microseconds(now),
            pressure_altitude(self._view.sensors.pressure),
            view.place.altitude,
            -own.down,
            view.altitude,
            -own.down - distance,
            distance,
        )

    def vfr_hud(self, now: float) -> Message:
        """VFR_HUD of a vehicle that always has some air speed to tell, measured or estimated."""
        return self._vfr_hud(self._body.airspeed)

    def vfr_hud_with_sensor(self, now: float) -> Message:
        """VFR_HUD of a vehicle that knows its air speed only if it has a sensor for it."""
        return self._vfr_hud(self._body.airspeed if self._view.winged else nan)

    def _vfr_hud(self, airspeed: float) -> Message:
        body = self._body
        own = body.estimate
        return common.VfrHud(
            airspeed,
            hypot(own.velocity_north, own.velocity_east),
            whole_degrees(own.yaw),
            percent(abs(body.throttle), 0),
            self._view.place.altitude,
            -own.velocity_down,
        )

    # Air

    def wind(self, now: float) -> Message:
        """WIND: where it comes from, in degrees, and its speed."""
        air = self._body.wind
        return ardupilotmega.Wind(degrees(atan2(-air.east, -air.north)), hypot(air.north, air.east), air.down)

    def wind_covariance(self, now: float) -> Message:
        """WIND_COV: where it goes to, as a vector."""
        air = self._body.wind
        return common.WindCov(
            time_usec=self._view.microseconds(now),
            wind_x=air.north,
            wind_y=air.east,
            var_horiz=0.04,
            wind_alt=self._view.place.altitude if self._view.has_position else nan,
        )

    def angles_of_air(self, now: float) -> Message:
        """AOA_SSA: angle of attack and of side slip, in degrees."""
        attack, slip = _angles_of_air(self._body.estimate, *self._body.wind)
        return ardupilotmega.AoaSsa(self._view.microseconds(now), degrees(attack), degrees(slip))

    # Trust

    def ekf_status(self, now: float) -> Message:
        """EKF_STATUS_REPORT."""
        health = self._view.health
        return ardupilotmega.EkfStatusReport(
            flags=self._flags(health, not self._view.autopilot.booted, _UNINITIALIZED),
            velocity_variance=health.velocity_variance,
            pos_horiz_variance=health.position_variance,
            pos_vert_variance=health.height_variance,
            compass_variance=health.compass_variance,
        )

    def estimator_status(self, now: float) -> Message:
        """ESTIMATOR_STATUS."""
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
        """The flags that both firmwares have in common, and one of their own."""
        flags = special_flag if special else 0
        if health.attitude:
            flags |= _ATTITUDE
        if health.velocity:
            flags |= _VELOCITY
        if health.vertical:
            flags |= _HEIGHT
        return flags | (_PLACE if self._view.has_position else _NO_PLACE)


def pressure_altitude(pressure: float) -> float:
    """The height in metres in the standard atmosphere at so many hPa."""
    return 44_330.77 * (1.0 - (pressure / 1013.25) ** 0.190263) if pressure > 0 else nan


def _pose_covariance(health: EstimateHealth) -> tuple[float, ...]:
    return _diagonal(
        0.04 + health.position_variance,
        0.04 + health.height_variance,
        0.0004,
        0.03 + 0.1 * health.compass_variance,
    )


def _diagonal(horizontal: float, vertical: float, tilt: float = 0.0, yaw: float = 0.0) -> tuple[float, ...]:
    """The upper right half of a matrix 6 x 6, row by row, with nothing off its diagonal."""
    h, v = horizontal, vertical
    first = (h, 0.0, 0.0, 0.0, 0.0, 0.0, h, 0.0, 0.0, 0.0, 0.0, v, 0.0, 0.0, 0.0)
    return (*first, tilt, 0.0, 0.0, tilt, 0.0, yaw)


def _angles_of_air(own: Motion, north: float, east: float, down: float) -> tuple[float, float]:
    """Angle of attack and of side slip from the velocity through the air, in the axes of the body."""
    n, e, d = own.velocity_north - north, own.velocity_east - east, own.velocity_down - down
    sy, cy, sp, cp = sin(own.yaw), cos(own.yaw), sin(own.pitch), cos(own.pitch)
    sr, cr = sin(own.roll), cos(own.roll)
    ahead, aside = cy * n + sy * e, cy * e - sy * n
    forward, below = cp * ahead - sp * d, sp * ahead + cp * d
    right, under = cr * aside + sr * below, cr * below - sr * aside
    if hypot(forward, right, under) < _LEAST_AIRSPEED:
        return 0.0, 0.0
    return atan2(under, forward), atan2(right, hypot(forward, under))
