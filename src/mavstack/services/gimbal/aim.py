"""The direction from a vehicle to a region of interest: a location, or another system."""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, degrees, hypot
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.geodesy import offset

if TYPE_CHECKING:
    from mavstack.services.command import Command
    from mavstack.wire import Packet

_UNKNOWN_HEADING = 0xFFFF
_RELATIVE = frozenset({common.MavFrame.GLOBAL_RELATIVE_ALT, common.MavFrame.GLOBAL_RELATIVE_ALT_INT})
_ABSOLUTE = frozenset({common.MavFrame.GLOBAL, common.MavFrame.GLOBAL_INT})


@dataclass(frozen=True, slots=True)
class VehiclePose:
    """The position of a vehicle, and the direction of its nose.

    Attributes:
        latitude: Degrees.
        longitude: Degrees.
        altitude: Metres above mean sea level.
        relative_altitude: Metres above home.
        heading: Degrees from north; None if unknown.
    """

    latitude: float
    longitude: float
    altitude: float
    relative_altitude: float
    heading: float | None = None

    @classmethod
    def read(cls, message: common.GlobalPositionInt) -> VehiclePose:
        """Return the pose in a GLOBAL_POSITION_INT."""
        heading = None if message.hdg == _UNKNOWN_HEADING else message.hdg / 100
        return cls(
            message.lat / 1e7, message.lon / 1e7, message.alt / 1e3, message.relative_alt / 1e3, heading
        )


@dataclass(frozen=True, slots=True)
class RegionOfInterest:
    """A location that a gimbal keeps in view; `altitude` is above home if `relative`, else above the sea."""

    latitude: float
    longitude: float
    altitude: float
    relative: bool

    @classmethod
    def of_command(cls, command: Command) -> RegionOfInterest | None:
        """Return the location of a DO_SET_ROI_LOCATION; None if it is no location on the Earth."""
        frame = command.frame
        known = frame is None or frame in _RELATIVE or frame in _ABSOLUTE
        latitude, longitude, altitude = command.param5, command.param6, command.param7
        if not (known and abs(latitude) <= 90 and abs(longitude) <= 180 and abs(altitude) < 1e6):
            return None
        return cls(latitude, longitude, altitude, relative=frame is None or frame in _RELATIVE)


@dataclass(frozen=True, slots=True)
class SystemOfInterest:
    """Another system that a gimbal keeps in view, by the positions that it broadcasts."""

    system: int


class Positions:
    """The positions of the own vehicle and of one other system, from GLOBAL_POSITION_INT and ATTITUDE."""

    def __init__(self, system: int) -> None:
        self._own_system = system
        self._own: VehiclePose | None = None
        self._yaw: float | None = None
        self._others: dict[int, VehiclePose] = {}
        self.followed: int | None = None

    def follow(self, system: int | None) -> None:
        """Remember the positions of that system from now on; None: of no other system."""
        self.followed = system
        self._others.clear()

    def receive(self, packet: Packet) -> None:
        """Handle a message of any system."""
        match packet.message:
            case common.GlobalPositionInt() as message if packet.system == self._own_system:
                self._own = VehiclePose.read(message)
            case common.GlobalPositionInt() as message if packet.system == self.followed:
                self._others[packet.system] = VehiclePose.read(message)
            case common.Attitude(yaw=yaw) if packet.system == self._own_system:
                self._yaw = degrees(yaw)

    @property
    def own(self) -> VehiclePose | None:
        """The pose of the own vehicle; None until it is received."""
        return self._own

    @property
    def heading(self) -> float | None:
        """The direction of the own nose, degrees from north; None until it is received."""
        if self._yaw is not None:
            return self._yaw
        return None if self._own is None else self._own.heading

    def of(self, system: int) -> VehiclePose | None:
        """Return the position of the followed system; None until it is received."""
        return self._others.get(system)


def direction_to(pose: VehiclePose, region: RegionOfInterest) -> tuple[float, float]:
    """Return pitch above the horizon and yaw from north in degrees."""
    up = region.altitude - (pose.relative_altitude if region.relative else pose.altitude)
    north, east = offset(pose.latitude, pose.longitude, region.latitude, region.longitude)
    return degrees(atan2(up, hypot(north, east))), degrees(atan2(east, north))
