"""Raw sensor messages: IMUs, pressure, GNSS receiver, rangefinder, vibration.

Each message of a sensor kind has its own simulated sensor: the second and third IMU read the same as the
first, with a bias of their own.
"""

from __future__ import annotations

from math import atan2, hypot, isfinite, nan
from typing import TYPE_CHECKING

from mavstack.dialects import ardupilotmega, common
from mavstack.sim.motion.readings import DILUTION
from mavstack.sim.telemetry.motion_messages import pressure_altitude
from mavstack.sim.telemetry.scaling import UINT16_MAX, centidegrees, degrees_e7, int16, int32, uint16, uint32

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.dialects import Message
    from mavstack.sim.motion import SensorReadings
    from mavstack.sim.telemetry.view import VehicleView

#: Factors of m/s2 to milli-g, rad/s to mrad/s and gauss to milligauss.
_MILLI_G, _MILLI = 1000.0 / 9.80665, 1000.0
#: Range of the rangefinder in centimetres.
_MIN_DISTANCE, _MAX_DISTANCE = 5, 5000
_ALL_FIELDS = 0x1FFF
_WITHOUT_AIR = _ALL_FIELDS & ~int(common.HighresImuUpdatedFlags.DIFF_PRESSURE)
_MIN_COURSE_SPEED = 0.1
_FIX_3D = 3
_DOWNWARD = common.MavSensorOrientation.PITCH_270
#: Vibration in m/s2 at rest, and its increase from zero to full throttle.
_VIBRATION_AT_REST, _VIBRATION_PER_THROTTLE = 0.005, 12.0

_ImuFields = tuple[int, int, int, int, int, int, int, int, int]


