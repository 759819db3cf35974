"""Commands without a goal to monitor: modes, any MAV_CMD, versions, sources of the estimator."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.errors import InvalidArgumentError
from mavstack.services.arguments import check_number
from mavstack.vehicle.actions.preconditions import check_preconditions
from mavstack.vehicle.deadline import deadline
from mavstack.vehicle.status_text_capture import with_status_texts

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.services.command import CommandResult
    from mavstack.services.version import AutopilotVersion
    from mavstack.vehicle.vehicle import Vehicle


async def set_mode(vehicle: Vehicle, mode: str | int, *, timeout: float | None = None) -> None:
    """Set the flight mode (MAV_CMD_DO_SET_MODE), and wait until the heartbeat confirms it.

    Args:
        mode: The name of a mode of the firmware, or its custom mode number; `modes.list()` returns them.
        timeout: Seconds for the whole call; None: until retries are exhausted.

    Raises:
        CommandDenied: The vehicle refused the mode, or has none of that name.
        CommandTimeout: The vehicle did not answer.
        ModeTimeout: The vehicle accepted the mode and did not enter it.
    """
    check_preconditions(vehicle, "mode", "setting the mode of")
    await with_status_texts(vehicle, vehicle.component.modes.set(mode, timeout=timeout))


async def command(
    vehicle: Vehicle,
    command: int,
    *params: float,
    frame: int | None = None,
    timeout: float | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> CommandResult:
    """Send any MAV_CMD to the autopilot, and wait for its end; errors carry the vehicle's status texts.

    Args:
        command: The MAV_CMD.
        params: Up to seven parameters, in the units of the command's definition; missing ones are 0.
        frame: A MAV_FRAME: send COMMAND_INT, with params 5 and 6 in degrees or metres. None:
            COMMAND_LONG.
        timeout: Seconds for the whole call; None: until retries are exhausted or no more IN_PROGRESS is
            received.
        progress: Called with the percentage done and 100 while a long command runs.

    Returns:
        The result and its additional data (COMMAND_ACK).

    Raises:
        CommandDenied: The vehicle answered with another result than ACCEPTED.
        CommandTimeout: The vehicle did not answer.
        RemoteCancelled: The connection was closed.
    """
    check_preconditions(vehicle, "command", "sending a command to")
    request = vehicle.component.command(command, *params, frame=frame, timeout=timeout, progress=progress)
    return await with_status_texts(vehicle, request)


async def get_version(vehicle: Vehicle, *, timeout: float | None = None) -> AutopilotVersion:
    """Get the software and hardware versions and the capabilities (AUTOPILOT_VERSION).

    Args:
        timeout: Seconds for the whole call; None: until retries are exhausted.

    Returns:
        The versions, the unique id and the MAV_PROTOCOL_CAPABILITY flags; `version` keeps them.

    Raises:
        CommandDenied: The vehicle refused the request.
        MessageTimeout: The vehicle did not answer.
    """
    return await with_status_texts(vehicle, vehicle.component.get_version(timeout=timeout))


async def set_ekf_source(vehicle: Vehicle, number: int, *, timeout: float | None = None) -> None:
    """Select a set of sources of the state estimator (MAV_CMD_SET_EKF_SOURCE_SET).

    Args:
        number: The number of the set, 1 to 3: parameters EK3_SRC1_… to EK3_SRC3_….
        timeout: Seconds for the whole call; None: until retries are exhausted.

    Raises:
        InvalidTypeError: The number is not a number.
        InvalidArgumentError: The number is not 1, 2 or 3.
        ActionUnsupported: The firmware has no source sets (PX4); nothing was sent.
        CommandDenied: The vehicle refused.
        CommandTimeout: The vehicle did not answer.
        ActionTimeout: The call did not end within `timeout`.
    """
    check_number("source set", number)
    if number not in (1, 2, 3):
        raise InvalidArgumentError(f"source set must be 1, 2 or 3, got {number}")
    operation = "selecting the estimator's sources of"
    check_preconditions(vehicle, "ekf sources", operation)
    async with deadline(timeout, operation, vehicle.address):
        await with_status_texts(vehicle, vehicle.firmware.set_ekf_source(number))
