"""Vehicle types, firmwares and home positions of simulated vehicles."""

from __future__ import annotations

from enum import StrEnum
from typing import TYPE_CHECKING, NamedTuple

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError

if TYPE_CHECKING:
    from typing import Self

_LATITUDE, _LONGITUDE, _CIRCLE, _ALTITUDE = 90.0, 180.0, 360.0, 1e5


class VehicleType(StrEnum):
    """A type of simulated vehicle; `vtol` is a quadplane."""

    COPTER = "copter"
    PLANE = "plane"
    VTOL = "vtol"
    ROVER = "rover"
    BOAT = "boat"
    SUB = "sub"

    @property
    def mav_type(self) -> common.MavType:
        """The MAV_TYPE in HEARTBEAT."""
        return _MAV_TYPES[self]

    @property
    def flies(self) -> bool:
        """True for types that can fly."""
        return self in (VehicleType.COPTER, VehicleType.PLANE, VehicleType.VTOL)

    @property
    def on_surface(self) -> bool:
        """True for types that move on a surface."""
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
    """A firmware whose behaviour is simulated."""

    ARDUPILOT = "ardupilot"
    PX4 = "px4"

    @property
    def mav_autopilot(self) -> common.MavAutopilot:
        """The MAV_AUTOPILOT in HEARTBEAT."""
        return common.MavAutopilot.PX4 if self is Firmware.PX4 else common.MavAutopilot.ARDUPILOTMEGA


class ControllerFirmware(StrEnum):
    """A firmware of a flight controller that speaks MSP."""

    BETAFLIGHT = "betaflight"
    INAV = "inav"


class TerrainSource(StrEnum):
    """Where a vehicle has the heights of the terrain from."""

    #: The vehicle knows the terrain of the simulation, which is flat.
    FLAT = "flat"
    #: The vehicle requests the terrain from ground stations (ArduPilot).
    REQUEST = "request"


class Home(NamedTuple):
    """A position and heading: degrees, metres above mean sea level, degrees from north."""

    latitude: float
    longitude: float
    altitude: float = 0.0
    heading: float = 0.0

    @classmethod
    def parse(cls, text: str) -> Self:
        """Parse `LAT,LON[,ALT[,HDG]]`; raises InvalidArgumentError."""
        try:
            home = cls(*(float(part) for part in text.split(",")))
        except (TypeError, ValueError):
            raise InvalidArgumentError(
                f"home {text!r} is not LAT,LON,ALT,HDG, such as 47.3977,8.5456,488,0"
            ) from None
        if not (abs(home.latitude) <= _LATITUDE and abs(home.longitude) <= _LONGITUDE):
            raise InvalidArgumentError(
                f"home {text!r}: latitude must be -90 to 90 degrees, longitude -180 to 180 degrees"
            )
        if not (abs(home.altitude) < _ALTITUDE and abs(home.heading) <= _CIRCLE):
            raise InvalidArgumentError(
                f"home {text!r}: altitude must be within 100 km, heading within 360 degrees"
            )
        return home


#: The default home position: a field near Zurich.
DEFAULT_HOME = Home(47.3977418, 8.5455939, 488.0, 0.0)
