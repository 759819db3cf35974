"""What can be simulated, and where it begins."""

from __future__ import annotations

from enum import StrEnum
from typing import TYPE_CHECKING, NamedTuple

from mavstack.dialects import common
from mavstack.errors import MavstackError

if TYPE_CHECKING:
    from typing import Self

_LATITUDE, _LONGITUDE, _CIRCLE = 90.0, 180.0, 360.0


class VehicleType(StrEnum):
    """The types of vehicle; `vtol` is a quadplane."""

    COPTER = "copter"
    PLANE = "plane"
    VTOL = "vtol"
    ROVER = "rover"
    BOAT = "boat"
    SUB = "sub"

    @property
    def mav_type(self) -> common.MavType:
        """As HEARTBEAT tells it."""
        return _MAV_TYPES[self]

    @property
    def flies(self) -> bool:
        """Whether it leaves the ground."""
        return self in (VehicleType.COPTER, VehicleType.PLANE, VehicleType.VTOL)

    @property
    def on_surface(self) -> bool:
        """Whether it only moves in the plane."""
        return self in (VehicleType.ROVER, VehicleType.BOAT)


_MAV_TYPES = {
    VehicleType.COPTER: common.MavType.QUADROTOR,
    VehicleType.PLANE: common.MavType.FIXED_WING,
    VehicleType.VTOL: common.MavType.VTOL_FIXEDROTOR,
    VehicleType.ROVER: common.MavType.GROUND_ROVER,
    VehicleType.BOAT: common.MavType.SURFACE_BOAT,
    VehicleType.SUB: common.MavType.SUBMARINE,
}


class Firmware(StrEnum):
    """Whose behaviour a simulated autopilot has."""

    ARDUPILOT = "ardupilot"
    PX4 = "px4"

    @property
    def mav_autopilot(self) -> common.MavAutopilot:
        """As HEARTBEAT tells it."""
        return common.MavAutopilot.PX4 if self is Firmware.PX4 else common.MavAutopilot.ARDUPILOTMEGA


class Home(NamedTuple):
    """A place and a direction: degrees, metres above mean sea level, degrees from north."""

    latitude: float
    longitude: float
    altitude: float = 0.0
    heading: float = 0.0

    @classmethod
    def parse(cls, text: str) -> Self:
        """Read `LAT,LON,ALT,HDG`; altitude and heading may be left out."""
        try:
            home = cls(*(float(part) for part in text.split(",")))
        except (TypeError, ValueError):
            raise MavstackError(f"{text!r} is not LAT,LON,ALT,HDG, such as 47.3977,8.5456,488,0") from None
        if not (abs(home.latitude) <= _LATITUDE and abs(home.longitude) <= _LONGITUDE):
            raise MavstackError(f"{text!r} is no place on Earth: -90 to 90, -180 to 180 degrees")
        if not (abs(home.altitude) < 1e5 and abs(home.heading) <= _CIRCLE):
            raise MavstackError(f"{text!r}: altitude is in metres, heading in degrees")
        return home


#: Where vehicles begin if nobody says where: a field near Zurich.
DEFAULT_HOME = Home(47.3977418, 8.5455939, 488.0, 0.0)
