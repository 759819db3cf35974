"""The wind that a companion computer or a weather station measures: a method of `External`."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from math import isfinite, nan
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common, development
from mavstack.errors import CommandDenied, InvalidArgumentError
from mavstack.vehicle.actions.preconditions import check_preconditions, refusal
from mavstack.vehicle.deadline import deadline
from mavstack.vehicle.status_text_capture import with_status_texts

if TYPE_CHECKING:
    from mavstack.vehicle.external.external import External
    from mavstack.vehicle.vehicle import Vehicle

_OPERATION: Final = "sending the wind to"
_COMMAND: Final = int(development.MavCmd.EXTERNAL_WIND_ESTIMATE)
_RESULT: Final = common.MavResult
#: Seconds to wait for the answer of PX4's estimator behind that of another module.
_SECOND_ANSWER: Final = 1.5
_MAX_SPEED: Final = 100.0


async def wind(
    external: External,
    speed: float,
    direction: float,
    *,
    speed_accuracy: float | None = None,
    direction_accuracy: float | None = None,
    timeout: float | None = None,
) -> None:
    """Set the wind that the estimator of the vehicle begins with (MAV_CMD_EXTERNAL_WIND_ESTIMATE).

    PX4 takes it before the take-off. ArduPilot takes it at any time, for the estimate by which it flies
    without an EKF.

    Args:
        speed: Metres per second over the ground.
        direction: Degrees from north where the wind comes from.
        speed_accuracy: The standard deviation of the speed, metres per second; None: not known.
        direction_accuracy: The standard deviation of the direction, degrees; None: not known.
        timeout: Seconds for the whole call; None: until retries are exhausted.

    Raises:
        InvalidArgumentError: A number is not possible.
        ActionUnsupported: The firmware has no estimate of the wind; nothing was sent.
        ActionRefused: A vehicle with PX4 is in the air; nothing was sent.
        CommandDenied: The vehicle refused.
        CommandTimeout: The vehicle did not answer.
        ActionTimeout: The call did not end within `timeout`.
    """
    _check(speed, direction, speed_accuracy, direction_accuracy)
    vehicle = external.vehicle
    check_preconditions(vehicle, "wind", _OPERATION)
    params = (speed, _or_nan(speed_accuracy), direction % 360.0, _or_nan(direction_accuracy))
    async with deadline(timeout, _OPERATION, vehicle.address):
        if vehicle.autopilot == common.MavAutopilot.PX4:
            await _send_to_px4(vehicle, params)
        else:
            await with_status_texts(vehicle, vehicle.component.command(_COMMAND, *params))


async def _send_to_px4(vehicle: Vehicle, params: tuple[float, ...]) -> None:
    """Send the command, of which PX4's commander answers UNSUPPORTED beside the answer of its estimator."""
    if vehicle.in_air:
        raise refusal(vehicle, _OPERATION, "PX4 takes a wind on the ground only; send it before the take-off")
    accepted = asyncio.Event()

    def note(answer: common.CommandAck) -> None:
        if answer.command == _COMMAND and answer.result == _RESULT.ACCEPTED:
            accepted.set()

    listener = vehicle.component.add_listener(common.CommandAck, note)
    try:
        await with_status_texts(vehicle, vehicle.component.command(_COMMAND, *params))
    except CommandDenied as error:
        if error.code != _RESULT.UNSUPPORTED:
            raise
        with suppress(TimeoutError):
            await asyncio.wait_for(accepted.wait(), _SECOND_ANSWER)
        if not accepted.is_set():
            raise
    finally:
        listener.close()


def _check(speed: float, direction: float, *accuracies: float | None) -> None:
    if not 0 <= speed <= _MAX_SPEED:
        raise InvalidArgumentError(f"a wind must be 0 to {_MAX_SPEED:g} m/s, got {speed}")
    if not isfinite(direction):
        raise InvalidArgumentError(f"a direction must be finite degrees, got {direction}")
    for accuracy in accuracies:
        if accuracy is not None and not (isfinite(accuracy) and accuracy >= 0):
            raise InvalidArgumentError(f"an accuracy must be finite and not negative, got {accuracy}")


def _or_nan(value: float | None) -> float:
    return nan if value is None else value
