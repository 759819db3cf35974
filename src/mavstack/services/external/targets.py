"""Targets that a companion computer sees: the place to land on, and a person or a vehicle to follow.

ArduPilot takes LANDING_TARGET as a position in the axes of the body (BODY_FRD, `position_valid`), or as two
angles and a distance. PX4 takes a position in LOCAL_NED, or the angles. Source: ArduPilot, AC_PrecLand; PX4,
MavlinkReceiver.
"""

from __future__ import annotations

from math import atan2, hypot, isfinite
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from collections.abc import Sequence

_POSITION, _VELOCITY = 1, 2
_ACCELERATION, _ATTITUDE = 4, 8
_NO_ROTATION: Final = (1.0, 0.0, 0.0, 0.0)


def landing_angles(forward: float, right: float, down: float) -> tuple[float, float]:
    """Return `angle_x` and `angle_y` of a target below the vehicle, in radians: right, and backward."""
    return atan2(right, down), atan2(-forward, down)


def landing_message(
    position: Sequence[float],
    time_usec: int,
    *,
    frame: int = common.MavFrame.BODY_FRD,
    angles: tuple[float, float] = (0.0, 0.0),
    number: int = 0,
    size: float = 0.0,
) -> common.LandingTarget:
    """Return LANDING_TARGET with a position.

    Args:
        position: Metres in `frame`.
        time_usec: The time of the measurement in microseconds.
        frame: BODY_FRD or LOCAL_NED.
        angles: `angle_x` and `angle_y` in radians.
        number: The number of the target.
        size: The width of the target in radians, as it is seen.

    Raises:
        InvalidArgumentError: The position is not three finite numbers.
    """
    if len(position) != 3 or not all(isfinite(each) for each in position):
        raise InvalidArgumentError(f"a landing target needs three finite numbers, got {position}")
    x, y, z = position
    return common.LandingTarget(
        time_usec=time_usec,
        target_num=number,
        frame=frame,
        angle_x=angles[0],
        angle_y=angles[1],
        distance=hypot(x, y, z) if frame == common.MavFrame.BODY_FRD else 0.0,
        size_x=size,
        size_y=size,
        x=x,
        y=y,
        z=z,
        q=_NO_ROTATION,
        type=common.LandingTargetType.VISION_FIDUCIAL,
        position_valid=1,
    )


def follow_message(
    latitude: float,
    longitude: float,
    altitude: float,
    timestamp: int,
    *,
    velocity: Sequence[float] | None = None,
    acceleration: Sequence[float] | None = None,
    attitude: Sequence[float] | None = None,
) -> common.FollowTarget:
    """Return FOLLOW_TARGET.

    Args:
        latitude: Degrees.
        longitude: Degrees.
        altitude: Metres above mean sea level.
        timestamp: The time of the measurement in milliseconds; it must advance evenly.
        velocity: Metres per second north, east, down; None: not known.
        acceleration: Metres per second squared north, east, down; None: not known.
        attitude: The quaternion w, x, y, z; None: not known.

    Raises:
        InvalidArgumentError: The position is not on Earth.
    """
    if not (abs(latitude) <= 90 and abs(longitude) <= 180 and isfinite(altitude)):
        raise InvalidArgumentError("the position of a target must be on Earth, in degrees and metres")
    known = _POSITION | (0 if velocity is None else _VELOCITY)
    known |= (0 if acceleration is None else _ACCELERATION) | (0 if attitude is None else _ATTITUDE)
    return common.FollowTarget(
        timestamp=timestamp,
        est_capabilities=known,
        lat=round(latitude * 1e7),
        lon=round(longitude * 1e7),
        alt=altitude,
        vel=tuple(velocity or (0.0, 0.0, 0.0)),
        acc=tuple(acceleration or (0.0, 0.0, 0.0)),
        attitude_q=tuple(attitude or _NO_ROTATION),
    )
