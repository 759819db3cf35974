"""Where the vehicle is and how it moves.

Of messages that tell the same, the one that was heard last counts. HIGH_LATENCY2 is coarse: what it tells is
taken only when the finer message has not come for a while.
"""

from __future__ import annotations

from math import asin, atan2, cos, degrees, hypot, radians, sin
from typing import TYPE_CHECKING, TypeAlias

from mavstack.dialects import ardupilotmega, common
from mavstack.vehicle.telemetry.readers.conversions import (
    INT16_MAX,
    INT32_MAX,
    UINT16_MAX,
    finite,
    finite_degrees,
    place,
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
#: HIGH_LATENCY2's speeds and rates are so much finer than a m/s, its angles so much coarser than a degree.
_FIFTHS, _TENTHS, _DOUBLE = 5.0, 10.0, 2.0
#: A quaternion much shorter than 1 is not one: zeros stand for "none".
_LEAST_NORM = 0.5


def read_position(heard: Telemetry) -> Position | None:
    """GLOBAL_POSITION_INT, or HIGH_LATENCY2."""
    match heard.finer(common.GlobalPositionInt, common.HighLatency2):
        case common.GlobalPositionInt() as fine:
            where = place(fine.lat, fine.lon)
            if where is None:
                return None
            altitude = scaled(fine.alt, INT32_MAX, _MILLI)
            above_home = scaled(fine.relative_alt, INT32_MAX, _MILLI)
            return Position(*where, altitude, above_home, scaled(fine.hdg, UINT16_MAX, _CENTI))
        case common.HighLatency2() as coarse:
            where = place(coarse.latitude, coarse.longitude)
            heading = coarse.heading * _DOUBLE % _CIRCLE
            return Position(*where, float(coarse.altitude), None, heading) if where else None
    return None


def read_local_position(heard: Telemetry) -> LocalPosition | None:
    """LOCAL_POSITION_NED, or an ODOMETRY in the same frame."""
    match heard.newest(common.LocalPositionNed, common.Odometry):
        case common.LocalPositionNed(x=x, y=y, z=z):
            found = vector(x, y, z)
        case common.Odometry(frame_id=common.MavFrame.LOCAL_NED, x=x, y=y, z=z):
            found = vector(x, y, z)
        case _:
            found = None
    return LocalPosition(*found) if found else None


def read_velocity(heard: Telemetry) -> Velocity | None:
    """LOCAL_POSITION_NED or GLOBAL_POSITION_INT."""
    found: Vector | None = None
    match heard.newest(common.LocalPositionNed, common.GlobalPositionInt):
        case common.LocalPositionNed(vx=x, vy=y, vz=z):
            found = vector(x, y, z)
        case common.GlobalPositionInt(lat=lat, lon=lon, vx=x, vy=y, vz=z):
            if place(lat, lon) and INT16_MAX not in (x, y, z):
                found = x / _CENTI, y / _CENTI, z / _CENTI
    return Velocity(*found) if found else None


def read_attitude(heard: Telemetry) -> Attitude | None:
    """ATTITUDE or ATTITUDE_QUATERNION."""
    match heard.newest(common.Attitude, common.AttitudeQuaternion):
        case common.Attitude() as told:
            angles = vector(told.roll, told.pitch, told.yaw)
            rates = told.rollspeed, told.pitchspeed, told.yawspeed
        case common.AttitudeQuaternion() as told:
            turned, rates = _for_display(told)
            angles = euler(turned)
        case _:
            return None
    return Attitude(*map(degrees, angles), *map(finite_degrees, rates)) if angles else None


def read_vfr_hud(heard: Telemetry) -> VfrHud | None:
    """VFR_HUD, or HIGH_LATENCY2."""
    match heard.finer(common.VfrHud, common.HighLatency2):
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


def read_wind(heard: Telemetry) -> Wind | None:
    """WIND_COV, WIND, or HIGH_LATENCY2: ArduPilot tells where it comes from, PX4 where it goes."""
    match heard.finer(common.WindCov, ardupilotmega.Wind, common.HighLatency2):
        case common.WindCov() as towards:
            if finite(towards.wind_x) is None or finite(towards.wind_y) is None:
                return None
            return Wind(towards.wind_x, towards.wind_y, finite(towards.wind_z))
        case ardupilotmega.Wind() as origin:
            return _wind(origin.speed, origin.direction + _CIRCLE / 2, finite(origin.speed_z))
        case common.HighLatency2() as coarse:
            turn = 0.0 if coarse.autopilot == common.MavAutopilot.PX4 else _CIRCLE / 2
            return _wind(coarse.windspeed / _FIFTHS, coarse.wind_heading * _DOUBLE + turn, None)
    return None


def _wind(speed: float, towards: float, down: float | None) -> Wind | None:
    if finite(speed) is None or finite(towards) is None:
        return None
    direction = radians(towards)
    return Wind(speed * cos(direction), speed * sin(direction), down)


def _for_display(told: common.AttitudeQuaternion) -> tuple[Quaternion, Vector]:
    """Turned by the offset that a tail-sitter sends, so that level flight is level."""
    own = told.q1, told.q2, told.q3, told.q4
    rates = told.rollspeed, told.pitchspeed, told.yawspeed
    w, x, y, z = offset = told.repr_offset_q
    if not hypot(*offset) >= _LEAST_NORM:
        return own, rates
    _, *turned = product(product((w, x, y, z), (0.0, *rates)), (w, -x, -y, -z))
    return product(own, (w, x, y, z)), (turned[0], turned[1], turned[2])


def product(a: Quaternion, b: Quaternion) -> Quaternion:
    """The rotation `b`, then `a`."""
    aw, ax, ay, az = a
    bw, bx, by, bz = b
    return (
        aw * bw - ax * bx - ay * by - az * bz,
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
    )


def euler(quaternion: Quaternion) -> Vector | None:
    """Roll, pitch and yaw of a quaternion of any length but nothing."""
    norm = hypot(*quaternion)
    if finite(norm) is None or norm < _LEAST_NORM:
        return None
    w, x, y, z = (part / norm for part in quaternion)
    roll = atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
    pitch = asin(max(-1.0, min(1.0, 2 * (w * y - z * x))))
    yaw = atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    return roll, pitch, yaw
