"""Attitude, altitude and measurements of the sensors."""

from __future__ import annotations

from mavstack.msp.commands import MspCommand
from mavstack.msp.messages.codecs import Number
from mavstack.msp.messages.fields import i16, i32, items_of, u8, u16, u32
from mavstack.msp.messages.layout import BETAFLIGHT_ONLY, INAV_ONLY, TableMessage, reply, request


@reply(MspCommand.MSP_ATTITUDE)
class Attitude(TableMessage):
    """Attitude of the vehicle: positive are roll right, nose down, and heading clockwise from north."""

    roll: float = i16(10, "deg")
    pitch: float = i16(10, "deg")
    heading: int = i16(unit="deg")


@reply(MspCommand.MSP_ATTITUDE_QUATERNION, BETAFLIGHT_ONLY, since="1.47")
class AttitudeQuaternion(TableMessage):
    """Attitude of the vehicle as a quaternion."""

    w: float = i16(0x7FFF)
    x: float = i16(0x7FFF)
    y: float = i16(0x7FFF)
    z: float = i16(0x7FFF)


@reply(MspCommand.MSP_ALTITUDE)
class Altitude(TableMessage):
    """Estimated altitude above the place of arming, and vertical speed, up positive."""

    altitude: float = i32(100, "m")
    climb_rate: float = i16(100, "m/s")
    baro_altitude: float | None = i32(100, "m", variant="INAV", default=None)


@reply(MspCommand.MSP_SONAR_ALTITUDE)
class SonarAltitude(TableMessage):
    """Distance to the ground that the rangefinder measures; negative without a measurement."""

    distance: float = i32(100, "m")


@reply(MspCommand.MSP_RAW_IMU)
class RawImu(TableMessage):
    """Accelerations, rates and magnetic field, each along x, y and z of the body.

    Betaflight sends accelerations and the magnetic field in counts of its sensors; iNav's 512 counts are 1 g.
    """

    accelerations: tuple[int, ...] = items_of(Number("i16"), count=3)
    rates: tuple[int, ...] = items_of(Number("i16"), count=3)
    magnetic_field: tuple[int, ...] = items_of(Number("i16"), count=3)


@reply(MspCommand.MSP2_INAV_AIR_SPEED, INAV_ONLY)
class AirSpeed(TableMessage):
    """Estimated or measured speed through the air."""

    airspeed: float = u32(100, "m/s")


@reply(MspCommand.MSP2_INAV_OPTICAL_FLOW, INAV_ONLY)
class OpticalFlow(TableMessage):
    """Measurements of the optical-flow sensor, in degrees per second."""

    quality: int = u8()
    flow_rate_x: int = i16(unit="deg/s")
    flow_rate_y: int = i16(unit="deg/s")
    body_rate_x: int = i16(unit="deg/s")
    body_rate_y: int = i16(unit="deg/s")


@reply(MspCommand.MSP_ACC_TRIM, BETAFLIGHT_ONLY)
class AccTrim(TableMessage):
    """Angles by which the measured level is corrected."""

    pitch: float = i16(10, "deg")
    roll: float = i16(10, "deg")


@request(MspCommand.MSP_SET_ACC_TRIM, BETAFLIGHT_ONLY)
class SetAccTrim(AccTrim):
    """Set the angles by which the measured level is corrected."""


@reply(MspCommand.MSP_BOARD_ALIGNMENT_CONFIG)
class BoardAlignmentConfig(TableMessage):
    """Orientation of the board in the frame: Betaflight in degrees, iNav in tenths of a degree."""

    roll: int = i16()
    pitch: int = i16()
    yaw: int = i16()


@request(MspCommand.MSP_SET_BOARD_ALIGNMENT_CONFIG)
class SetBoardAlignmentConfig(BoardAlignmentConfig):
    """Set the orientation of the board in the frame: Betaflight in degrees, iNav in tenths of a degree."""


@reply(MspCommand.MSP_SENSOR_CONFIG)
class SensorConfig(TableMessage):
    """Which sensors are chosen, by the numbers of the firmware; 0 means the one that is found, 1 none."""

    accelerometer: int = u8()
    barometer: int = u8()
    magnetometer: int = u8()
    pitot: int | None = u8(variant="INAV", default=None)
    rangefinder: int | None = u8(since="1.46", default=None)
    optical_flow: int | None = u8(since="1.46", default=None)


@request(MspCommand.MSP_SET_SENSOR_CONFIG)
class SetSensorConfig(SensorConfig):
    """Choose the sensors, by the numbers of the firmware; 0 means the one that is found, 1 none."""


@reply(MspCommand.MSP_COMPASS_CONFIG, BETAFLIGHT_ONLY)
class CompassConfig(TableMessage):
    """Magnetic declination, east positive."""

    declination: float = i16(10, "deg")


@request(MspCommand.MSP_SET_COMPASS_CONFIG, BETAFLIGHT_ONLY)
class SetCompassConfig(CompassConfig):
    """Set the magnetic declination, east positive."""


@request(MspCommand.MSP_SET_HEADING)
class SetHeading(TableMessage):
    """Set the heading that the vehicle holds."""

    heading: int = u16(unit="deg")


@request(MspCommand.MSP_ACC_CALIBRATION)
class AccCalibration(TableMessage):
    """Start the calibration of the accelerometer; the vehicle must be level and still."""


@request(MspCommand.MSP_MAG_CALIBRATION)
class MagCalibration(TableMessage):
    """Start the calibration of the magnetometer; the vehicle is turned around all axes for 30 seconds."""
