"""What the sensors say, before any estimator: IMUs, pressure, receiver of satellites, rangefinder, vibration.

There are as many of a kind as there are messages for it: the second and the third inertial unit see the same
as the first, with a bias of their own.
"""

from __future__ import annotations

from math import atan2, hypot, isfinite, nan
from typing import TYPE_CHECKING

from mavstack.dialects import ardupilotmega, common
from mavstack.sim.telemetry.motion_messages import pressure_altitude
from mavstack.sim.telemetry.scaling import (
    UINT16_MAX,
    centidegrees,
    degrees_e7,
    int16,
    int32,
    uint16,
    uint32,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.dialects import Message
    from mavstack.sim.motion import SensorReadings
    from mavstack.sim.telemetry.view import View

#: m/s2 to thousandths of the standard gravity, rad/s to mrad/s, gauss to milligauss.
_MILLI_G, _MILLI = 1000.0 / 9.80665, 1000.0
#: What the rangefinder can measure, in centimetres.
_NEAREST, _FARTHEST = 5, 5000
#: A receiver's dilution of precision for each metre of its error.
_DILUTION = 0.78
_ALL_FIELDS = 0x1FFF
_WITHOUT_AIR = _ALL_FIELDS & ~int(common.HighresImuUpdatedFlags.DIFF_PRESSURE)
_LEAST_COURSE_SPEED = 0.1
_FIX_3D = 3
_DOWNWARD = common.MavSensorOrientation.PITCH_270
#: Shakes in m/s2: at rest, and per unit of throttle.
_STILL, _SHAKEN = 0.005, 12.0

_Nine = tuple[int, int, int, int, int, int, int, int, int]


class SensorMessages:
    """Producers of messages about what the sensors read."""

    def __init__(self, view: View) -> None:
        self._view = view
        self._body = view.body

    # Inertial units

    def raw_imu(self, now: float) -> Message:
        """RAW_IMU, in the units of SCALED_IMU as ArduPilot sends it."""
        felt = self._view.sensors
        return common.RawImu(
            self._view.microseconds(now), *_nine(felt, 0.0), id=0, temperature=int16(felt.temperature * 100.0)
        )

    def scaled_imu(self, number: int) -> Callable[[float], Message]:
        """The producer of SCALED_IMU (1), SCALED_IMU2 (2) or SCALED_IMU3 (3)."""
        kind = (common.ScaledImu, common.ScaledImu2, common.ScaledImu3)[number - 1]
        bias = 0.002 * (number - 1)

        def produce(now: float) -> Message:
            felt = self._view.sensors
            return kind(
                self._view.milliseconds(now), *_nine(felt, bias), temperature=int16(felt.temperature * 100.0)
            )

        return produce

    def highres_imu(self, now: float) -> Message:
        """HIGHRES_IMU."""
        felt = self._view.sensors
        return common.HighresImu(
            self._view.microseconds(now),
            felt.acceleration_x,
            felt.acceleration_y,
            felt.acceleration_z,
            felt.gyro_x,
            felt.gyro_y,
            felt.gyro_z,
            felt.magnetic_x,
            felt.magnetic_y,
            felt.magnetic_z,
            felt.pressure,
            felt.differential_pressure,
            pressure_altitude(felt.pressure),
            felt.temperature,
            _ALL_FIELDS if self._view.winged else _WITHOUT_AIR,
        )

    def vibration(self, now: float) -> Message:
        """VIBRATION."""
        level = _STILL + (_SHAKEN * abs(self._body.throttle) if self._view.autopilot.armed else 0.0)
        return common.Vibration(self._view.microseconds(now), level, level, level * 1.3)

    # Pressure

    def pressure(self, now: float) -> Message:
        """SCALED_PRESSURE."""
        felt = self._view.sensors
        return common.ScaledPressure(
            self._view.milliseconds(now),
            felt.pressure,
            felt.differential_pressure,
            int16(felt.temperature * 100.0),
        )

    def second_pressure(self, now: float) -> Message:
        """SCALED_PRESSURE2: the other barometer."""
        felt = self._view.sensors
        return common.ScaledPressure2(
            self._view.milliseconds(now), felt.pressure + 0.02, 0.0, int16(felt.temperature * 100.0)
        )

    # Satellites

    def gps_raw(self, now: float) -> Message:
        """GPS_RAW_INT, with the time since boot."""
        return self._gps_raw(self._view.microseconds(now))

    def gps_raw_with_date(self, now: float) -> Message:
        """GPS_RAW_INT, with the receiver's own time: Unix time, once it has any fix."""
        has_time = self._view.sensors.gps_fix >= _FIX_3D
        return self._gps_raw(round(now * 1e6) if has_time else self._view.microseconds(now))

    def _gps_raw(self, time_usec: int) -> Message:
        felt = self._view.sensors
        if not self._view.autopilot.booted:  # who waits for a fix before it arms must not be refused then
            return common.GpsRawInt(
                time_usec,
                common.GpsFixType.NO_FIX,
                eph=UINT16_MAX,
                epv=UINT16_MAX,
                vel=UINT16_MAX,
                cog=UINT16_MAX,
            )
        fixed = felt.gps_fix >= _FIX_3D
        speed = hypot(felt.gps_velocity_north, felt.gps_velocity_east)
        altitude = int32(felt.gps_altitude * 1e3)
        return common.GpsRawInt(
            time_usec=time_usec,
            fix_type=felt.gps_fix,
            lat=degrees_e7(felt.gps_latitude),
            lon=degrees_e7(felt.gps_longitude),
            alt=altitude,
            eph=uint16(felt.gps_eph * _DILUTION * 100.0) if fixed else UINT16_MAX,
            epv=uint16(felt.gps_epv * _DILUTION * 100.0) if fixed else UINT16_MAX,
            vel=uint16(speed * 100.0) if fixed else UINT16_MAX,
            cog=_course(felt) if fixed and speed > _LEAST_COURSE_SPEED else 0 if fixed else UINT16_MAX,
            satellites_visible=min(max(felt.gps_satellites, 0), 254),
            alt_ellipsoid=altitude,
            h_acc=uint32(felt.gps_eph * 1e3) if fixed else 0,
            v_acc=uint32(felt.gps_epv * 1e3) if fixed else 0,
            vel_acc=400 if fixed else 0,
        )

    # Distance

    def distance_sensor(self, now: float) -> Message:
        """DISTANCE_SENSOR, looking down; what is too far reads as just beyond its range."""
        distance = self._distance()
        return common.DistanceSensor(
            time_boot_ms=self._view.milliseconds(now),
            min_distance=_NEAREST,
            max_distance=_FARTHEST,
            current_distance=uint16(distance * 100.0, _FARTHEST + 1),
            type=common.MavDistanceSensor.LASER,
            orientation=_DOWNWARD,
            signal_quality=100 if isfinite(distance) else 1,
        )

    def rangefinder(self, now: float) -> Message:
        """RANGEFINDER: metres, and the voltage of a sensor that says them by one."""
        distance = self._distance()
        if not isfinite(distance):
            distance = _FARTHEST / 100.0 + 0.01
        return ardupilotmega.Rangefinder(distance=distance, voltage=distance * 0.1)

    def _distance(self) -> float:
        """What the rangefinder says: on the ground, the least that it can."""
        return _NEAREST / 100.0 if self._view.body.on_ground else self._view.sensors.distance

    def has_rangefinder(self) -> bool:
        """Whether ArduPilot's parameters say that there is one."""
        return self._view.parameter("RNGFND1_TYPE", 0) > 0

    def distance_sensor_if_fitted(self, now: float) -> Message | None:
        """DISTANCE_SENSOR, if the parameters say that there is one."""
        return self.distance_sensor(now) if self.has_rangefinder() else None

    def rangefinder_if_fitted(self, now: float) -> Message | None:
        """RANGEFINDER, if the parameters say that there is one."""
        return self.rangefinder(now) if self.has_rangefinder() else None

    def airspeed(self, now: float) -> Message:
        """AIRSPEED, with the pressure that it follows from."""
        felt = self._view.sensors
        return common.Airspeed(
            0, self._body.airspeed, int16(felt.temperature * 100.0), felt.differential_pressure, 0
        )

    def water_depth(self, now: float) -> Message:
        """WATER_DEPTH: a boat's echo sounder, over a bottom that is nowhere in reach."""
        own, place = self._body.estimate, self._view.place
        return ardupilotmega.WaterDepth(
            time_boot_ms=self._view.milliseconds(now),
            healthy=1,
            lat=degrees_e7(place.latitude),
            lng=degrees_e7(place.longitude),
            alt=place.altitude,
            roll=own.roll,
            pitch=own.pitch,
            yaw=own.yaw,
            distance=_FARTHEST / 100.0,
            temperature=nan,
        )


def _nine(felt: SensorReadings, bias: float) -> _Nine:
    """Acceleration, rates and magnetic field as the IMU messages have them."""
    return (
        int16(felt.acceleration_x * _MILLI_G),
        int16(felt.acceleration_y * _MILLI_G),
        int16(felt.acceleration_z * _MILLI_G),
        int16((felt.gyro_x + bias) * _MILLI),
        int16((felt.gyro_y - bias) * _MILLI),
        int16((felt.gyro_z + bias) * _MILLI),
        int16(felt.magnetic_x * _MILLI),
        int16(felt.magnetic_y * _MILLI),
        int16(felt.magnetic_z * _MILLI),
    )


def _course(felt: SensorReadings) -> int:
    return centidegrees(atan2(felt.gps_velocity_east, felt.gps_velocity_north))
