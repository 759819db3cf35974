"""The positions that actions start from: requested, or waited for, if they are not known."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.errors import CommandDenied, MessageTimeout
from mavstack.vehicle.status_text_capture import with_status_texts

if TYPE_CHECKING:
    from mavstack.vehicle.telemetry.values import HomePosition, Position
    from mavstack.vehicle.vehicle import Vehicle

#: Default timeout of calls that wait for a position, in seconds.
POSITION_TIMEOUT = 10.0


async def get_home(vehicle: Vehicle, *, timeout: float | None = None) -> HomePosition:
    """Return the home position; request it if it was not received (HOME_POSITION).

    Args:
        timeout: Seconds for the whole call; None: until retries are exhausted.

    Returns:
        The position in degrees and metres above mean sea level.

    Raises:
        CommandDenied: The vehicle refused the request.
        MessageTimeout: The vehicle did not answer, or has no home yet.
    """
    if vehicle.home is None:
        request = vehicle.component.request_message(common.HomePosition, timeout=timeout)
        await with_status_texts(vehicle, request)
    home = vehicle.home
    if home is None:
        raise MessageTimeout("reading the home position of", str(vehicle.address), answer="it has none yet")
    return home


async def get_home_altitude(vehicle: Vehicle, *, timeout: float | None = None) -> float:
    """Return the altitude of home, which follows from the position if home itself is not known.

    Args:
        timeout: Seconds for the whole call; None: until retries are exhausted.

    Returns:
        Metres above mean sea level.

    Raises:
        CommandDenied: The vehicle refused the request for its home, and its position is not known.
        MessageTimeout: The vehicle did not answer, and its position is not known.
    """
    try:
        return (await vehicle.get_home(timeout=timeout)).altitude
    except (CommandDenied, MessageTimeout):
        position = vehicle.position
        if position is None or position.altitude is None or position.relative_altitude is None:
            raise
        return position.altitude - position.relative_altitude


async def get_position(vehicle: Vehicle, *, timeout: float | None = None) -> Position:
    """Return the position; wait for it if it was not received (GLOBAL_POSITION_INT).

    Args:
        timeout: Seconds for the whole call; None: until no position has arrived for a while.

    Returns:
        The position in degrees and metres.

    Raises:
        MessageTimeout: No position arrived in time, or the vehicle does not know it.
        CommandDenied: The vehicle refused to send its position.
        RemoteCancelled: The connection was closed.
    """
    if vehicle.position is None:
        seconds = POSITION_TIMEOUT if timeout is None else timeout
        await vehicle.wait_for_message(common.GlobalPositionInt, timeout=seconds)
    position = vehicle.position
    if position is None:
        raise MessageTimeout("reading the position of", str(vehicle.address), answer="it does not know it")
    return position


async def get_relative_altitude(vehicle: Vehicle, *, timeout: float | None = None) -> float:
    """Return the altitude above home; wait for it if it was not received (GLOBAL_POSITION_INT).

    Args:
        timeout: Seconds for the whole call; None: until no position has arrived for a while.

    Returns:
        Metres above home.

    Raises:
        MessageTimeout: No position arrived in time, or the vehicle does not know its altitude.
        CommandDenied: The vehicle refused to send its position.
        RemoteCancelled: The connection was closed.
    """
    altitude = (await vehicle.get_position(timeout=timeout)).relative_altitude
    if altitude is None:
        raise MessageTimeout("reading the altitude of", str(vehicle.address), answer="it does not know it")
    return altitude
