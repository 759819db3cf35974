"""Constructors for the items that most missions consist of."""

from __future__ import annotations

from math import nan
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.services.arguments import check_numbers

if TYPE_CHECKING:
    from typing import Self

_CMD: Final = common.MavCmd
_UNCHANGED: Final = -1.0


class ItemFactories:
    """The named constructors of `MissionItem`. Altitudes are metres above home, angles degrees."""

    __slots__ = ()

    @classmethod
    def home(cls, latitude: float = 0.0, longitude: float = 0.0) -> Self:
        """Return the item that ArduPilot keeps as item 0 of a mission, and replaces by its home.

        Args:
            latitude: Degrees.
            longitude: Degrees.

        Returns:
            The item (NAV_WAYPOINT).
        """
        return cls._of(_CMD.NAV_WAYPOINT, param5=latitude, param6=longitude)

    @classmethod
    def waypoint(
        cls,
        latitude: float,
        longitude: float,
        altitude: float,
        *,
        hold: float = 0.0,
        radius: float = 0.0,
        yaw: float | None = None,
    ) -> Self:
        """Return the item to fly to a position.

        Args:
            latitude: Degrees.
            longitude: Degrees.
            altitude: Metres above home.
            hold: Seconds to stay there; a wing does not.
            radius: The distance in metres at which the position is reached; 0: the vehicle's default.
            yaw: Heading in degrees; None leaves it to the vehicle.

        Returns:
            The item (NAV_WAYPOINT).
        """
        heading = nan if yaw is None else yaw
        return cls._of(
            _CMD.NAV_WAYPOINT, hold, radius, 0.0, heading, param5=latitude, param6=longitude, param7=altitude
        )

    @classmethod
    def takeoff(cls, altitude: float, latitude: float = 0.0, longitude: float = 0.0) -> Self:
        """Return the item to take off.

        Args:
            altitude: Metres above home.
            latitude: Degrees. PX4 needs the position to take off to; for ArduPilot 0, 0 is the present one.
            longitude: Degrees.

        Returns:
            The item (NAV_TAKEOFF).
        """
        return cls._of(_CMD.NAV_TAKEOFF, 0, 0, 0, nan, param5=latitude, param6=longitude, param7=altitude)

    @classmethod
    def land(cls, latitude: float = 0.0, longitude: float = 0.0) -> Self:
        """Return the item to land.

        Args:
            latitude: Degrees. PX4 needs the position to land at; for ArduPilot 0, 0 is the present one.
            longitude: Degrees.

        Returns:
            The item (NAV_LAND).
        """
        return cls._of(_CMD.NAV_LAND, 0, 0, 0, nan, param5=latitude, param6=longitude)

    @classmethod
    def return_to_launch(cls) -> Self:
        """Return the item to return to home and land there.

        Returns:
            The item (NAV_RETURN_TO_LAUNCH).
        """
        return cls._of(_CMD.NAV_RETURN_TO_LAUNCH)

    @classmethod
    def change_speed(cls, speed: float, speed_type: int = common.SpeedType.GROUNDSPEED) -> Self:
        """Return the item to change the speed.

        Args:
            speed: Metres per second.
            speed_type: The SPEED_TYPE; the default is the speed over ground.

        Returns:
            The item (DO_CHANGE_SPEED).
        """
        return cls._of(_CMD.DO_CHANGE_SPEED, float(speed_type), speed, _UNCHANGED)

    @classmethod
    def delay(cls, seconds: float) -> Self:
        """Return the item to wait before the next one.

        Args:
            seconds: The time to wait.

        Returns:
            The item (NAV_DELAY).
        """
        return cls._of(_CMD.NAV_DELAY, seconds, _UNCHANGED, _UNCHANGED, _UNCHANGED)

    @classmethod
    def region_of_interest(cls, latitude: float, longitude: float, altitude: float = 0.0) -> Self:
        """Return the item to point the camera, or the nose, to a position until `no_region_of_interest`.

        Args:
            latitude: Degrees.
            longitude: Degrees.
            altitude: Metres above home.

        Returns:
            The item (DO_SET_ROI_LOCATION).
        """
        return cls._of(_CMD.DO_SET_ROI_LOCATION, param5=latitude, param6=longitude, param7=altitude)

    @classmethod
    def no_region_of_interest(cls) -> Self:
        """Return the item that ends a region of interest.

        Returns:
            The item (DO_SET_ROI_NONE).
        """
        return cls._of(_CMD.DO_SET_ROI_NONE)

    @classmethod
    def _of(cls, command: int, *params: float, **places: float) -> Self:
        check_numbers(finite=False, **{f"param{n}": value for n, value in enumerate(params, 1)}, **places)
        make: type = cls
        item: Self = make(command, *params, **places)
        return item
