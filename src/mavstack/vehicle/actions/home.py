"""Where home is, and how high: what altitudes and returns are reckoned from."""

from __future__ import annotations

from math import nan
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.errors import CommandDenied, MessageTimeout, RemoteError
from mavstack.vehicle.status_text_capture import with_status_texts

if TYPE_CHECKING:
    from mavstack.vehicle.telemetry.values import HomePosition, Position
    from mavstack.vehicle.vehicle import Vehicle

_CMD: Final = common.MavCmd


async def find_home(vehicle: Vehicle) -> HomePosition:
    """Where home is; asks for it if it was not told."""
    if vehicle.home is None:
        await with_status_texts(vehicle, vehicle.component.request_message(common.HomePosition))
    home = vehicle.home
    if home is None:
        raise MessageTimeout("HOME_POSITION", str(vehicle.address), answer="it has none yet")
    return home


async def home_altitude(vehicle: Vehicle) -> float:
    """Metres of home above mean sea level."""
    try:
        return (await find_home(vehicle)).altitude
    except (CommandDenied, MessageTimeout):
        position = vehicle.position
        if position is None or position.altitude is None or position.relative_altitude is None:
            raise
        return position.altitude - position.relative_altitude


async def find_position(vehicle: Vehicle) -> Position:
    """Where it is; waits for that to be told."""
    if vehicle.position is None:
        await vehicle.wait_for_message(common.GlobalPositionInt)
    position = vehicle.position
    if position is None:
        raise MessageTimeout("its position", str(vehicle.address), answer="it does not know its place")
    return position


async def find_altitude(vehicle: Vehicle) -> float:
    """Metres that it is above home; waits for that to be told."""
    altitude = (await find_position(vehicle)).relative_altitude
    if altitude is None:
        raise MessageTimeout("its altitude", str(vehicle.address), answer="it does not know it")
    return altitude


async def set_home(
    vehicle: Vehicle, latitude: float | None, longitude: float | None, altitude: float | None
) -> None:
    """Make a place home, or the place where the vehicle is."""
    component = vehicle.component
    if latitude is None or longitude is None:
        asked = component.command(_CMD.DO_SET_HOME, 1)
    else:
        above_sea = await home_altitude(vehicle) if altitude is None else altitude
        asked = component.command(
            _CMD.DO_SET_HOME, 0, 0, 0, nan, latitude, longitude, above_sea, frame=common.MavFrame.GLOBAL
        )
    await with_status_texts(vehicle, asked)
    try:
        await component.request_message(common.HomePosition)  # what was told of it before no longer holds
    except RemoteError:
        return
