"""Giving a vehicle another system id, by the parameter of its firmware."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.errors import (
    ActionTimeout,
    ActionUnsupported,
    InvalidArgumentError,
    InvalidStateError,
    ParameterDenied,
    ParameterTimeout,
    RemoteTimeout,
)
from mavstack.services.arguments import check_number
from mavstack.services.identity import SYSTEM_ID_PARAMETERS
from mavstack.vehicle.deadline import deadline
from mavstack.vehicle.status_text_capture import with_status_texts

if TYPE_CHECKING:
    from mavstack.vehicle.vehicle import Vehicle

MAX_SYSTEM_ID: Final = 255
#: Seconds to find out which parameter holds the system id of a firmware.
PARAMETER_TIMEOUT: Final = 5.0
#: Seconds in which a vehicle must use its new id if it needs no reboot.
CHANGE_TIMEOUT: Final = 3.0
#: Seconds in which a vehicle must be back after a reboot.
REBOOT_TIMEOUT: Final = 60.0
_OPERATION: Final = "renumbering"


@dataclass(frozen=True, slots=True)
class Renumbered:
    """A vehicle's new system id.

    Attributes:
        system: The new system id; `Connection.vehicles` has the vehicle under it.
        parameter: The parameter that was set.
        rebooted: True if the vehicle needed a reboot.
    """

    system: int
    parameter: str
    rebooted: bool


async def renumber(
    vehicle: Vehicle, system: int | None = None, *, timeout: float | None = None
) -> Renumbered:
    """Give the vehicle another system id, reboot it if that is needed, and wait until it speaks with it.

    Where several vehicles use its system id, choose one with `choose_sender` first.

    Args:
        system: The new system id, 1 to 255; None: the lowest one that no component uses.
        timeout: Seconds for the whole call; None: until retries are exhausted, or it stays away.

    Returns:
        The new system id, the parameter, and whether the vehicle rebooted.

    Raises:
        SystemIdConflictError: Several vehicles use its system id, and none was chosen.
        InvalidArgumentError: The system id is out of range, or a component uses it.
        InvalidStateError: The vehicle is armed.
        ActionUnsupported: The firmware's parameter is not known.
        ParameterDenied: The vehicle refused the parameter.
        CommandDenied: The vehicle refused to reboot.
        ActionTimeout: It has no such parameter, or did not speak with the new system id in time.
    """
    connection = vehicle.connection
    names = SYSTEM_ID_PARAMETERS.get(int(vehicle.autopilot))
    if names is None:
        raise ActionUnsupported(
            f"{_OPERATION} {vehicle.address} failed: the parameter of its firmware is not known"
        )
    wanted = _checked_id(vehicle, system)
    async with deadline(timeout, _OPERATION, vehicle.address):
        await connection.check_sender(vehicle.system, _OPERATION)
        if vehicle.armed:
            raise InvalidStateError(f"{_OPERATION} {vehicle.address} failed: it is armed; disarm it first")
        name = await _parameter_of(vehicle, names)
        with suppress(ParameterTimeout):  # the answer may come from the new id
            await vehicle.component.params.set(name, wanted)
        rebooted = not await _speaks(vehicle, wanted, CHANGE_TIMEOUT)
        if rebooted:
            with suppress(RemoteTimeout):  # the vehicle may reboot before it acknowledges
                reboot = common.MavCmd.PREFLIGHT_REBOOT_SHUTDOWN
                await with_status_texts(vehicle, vehicle.component.command(reboot, 1))
            if not await _speaks(vehicle, wanted, REBOOT_TIMEOUT):
                answer = f"{name} is {wanted}, and it did not speak with that id in {REBOOT_TIMEOUT:g} s"
                raise ActionTimeout(_OPERATION, str(vehicle.address), answer=answer)
        connection.forget_sender(vehicle.system)
    return Renumbered(wanted, name, rebooted)


def _checked_id(vehicle: Vehicle, system: int | None) -> int:
    """Return the new id: the given one if no component uses it, else the lowest free one."""
    connection = vehicle.connection
    used = {address.system for address in connection.components} | {connection.address.system}
    if system is None:
        return next(each for each in range(1, MAX_SYSTEM_ID + 1) if each not in used)
    check_number("system id", system)
    if system not in range(1, MAX_SYSTEM_ID + 1):
        raise InvalidArgumentError(f"system id must be 1 to {MAX_SYSTEM_ID}, got {system}")
    if system in used:
        raise InvalidArgumentError(f"{_OPERATION} {vehicle.address} failed: system id {system} is in use")
    return int(system)


async def _parameter_of(vehicle: Vehicle, names: tuple[str, ...]) -> str:
    """Return the parameter that the firmware has."""
    if len(names) == 1:
        return names[0]
    for name in sorted(names, key=lambda each: each not in vehicle.params.cached):
        with suppress(ParameterDenied, ParameterTimeout):
            await vehicle.component.params.get(name, timeout=PARAMETER_TIMEOUT)
            return name
    answer = f"it has none of the parameters {', '.join(names)}"
    raise ActionTimeout(_OPERATION, str(vehicle.address), answer=answer)


async def _speaks(vehicle: Vehicle, system: int, seconds: float) -> bool:
    """Return whether a vehicle with the new system id is heard in time."""
    try:
        await vehicle.connection.wait_for_autopilot(system, timeout=seconds)
    except RemoteTimeout:
        return False
    await asyncio.sleep(0)  # lets the events of the vehicle's discovery run first
    return True
