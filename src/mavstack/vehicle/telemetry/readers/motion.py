"""The readers of position, motion and wind.

Of several messages with the same value, the one that was received last counts. HIGH_LATENCY2 is coarse: its
values count only if the finer message has not been received for a while.
"""

from __future__ import annotations

from math import cos, degrees, hypot, radians, sin
from typing import TYPE_CHECKING, TypeAlias

from mavstack.dialects import ardupilotmega, common
from mavstack.rotation import multiply, rotate, to_euler
from mavstack.vehicle.firmware import firmware_class
from mavstack.vehicle.telemetry.readers.conversions import (
    INT16_MAX,
    INT32_MAX,
    UINT16_MAX,
    finite,
    finite_degrees,
    location,
    scaled,
    vector,
)
from mavstack.vehicle.telemetry.values import Attitude, LocalPosition, Position, Velocity, VfrHud, Wind

if TYPE_CHECKING:
    from mavstack.vehicle.telemetry.telemetry import Telemetry
    from mavstack.vehicle.telemetry.values import Vector

Quaternion: TypeAlias = "tuple[float, float, float, float]"

_MILLI, _CENTI = 1000.0, 100.0
_CIRCLE = 360.0
#: The units of HIGH_LATENCY2: speeds in fifths of m/s, rates in tenths of m/s, angles in steps of 2 degrees.
_FIFTHS, _TENTHS, _DOUBLE = 5.0, 10.0, 2.0
#: The smallest length of a quaternion that is a rotation: a quaternion of zeros means "none".
_MIN_NORM = 0.5


def read_position(telemetry: Telemetry) -> Position | None:
    """Return the position of GLOBAL_POSITION_INT, or HIGH_LATENCY2."""
    match telemetry.finest(common.GlobalPositionInt, common.HighLatency2):
        case common.GlobalPositionInt() as fine:
            coordinates = location(fine.lat, fine.lon)
            if coordinates is None:
                return None
            altitude = scaled(fine.alt, INT32_MAX, _MILLI)
            above_home = scaled(fine.relative_alt, INT32_MAX, _MILLI)
            return Position(*coordinates, altitude, above_home, scaled(fine.hdg, UINT16_MAX, _CENTI))
        case common.HighLatency2() as coarse:
            coordinates = location(coarse.latitude, coarse.longitude)
            heading = coarse.heading * _DOUBLE % _CIRCLE
            return Position(*coordinates, float(coarse.altitude), None, heading) if coordinates else None
    return None


def read_local_position(telemetry: Telemetry) -> LocalPosition | None:
    """Return the position of LOCAL_POSITION_NED, or of an ODOMETRY in the same frame."""
    match telemetry.newest(common.LocalPositionNed, common.Odometry):
        case common.LocalPositionNed(x=x, y=y, z=z):
            found = vector(x, y, z)
        case common.Odometry(frame_id=common.MavFrame.LOCAL_NED, x=x, y=y, z=z):
            found = vector(x, y, z)
        case _:
            found = None
    return LocalPosition(*found) if found else None


def read_velocity(telemetry: Telemetry) -> Velocity | None:
    """Return the velocity of LOCAL_POSITION_NED or GLOBAL_POSITION_INT."""
    found: Vector | None = None
    match telemetry.newest(common.LocalPositionNed, common.GlobalPositionInt):
        case common.LocalPositionNed(vx=x, vy=y, vz=z):
            found = vector(x, y, z)
        case common.GlobalPositionInt(lat=lat, lon=lon, vx=x, vy=y, vz=z):
            if location(lat, lon) and INT16_MAX not in (x, y, z):
                found = x / _CENTI, y / _CENTI, z / _CENTI
    return Velocity(*found) if found else None


def read_attitude(telemetry: Telemetry) -> Attitude | None:
    """Return the attitude of ATTITUDE or ATTITUDE_QUATERNION."""
    match telemetry.newest(common.Attitude, common.AttitudeQuaternion):
        case common.Attitude() as message:
            angles = vector(message.roll, message.pitch, message.yaw)
            rates = message.rollspeed, message.pitchspeed, message.yawspeed
        case common.AttitudeQuaternion() as message:
            turned, rates = _for_display(message)
            angles = euler(turned)
        case _:
            return None
    return Attitude(*map(degrees, angles), *map(finite_degrees, rates)) if angles else None


def read_vfr_hud(telemetry: Telemetry) -> VfrHud | None:
    """Return the speeds and the throttle of VFR_HUD, or HIGH_LATENCY2."""
    match telemetry.finest(common.VfrHud, common.HighLatency2):
        case common.VfrHud() as fine:
            throttle = scaled(fine.throttle, UINT16_MAX, 1.0)
            return VfrHud(finite(fine.airspeed), finite(fine.groundspeed), finite(fine.climb), throttle)
        case common.HighLatency2() as coarse:
            return VfrHud(
                coarse.airspeed / _FIFTHS,
                coarse.groundspeed / _FIFTHS,
                coarse.climb_rate / _TENTHS,
                float(coarse.throttle),
            )
    return None


def read_wind(telemetry: Telemetry) -> Wind | None:
    """Return the wind of WIND_COV, WIND, or HIGH_LATENCY2.

    WIND holds the direction from which the wind blows; in HIGH_LATENCY2 that depends on the firmware.
    """
    match telemetry.finest(common.WindCov, ardupilotmega.Wind, common.HighLatency2):
        case common.WindCov() as towards:
            if finite(towards.wind_x) is None or finite(towards.wind_y) is None:
                return None
            return Wind(towards.wind_x, towards.wind_y, finite(towards.wind_z))
        case ardupilotmega.Wind() as origin:
            return _wind(origin.speed, origin.direction + _CIRCLE / 2, finite(origin.speed_z))
        case common.HighLatency2() as coarse:
            turn = 0.0 if firmware_class(coarse.autopilot).HIGH_LATENCY_WIND_TO else _CIRCLE / 2
            return _wind(coarse.windspeed / _FIFTHS, coarse.wind_heading * _DOUBLE + turn, None)
    return None


def _wind(speed: float, towards: float, down: float | None) -> Wind | None:
    if finite(speed) is None or finite(towards) is None:
        return None
    direction = radians(towards)
    return Wind(speed * cos(direction), speed * sin(direction), down)


def _for_display(message: common.AttitudeQuaternion) -> tuple[Quaternion, Vector]:
    """Return the attitude and rates rotated by a tail-sitter's offset, so that level flight is level."""
    own = message.q1, message.q2, message.q3, message.q4
    rates = message.rollspeed, message.pitchspeed, message.yawspeed
    w, x, y, z = offset = message.repr_offset_q
    if not hypot(*offset) >= _MIN_NORM:
        return own, rates
    return multiply(own, (w, x, y, z)), rotate((w, x, y, z), rates)


def euler(quaternion: Quaternion) -> Vector | None:
    """Return roll, pitch and yaw of a quaternion in radians; None if it is not a rotation."""
    norm = hypot(*quaternion)
    if finite(norm) is None or norm < _MIN_NORM:
        return None
    w, x, y, z = (part / norm for part in quaternion)
    return to_euler((w, x, y, z))
