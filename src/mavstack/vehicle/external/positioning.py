"""Positions of receivers outside the autopilot, and the origin of its local frame: methods of `External`."""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.vehicle.external.times import microseconds
from mavstack.vehicle.firmware import firmware_of

if TYPE_CHECKING:
    from mavstack.dialects import Message
    from mavstack.rotation import Vector
    from mavstack.vehicle.external.external import External

_IGNORE = common.GpsInputIgnoreFlags
_CENTI: Final = 100.0


def set_origin(external: External, latitude: float, longitude: float, altitude: float = 0.0) -> None:
    """Tell the estimator where its local frame begins (SET_GPS_GLOBAL_ORIGIN), as it needs without GPS.

    Args:
        latitude: Degrees.
        longitude: Degrees.
        altitude: Metres above mean sea level.

    Raises:
        InvalidArgumentError: The place is not on Earth.
        InvalidStateError: The connection is closed.
    """
    _check_place(latitude, longitude, altitude)
    external.vehicle.component.send(
        common.SetGpsGlobalOrigin(
            latitude=round(latitude * 1e7),
            longitude=round(longitude * 1e7),
            altitude=round(altitude * 1e3),
            time_usec=microseconds(external.vehicle, None),
        )
    )


def gps(
    external: External,
    latitude: float,
    longitude: float,
    altitude: float,
    *,
    velocity: Vector | None = None,
    fix: int = 3,
    satellites: int = 12,
    accuracy: tuple[float, float] = (1.0, 1.5),
    yaw: float | None = None,
    time: float | None = None,
) -> None:
    """Send a position as that of a GPS receiver: GPS_INPUT, or HIL_GPS to PX4.

    Args:
        latitude: Degrees.
        longitude: Degrees.
        altitude: Metres above mean sea level.
        velocity: Metres per second north, east, down; None: not known.
        fix: The GPS_FIX_TYPE.
        satellites: The number of satellites.
        accuracy: The horizontal and the vertical accuracy in metres.
        yaw: The heading of two antennas in degrees; None: not known.
        time: The time of the measurement, Unix seconds; None: now.

    Raises:
        InvalidArgumentError: The place is not on Earth.
        ActionUnsupported: PX4 takes it from components of its own system alone.
        InvalidStateError: The connection is closed.
    """
    _check_place(latitude, longitude, altitude)
    place = round(latitude * 1e7), round(longitude * 1e7)
    moment = microseconds(external.vehicle, time)
    if external.vehicle.autopilot != common.MavAutopilot.PX4:
        external.vehicle.component.send(
            _gps_input(place, altitude, moment, velocity, (fix, satellites, *accuracy), yaw)
        )
        return
    if external.vehicle.connection.address.system != external.vehicle.system:
        reason = f"PX4 takes HIL_GPS from system {external.vehicle.system} alone: connect with its system="
        raise firmware_of(external.vehicle).unsupported("take a position", reason)
    external.vehicle.component.send(_hil_gps(place, altitude, moment, velocity, (fix, satellites, *accuracy)))


def _gps_input(
    place: tuple[int, int],
    altitude: float,
    time_usec: int,
    velocity: Vector | None,
    quality: tuple[int, int, float, float],
    yaw: float | None,
) -> Message:
    fix, satellites, horizontal, vertical = quality
    ignored = int(_IGNORE.HDOP | _IGNORE.VDOP | _IGNORE.SPEED_ACCURACY)
    ignored |= int(_IGNORE.VEL_HORIZ | _IGNORE.VEL_VERT) if velocity is None else 0
    vn, ve, vd = velocity or (0.0, 0.0, 0.0)
    return common.GpsInput(
        time_usec=time_usec,
        ignore_flags=ignored,
        fix_type=fix,
        lat=place[0],
        lon=place[1],
        alt=altitude,
        vn=vn,
        ve=ve,
        vd=vd,
        horiz_accuracy=horizontal,
        vert_accuracy=vertical,
        satellites_visible=satellites,
        yaw=0 if yaw is None else round(yaw % 360 * _CENTI) or 36_000,
    )


def _hil_gps(
    place: tuple[int, int],
    altitude: float,
    time_usec: int,
    velocity: Vector | None,
    quality: tuple[int, int, float, float],
) -> Message:
    fix, satellites, horizontal, vertical = quality
    vn, ve, vd = (round(each * _CENTI) for each in velocity or (0.0, 0.0, 0.0))
    return common.HilGps(
        time_usec=time_usec,
        fix_type=fix,
        lat=place[0],
        lon=place[1],
        alt=round(altitude * 1e3),
        eph=round(horizontal * _CENTI),
        epv=round(vertical * _CENTI),
        vel=65_535,
        vn=vn,
        ve=ve,
        vd=vd,
        cog=65_535,
        satellites_visible=satellites,
    )


def _check_place(latitude: float, longitude: float, altitude: float) -> None:
    if not (abs(latitude) <= 90 and abs(longitude) <= 180 and isfinite(altitude)):
        raise InvalidArgumentError(
            f"a place must be on Earth, in degrees and metres, got {latitude}, {longitude}, {altitude}"
        )
