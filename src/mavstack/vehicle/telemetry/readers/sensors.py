"""The readers of satellite navigation, inertial sensors, radio control and odometry."""

from __future__ import annotations

from math import degrees, hypot
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.vehicle.telemetry.readers.conversions import (
    UINT8_MAX,
    UINT16_MAX,
    finite,
    known,
    location,
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
_MAX_CHANNELS = 18
_PORT_CHANNELS = 8


def read_gps(telemetry: Telemetry) -> Gps | None:
    """Return the state of GPS_RAW_INT; its position only while there is a fix."""
    message = telemetry.latest(common.GpsRawInt)
    if message is None:
        return None
    coordinates = location(message.lat, message.lon) if message.fix_type >= _FIX_2D else None
    latitude, longitude = coordinates or (None, None)
    return Gps(
        fix=message.fix_type,
        satellites=known(message.satellites_visible, UINT8_MAX),
        hdop=scaled(message.eph, UINT16_MAX, _CENTI),
        vdop=scaled(message.epv, UINT16_MAX, _CENTI),
        latitude=latitude,
        longitude=longitude,
        altitude=message.alt / _MILLI if coordinates else None,
        ground_speed=scaled(message.vel, UINT16_MAX, _CENTI),
        course=scaled(message.cog, UINT16_MAX, _CENTI),
        heading=_antenna_heading(message.yaw),
        horizontal_accuracy=scaled(message.h_acc, 0, _MILLI),
        vertical_accuracy=scaled(message.v_acc, 0, _MILLI),
    )


def _antenna_heading(yaw: int) -> float | None:
    """Return the yaw: 0 is a receiver without yaw, UINT16_MAX one without yaw now, 36000 is north."""
    return None if yaw in (0, UINT16_MAX) else yaw / _CENTI % _CIRCLE


def read_imu(telemetry: Telemetry) -> Imu | None:
    """Return the readings of HIGHRES_IMU or SCALED_IMU, or RAW_IMU where its units are known."""
    match telemetry.newest(common.HighresImu, common.ScaledImu):
        case common.HighresImu() as fine:
            return _highres(fine)
        case common.ScaledImu() as scaled_imu:
            return _of_integers(scaled_imu)
    raw = telemetry.latest(common.RawImu)
    return _of_integers(raw) if raw is not None and telemetry.firmware.RAW_IMU_IS_SCALED else None


def _highres(message: common.HighresImu) -> Imu | None:
    acceleration = vector(message.xacc, message.yacc, message.zacc)
    rotation = vector_in_degrees(message.xgyro, message.ygyro, message.zgyro)
    if acceleration is None or rotation is None:
        return None
    return Imu(
        acceleration, rotation, vector(message.xmag, message.ymag, message.zmag), finite(message.temperature)
    )


def _of_integers(message: common.ScaledImu | common.RawImu) -> Imu:
    return Imu(
        (message.xacc * _MILLI_G, message.yacc * _MILLI_G, message.zacc * _MILLI_G),
        (degrees(message.xgyro / _MILLI), degrees(message.ygyro / _MILLI), degrees(message.zgyro / _MILLI)),
        (message.xmag / _MILLI, message.ymag / _MILLI, message.zmag / _MILLI),
        scaled(message.temperature, 0, _CENTI),
    )


def read_rc(telemetry: Telemetry) -> Rc | None:
    """Return the pulses of RC_CHANNELS, or of all ports of RC_CHANNELS_RAW where it is missing."""
    message = telemetry.finest(common.RcChannels, common.RcChannelsRaw)
    if isinstance(message, common.RcChannelsRaw):
        return _read_ports(telemetry)
    if message is None:
        return None
    count = min(message.chancount, _MAX_CHANNELS)
    return Rc(_pulses(message, count), known(message.rssi, UINT8_MAX))


def _read_ports(telemetry: Telemetry) -> Rc:
    ports = telemetry.rc_ports()
    channels: list[int | None] = []
    for port in range(max(ports) + 1):
        message = ports.get(port)
        channels += (None,) * _PORT_CHANNELS if message is None else _pulses(message, _PORT_CHANNELS)
    return Rc(tuple(channels), known(ports[min(ports)].rssi, UINT8_MAX))


def _pulses(message: common.RcChannels | common.RcChannelsRaw, count: int) -> tuple[int | None, ...]:
    """Return the pulses of the first channels; 0, which ArduPilot sends without a receiver, is unused."""
    pulses = (int(getattr(message, f"chan{number}_raw")) for number in range(1, count + 1))
    return tuple(None if pulse in (0, UINT16_MAX) else pulse for pulse in pulses)


def read_odometry(telemetry: Telemetry) -> Odometry | None:
    """Return the estimate of ODOMETRY."""
    message = telemetry.latest(common.Odometry)
    if message is None:
        return None
    w, x, y, z = message.q
    length = hypot(w, x, y, z)
    return Odometry(
        frame=message.frame_id,
        child_frame=message.child_frame_id,
        position=vector(message.x, message.y, message.z),
        quaternion=(w, x, y, z) if finite(length) else None,
        velocity=vector(message.vx, message.vy, message.vz),
        rotation=vector_in_degrees(message.rollspeed, message.pitchspeed, message.yawspeed),
        quality=scaled(message.quality, 0, 1.0),
        resets=message.reset_counter,
    )
