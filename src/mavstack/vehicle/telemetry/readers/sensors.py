"""What single sensors say: satellites, inertial unit, radio control, and somebody's odometry."""

from __future__ import annotations

from math import degrees, hypot
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.vehicle.telemetry.readers.conversions import (
    UINT8_MAX,
    UINT16_MAX,
    finite,
    known,
    place,
    scaled,
    vector,
    vector_in_degrees,
)
from mavstack.vehicle.telemetry.values import Gps, Imu, Odometry, Rc

if TYPE_CHECKING:
    from mavstack.vehicle.telemetry.telemetry import Telemetry

_MILLI, _CENTI = 1000.0, 100.0
_CIRCLE = 360.0
_MILLI_G = 9.80665 / 1000.0
_FIX_2D = 2
_MOST_CHANNELS = 18


def read_gps(heard: Telemetry) -> Gps | None:
    """GPS_RAW_INT; its place only while there is a fix."""
    told = heard.latest(common.GpsRawInt)
    if told is None:
        return None
    where = place(told.lat, told.lon) if told.fix_type >= _FIX_2D else None
    latitude, longitude = where or (None, None)
    return Gps(
        fix=told.fix_type,
        satellites=known(told.satellites_visible, UINT8_MAX),
        hdop=scaled(told.eph, UINT16_MAX, _CENTI),
        vdop=scaled(told.epv, UINT16_MAX, _CENTI),
        latitude=latitude,
        longitude=longitude,
        altitude=told.alt / _MILLI if where else None,
        ground_speed=scaled(told.vel, UINT16_MAX, _CENTI),
        course=scaled(told.cog, UINT16_MAX, _CENTI),
        heading=_two_antennas(told.yaw),
        horizontal_accuracy=scaled(told.h_acc, 0, _MILLI),
        vertical_accuracy=scaled(told.v_acc, 0, _MILLI),
    )


def _two_antennas(yaw: int) -> float | None:
    """0 is a receiver that cannot tell, UINT16_MAX one that cannot tell now; north is 36000."""
    return None if yaw in (0, UINT16_MAX) else yaw / _CENTI % _CIRCLE


def read_imu(heard: Telemetry) -> Imu | None:
    """HIGHRES_IMU or SCALED_IMU, or RAW_IMU, whose units ArduPilot makes those of SCALED_IMU."""
    match heard.newest(common.HighresImu, common.ScaledImu):
        case common.HighresImu() as fine:
            return _highres(fine)
        case common.ScaledImu() as scaled_imu:
            return _of_integers(scaled_imu)
    raw = heard.latest(common.RawImu)
    ardupilot = heard.autopilot == common.MavAutopilot.ARDUPILOTMEGA
    return _of_integers(raw) if raw is not None and ardupilot else None


def _highres(told: common.HighresImu) -> Imu | None:
    acceleration = vector(told.xacc, told.yacc, told.zacc)
    rotation = vector_in_degrees(told.xgyro, told.ygyro, told.zgyro)
    if acceleration is None or rotation is None:
        return None
    return Imu(acceleration, rotation, vector(told.xmag, told.ymag, told.zmag), finite(told.temperature))


def _of_integers(told: common.ScaledImu | common.RawImu) -> Imu:
    return Imu(
        (told.xacc * _MILLI_G, told.yacc * _MILLI_G, told.zacc * _MILLI_G),
        (degrees(told.xgyro / _MILLI), degrees(told.ygyro / _MILLI), degrees(told.zgyro / _MILLI)),
        (told.xmag / _MILLI, told.ymag / _MILLI, told.zmag / _MILLI),
        scaled(told.temperature, 0, _CENTI),
    )


def read_rc(heard: Telemetry) -> Rc | None:
    """RC_CHANNELS; a pulse of no length, as ArduPilot has without a receiver, is none."""
    told = heard.latest(common.RcChannels)
    if told is None:
        return None
    count = min(told.chancount, _MOST_CHANNELS)
    pulses = (int(getattr(told, f"chan{number}_raw")) for number in range(1, count + 1))
    channels = tuple(None if pulse in (0, UINT16_MAX) else pulse for pulse in pulses)
    return Rc(channels, known(told.rssi, UINT8_MAX))


def read_odometry(heard: Telemetry) -> Odometry | None:
    """ODOMETRY."""
    told = heard.latest(common.Odometry)
    if told is None:
        return None
    w, x, y, z = told.q
    length = hypot(w, x, y, z)
    return Odometry(
        frame=told.frame_id,
        child_frame=told.child_frame_id,
        position=vector(told.x, told.y, told.z),
        quaternion=(w, x, y, z) if finite(length) else None,
        velocity=vector(told.vx, told.vy, told.vz),
        rotation=vector_in_degrees(told.rollspeed, told.pitchspeed, told.yawspeed),
        quality=scaled(told.quality, 0, 1.0),
        resets=told.reset_counter,
    )