class SensorMessages:
    """Producers of messages with sensor readings."""

    def __init__(self, view: VehicleView) -> None:
        self._view = view
        self._body = view.body

    # Inertial units

    def raw_imu(self, now: float) -> Message:
        """Return RAW_IMU, in the units of SCALED_IMU as ArduPilot sends it."""
        readings = self._view.sensors
        return common.RawImu(
            self._view.microseconds(now),
            *_imu_fields(readings, 0.0),
            id=0,
            temperature=int16(readings.temperature * 100.0),
        )

    def scaled_imu(self, number: int) -> Callable[[float], Message]:
        """Return the producer of SCALED_IMU (1), SCALED_IMU2 (2) or SCALED_IMU3 (3)."""
        message_type = (common.ScaledImu, common.ScaledImu2, common.ScaledImu3)[number - 1]
        bias = 0.002 * (number - 1)

        def produce(now: float) -> Message:
            readings = self._view.sensors
            return message_type(
                self._view.milliseconds(now),
                *_imu_fields(readings, bias),
                temperature=int16(readings.temperature * 100.0),
            )

        return produce

    def highres_imu(self, now: float) -> Message:
        """Return HIGHRES_IMU."""
        readings = self._view.sensors
        return common.HighresImu(
            self._view.microseconds(now),
            readings.acceleration_x,
            readings.acceleration_y,
            readings.acceleration_z,
            readings.gyro_x,
            readings.gyro_y,
            readings.gyro_z,
            readings.magnetic_x,
            readings.magnetic_y,
            readings.magnetic_z,
            readings.pressure,
            readings.differential_pressure,
            pressure_altitude(readings.pressure),
            readings.temperature,
            _ALL_FIELDS if self._view.winged else _WITHOUT_AIR,
        )

    def vibration(self, now: float) -> Message:
        """Return VIBRATION."""
        level = _VIBRATION_AT_REST + (
            _VIBRATION_PER_THROTTLE * abs(self._body.throttle) if self._view.autopilot.armed else 0.0
        )
        return common.Vibration(self._view.microseconds(now), level, level, level * 1.3)

    # Pressure

    def pressure(self, now: float) -> Message:
        """Return SCALED_PRESSURE."""
        readings = self._view.sensors
        return common.ScaledPressure(
            self._view.milliseconds(now),
            readings.pressure,
            readings.differential_pressure,
            int16(readings.temperature * 100.0),
        )

    def second_pressure(self, now: float) -> Message:
        """Return SCALED_PRESSURE2: the second barometer."""
        readings = self._view.sensors
        return common.ScaledPressure2(
            self._view.milliseconds(now), readings.pressure + 0.02, 0.0, int16(readings.temperature * 100.0)
        )

    # GNSS

    def gps_raw(self, now: float) -> Message:
        """Return GPS_RAW_INT with the time since boot."""
        return self._gps_raw(self._view.microseconds(now))

    def gps_raw_with_date(self, now: float) -> Message:
        """Return GPS_RAW_INT with the receiver's time: Unix time once it has a fix."""
        has_time = self._view.sensors.gps_fix >= _FIX_3D
        return self._gps_raw(round(now * 1e6) if has_time else self._view.microseconds(now))

    def _gps_raw(self, time_usec: int) -> Message:
        """Return GPS_RAW_INT with a timestamp in microseconds."""
        readings = self._view.sensors
        # Report no fix until the autopilot has booted: a client that waits for a fix may then arm at once.
        if not self._view.autopilot.booted:
            return common.GpsRawInt(
                time_usec,
                common.GpsFixType.NO_FIX,
                eph=UINT16_MAX,
                epv=UINT16_MAX,
                vel=UINT16_MAX,
                cog=UINT16_MAX,
            )
        fixed = readings.gps_fix >= _FIX_3D
        speed = hypot(readings.gps_velocity_north, readings.gps_velocity_east)
        altitude = int32(readings.gps_altitude * 1e3)
        return common.GpsRawInt(
            time_usec=time_usec,
            fix_type=readings.gps_fix,
            lat=degrees_e7(readings.gps_latitude),
            lon=degrees_e7(readings.gps_longitude),
            alt=altitude,
            eph=uint16(readings.gps_eph * DILUTION * 100.0) if fixed else UINT16_MAX,
            epv=uint16(readings.gps_epv * DILUTION * 100.0) if fixed else UINT16_MAX,
            vel=uint16(speed * 100.0) if fixed else UINT16_MAX,
            cog=_course(readings) if fixed and speed > _MIN_COURSE_SPEED else 0 if fixed else UINT16_MAX,
            satellites_visible=min(max(readings.gps_satellites, 0), 254),
            alt_ellipsoid=altitude,
            h_acc=uint32(readings.gps_eph * 1e3) if fixed else 0,
            v_acc=uint32(readings.gps_epv * 1e3) if fixed else 0,
            vel_acc=400 if fixed else 0,
        )

    # Distance

    def distance_sensor(self, now: float) -> Message:
        """Return DISTANCE_SENSOR, looking down; a distance out of range reads as just beyond the maximum."""
        distance = self._distance()
        return common.DistanceSensor(
            time_boot_ms=self._view.milliseconds(now),
            min_distance=_MIN_DISTANCE,
            max_distance=_MAX_DISTANCE,
            current_distance=uint16(distance * 100.0, _MAX_DISTANCE + 1),
            type=common.MavDistanceSensor.LASER,
            orientation=_DOWNWARD,
            signal_quality=100 if isfinite(distance) else 1,
        )

    def rangefinder(self, now: float) -> Message:
        """Return RANGEFINDER: metres, and the voltage of an analogue sensor."""
        distance = self._distance()
        if not isfinite(distance):
            distance = _MAX_DISTANCE / 100.0 + 0.01
        return ardupilotmega.Rangefinder(distance=distance, voltage=distance * 0.1)

    def _distance(self) -> float:
        """Return the measured distance in metres; the minimum on the ground."""
        body = self._view.body
        on_ground = body.on_ground and body.range_report is None
        return _MIN_DISTANCE / 100.0 if on_ground else self._view.sensors.distance

    def has_rangefinder(self) -> bool:
        """Return whether ArduPilot's parameters enable a rangefinder."""
        return self._view.parameter("RNGFND1_TYPE", 0) > 0

    def distance_sensor_if_fitted(self, now: float) -> Message | None:
        """Return DISTANCE_SENSOR, if the parameters enable a rangefinder."""
        return self.distance_sensor(now) if self.has_rangefinder() else None

    def rangefinder_if_fitted(self, now: float) -> Message | None:
        """Return RANGEFINDER, if the parameters enable a rangefinder."""
        return self.rangefinder(now) if self.has_rangefinder() else None

    def airspeed(self, now: float) -> Message:
        """Return AIRSPEED, with its differential pressure."""
        readings = self._view.sensors
        return common.Airspeed(
            0, self._body.airspeed, int16(readings.temperature * 100.0), readings.differential_pressure, 0
        )

    def water_depth(self, now: float) -> Message:
        """Return WATER_DEPTH: a boat's echo sounder above a bottom out of range."""
        estimate, position = self._body.estimate, self._view.position
        return ardupilotmega.WaterDepth(
            time_boot_ms=self._view.milliseconds(now),
            healthy=1,
            lat=degrees_e7(position.latitude),
            lng=degrees_e7(position.longitude),
            alt=position.altitude,
            roll=estimate.roll,
            pitch=estimate.pitch,
            yaw=estimate.yaw,
            distance=_MAX_DISTANCE / 100.0,
            temperature=nan,
        )


def _imu_fields(readings: SensorReadings, bias: float) -> _ImuFields:
    """Return acceleration, body rates and magnetic field in the units of the IMU messages."""
    return (
        int16(readings.acceleration_x * _MILLI_G),
        int16(readings.acceleration_y * _MILLI_G),
        int16(readings.acceleration_z * _MILLI_G),
        int16((readings.gyro_x + bias) * _MILLI),
        int16((readings.gyro_y - bias) * _MILLI),
        int16((readings.gyro_z + bias) * _MILLI),
        int16(readings.magnetic_x * _MILLI),
        int16(readings.magnetic_y * _MILLI),
        int16(readings.magnetic_z * _MILLI),
    )


def _course(readings: SensorReadings) -> int:
    """Return the course over ground in hundredths of a degree."""
    return centidegrees(atan2(readings.gps_velocity_east, readings.gps_velocity_north))
