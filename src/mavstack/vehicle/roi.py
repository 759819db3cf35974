"""The region of interest of a vehicle: the point that its gimbal, or its nose, keeps pointing at.

await vehicle.roi.set_location(47.3985, 8.5460)
await vehicle.roi.clear()
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.node.api_object import ReadOnly
from mavstack.services.arguments import check_number, check_numbers
from mavstack.vehicle.actions.limits import check_location
from mavstack.vehicle.actions.preconditions import check_preconditions
from mavstack.vehicle.deadline import deadline
from mavstack.vehicle.firmware import firmware_of
from mavstack.vehicle.geography import Location
from mavstack.vehicle.status_text_capture import with_status_texts

if TYPE_CHECKING:
    from collections.abc import Coroutine
    from typing import Any

    from mavstack.vehicle.firmware import Firmware
    from mavstack.vehicle.vehicle import Vehicle

_OPERATION: Final = "setting the region of interest of"


class RegionOfInterest(ReadOnly):
    """The region of interest of a vehicle; `vehicle.roi`."""

    def __init__(self, vehicle: Vehicle) -> None:
        self._vehicle = vehicle

    async def set_location(
        self, latitude: float, longitude: float, altitude: float = 0.0, *, timeout: float | None = None
    ) -> None:
        """Keep pointing at a location (MAV_CMD_DO_SET_ROI_LOCATION).

        Args:
            latitude: Degrees.
            longitude: Degrees.
            altitude: Metres above home.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            InvalidTypeError: An argument is not a number.
            InvalidArgumentError: The location is not one on Earth.
            CommandDenied: The vehicle refused, or has no home (PX4 counts altitudes from the sea).
            CommandTimeout: The vehicle did not answer.
            MessageTimeout: The vehicle did not report its home, which the altitude counts from (PX4).
            ActionTimeout: The call did not end within `timeout`.
        """
        check_numbers(latitude=latitude, longitude=longitude)
        check_number("altitude", altitude)
        location = Location(latitude, longitude, altitude)
        check_location(location)
        await self._request(self._firmware.look_at(location), timeout)

    async def set_next_waypoint(
        self, *, pitch: float = 0.0, roll: float = 0.0, yaw: float = 0.0, timeout: float | None = None
    ) -> None:
        """Keep pointing at the next waypoint, turned by an offset (MAV_CMD_DO_SET_ROI_WPNEXT_OFFSET).

        Args:
            pitch: Degrees, positive up.
            roll: Degrees, positive to the right.
            yaw: Degrees, positive clockwise.
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            InvalidTypeError: An angle is not a number.
            InvalidArgumentError: An angle is not finite.
            ActionUnsupported: The firmware does not do that (ArduPilot); nothing was sent.
            CommandDenied: The vehicle refused.
            CommandTimeout: The vehicle did not answer.
            ActionTimeout: The call did not end within `timeout`.
        """
        check_numbers(pitch=pitch, roll=roll, yaw=yaw)
        await self._request(self._firmware.look_at_next_waypoint(pitch, roll, yaw), timeout)

    async def clear(self, *, timeout: float | None = None) -> None:
        """Point ahead again (MAV_CMD_DO_SET_ROI_NONE).

        Args:
            timeout: Seconds for the whole call; None: until retries are exhausted.

        Raises:
            CommandDenied: The vehicle refused.
            CommandTimeout: The vehicle did not answer.
            ActionTimeout: The call did not end within `timeout`.
        """
        await self._request(self._firmware.look_ahead(), timeout)

    @property
    def _firmware(self) -> Firmware:
        check_preconditions(self._vehicle, "roi", _OPERATION)
        return firmware_of(self._vehicle)

    async def _request(self, request: Coroutine[Any, Any, object], timeout: float | None) -> None:
        async with deadline(timeout, _OPERATION, self._vehicle.address):
            await with_status_texts(self._vehicle, request)
