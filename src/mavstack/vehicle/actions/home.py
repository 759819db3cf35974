"""Setting the home position."""

from __future__ import annotations

from math import nan
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError, RemoteError
from mavstack.services.arguments import check_numbers
from mavstack.vehicle.actions.limits import check_location
from mavstack.vehicle.actions.preconditions import check_preconditions
from mavstack.vehicle.deadline import deadline
from mavstack.vehicle.geography import Location
from mavstack.vehicle.status_text_capture import with_status_texts

if TYPE_CHECKING:
    from mavstack.vehicle.vehicle import Vehicle


async def set_home(
    vehicle: Vehicle,
    latitude: float | None = None,
    longitude: float | None = None,
    altitude: float | None = None,
    *,
    timeout: float | None = None,
) -> None:
    """Set the home position (MAV_CMD_DO_SET_HOME).

    Args:
        latitude: Degrees; None with `longitude` None: the present position.
        longitude: Degrees.
        altitude: Metres above mean sea level; None keeps the altitude of home.
        timeout: Seconds for the whole call; None: until retries are exhausted.

    Raises:
        InvalidArgumentError: Only one of latitude and longitude is given.
        CommandDenied: The vehicle refused.
        CommandTimeout: The vehicle did not answer.
        MessageTimeout: `altitude` is None, and the altitude of home is not known.
        ActionTimeout: The call did not end within `timeout`.
    """
    component = vehicle.component
    check_numbers(latitude=latitude, longitude=longitude, altitude=altitude)
    if (latitude is None) != (longitude is None):
        raise InvalidArgumentError(
            "home needs both latitude and longitude, or neither for the present position"
        )
    if latitude is not None and longitude is not None:
        check_location(Location(latitude, longitude, altitude))
    operation = "setting the home position of"
    check_preconditions(vehicle, "home", operation)
    async with deadline(timeout, operation, vehicle.address):
        if latitude is None or longitude is None:
            command = component.command(common.MavCmd.DO_SET_HOME, 1)
        else:
            above_sea = await vehicle.get_home_altitude() if altitude is None else altitude
            command = component.command(
                common.MavCmd.DO_SET_HOME, 0, 0, 0, nan, latitude, longitude, above_sea,
                frame=common.MavFrame.GLOBAL,
            )  # fmt: skip
        await with_status_texts(vehicle, command)
        try:
            # requested, because the stored position is out of date
            await component.request_message(common.HomePosition)
        except RemoteError:
            return
