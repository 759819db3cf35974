"""The mode and the parameters by which each firmware follows a leader.

ArduPilot (copters, rovers, boats) has the mode FOLLOW and an offset forward, right and down of the leader's
heading. PX4 (multicopters) has Follow Target, with a distance and an angle from the leader's course, and a
height above its own home of at least 8 m. Neither needs setpoints: a position of the leader several times a
second is enough.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, degrees, hypot
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.vehicle.firmware import firmware_of
from mavstack.vehicle.vehicle_type import VehicleType

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from mavstack.vehicle.vehicle import Vehicle

#: The height above home in metres below which PX4 does not follow.
PX4_MIN_HEIGHT: Final = 8.0
#: The distance from the leader in metres below which PX4 does not follow.
PX4_MIN_DISTANCE: Final = 1.0
SURFACE: Final = frozenset({VehicleType.ROVER, VehicleType.BOAT})
#: The value of FOLL_OFS_TYPE for offsets relative to the leader's heading.
_RELATIVE_TO_HEADING: Final = 1.0
#: FOLL_POS_P of rovers and boats, in 1/s. In a turn a place moves unlike the leader, whose velocity
#: the firmware takes: the error is the difference divided by the gain, metres with the default of 0.1. The
#: relay cancels it (see `relay`).
SURFACE_GAIN: Final = 1.0
#: The value of FOLL_ALT_TYPE for altitudes above the sea.
_ABOVE_SEA: Final = 0.0


@dataclass(frozen=True, slots=True)
class Place:
    """The place of a follower, in the frame of the leader's course.

    Attributes:
        forward: Metres ahead of the leader; negative: behind it.
        right: Metres to the right of the leader.
        up: Metres above the leader.
    """

    forward: float
    right: float
    up: float


@dataclass(frozen=True, slots=True)
class FollowSettings:
    """A firmware's mode of following, and the parameters in the order in which they are set."""

    mode: str
    parameters: Mapping[str, float]


def follow_settings(vehicle: Vehicle, place: Place, leader: int, height: float) -> FollowSettings:
    """Return the settings by which a vehicle follows.

    Args:
        vehicle: The follower.
        place: Its place.
        leader: The system id that the leader's messages have.
        height: Metres above the follower's home of its place.

    Raises:
        ActionUnsupported: The firmware or the vehicle type has no such mode.
        InvalidArgumentError: The firmware cannot keep the place.
    """
    found = _FIRMWARES.get(vehicle.autopilot)
    settings = None if found is None else found(vehicle.vehicle_type, place, leader, height)
    if settings is None:
        words = "follow a vehicle by its own mode"
        raise firmware_of(vehicle).unsupported(words, "its firmware has none for this type; use setpoints")
    return settings


def _ardupilot(kind: VehicleType, place: Place, leader: int, height: float) -> FollowSettings | None:
    del height
    if kind is not VehicleType.COPTER and kind not in SURFACE:
        return None
    if hypot(place.forward, place.right, place.up) == 0.0:
        raise InvalidArgumentError("the offset must not be 0: ArduPilot would keep the present place then")
    parameters = {
        "FOLL_ENABLE": 1.0,
        "FOLL_SYSID": float(leader),
        "FOLL_OFS_TYPE": _RELATIVE_TO_HEADING,
        "FOLL_OFS_X": place.forward,
        "FOLL_OFS_Y": place.right,
    }
    if kind in SURFACE:
        parameters["FOLL_POS_P"] = SURFACE_GAIN
    if kind is VehicleType.COPTER:
        parameters |= {"FOLL_OFS_Z": 0.0 - place.up, "FOLL_ALT_TYPE": _ABOVE_SEA}
    return FollowSettings("FOLLOW", MappingProxyType(parameters))


def _px4(kind: VehicleType, place: Place, leader: int, height: float) -> FollowSettings | None:
    del leader
    if kind is not VehicleType.COPTER:
        return None
    distance = hypot(place.forward, place.right)
    if distance < PX4_MIN_DISTANCE or height < PX4_MIN_HEIGHT:
        raise InvalidArgumentError(
            f"PX4 follows at {PX4_MIN_DISTANCE:g} m or more from the leader and {PX4_MIN_HEIGHT:g} m or more "
            f"above its home, got {distance:.1f} m and {height:.1f} m"
        )
    parameters = {
        "FLW_TGT_DST": distance,
        "FLW_TGT_FA": degrees(atan2(place.right, place.forward)),
        "FLW_TGT_HT": height,
        "FLW_TGT_ALT_M": 0.0,
    }
    return FollowSettings("FOLLOW_TARGET", MappingProxyType(parameters))


_FIRMWARES: Final[Mapping[int, Callable[[VehicleType, Place, int, float], FollowSettings | None]]] = (
    MappingProxyType({common.MavAutopilot.ARDUPILOTMEGA: _ardupilot, common.MavAutopilot.PX4: _px4})
)
