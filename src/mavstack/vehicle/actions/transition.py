"""The transition of a VTOL between hovering and flying on its wing."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.vehicle.action_monitor import ActionGoal, ActionMonitor
from mavstack.vehicle.actions.preconditions import check_preconditions
from mavstack.vehicle.actions.quadplane import detect_quadplane
from mavstack.vehicle.firmware import firmware_of
from mavstack.vehicle.status_text_capture import with_status_texts
from mavstack.vehicle.vehicle_type import VehicleType

if TYPE_CHECKING:
    from mavstack.vehicle.vehicle import Vehicle

_STATE: Final = common.MavVtolState
_NAMES: Final = {_STATE.FW: "fixed-wing flight", _STATE.MC: "multicopter flight"}
#: The time in which a transition is complete, in seconds.
TRANSITION_TIMEOUT: Final = 60.0


async def transition_to_fixed_wing(
    vehicle: Vehicle, *, wait: bool = True, timeout: float | None = None
) -> None:
    """Change a VTOL that hovers to flight on its wing (MAV_CMD_DO_VTOL_TRANSITION).

    Args:
        wait: Wait until the vehicle flies on its wing.
        timeout: Seconds for the whole call; None sets no overall limit.

    Raises:
        ActionRefused: The vehicle is not armed, or stands on the ground; nothing was sent.
        CommandDenied: The vehicle refused, such as on the ground or in a mode without forward flight.
        ActionUnsupported: The vehicle is no VTOL; nothing was sent.
        ActionTimeout: It was not complete within `timeout`, or within a minute.
        ActionInterrupted: The vehicle was disarmed meanwhile.
        RemoteError: An error that all actions share; see `Vehicle`.
    """
    await _transition(vehicle, _STATE.FW, wait=wait, timeout=timeout)


async def transition_to_multicopter(
    vehicle: Vehicle, *, wait: bool = True, timeout: float | None = None
) -> None:
    """Change a VTOL that flies on its wing to hovering (MAV_CMD_DO_VTOL_TRANSITION).

    Args:
        wait: Wait until the vehicle hovers.
        timeout: Seconds for the whole call; None sets no overall limit.

    Raises:
        ActionRefused: The vehicle is not armed, or stands on the ground; nothing was sent.
        CommandDenied: The vehicle refused, such as on the ground.
        ActionUnsupported: The vehicle is no VTOL; nothing was sent.
        ActionTimeout: It was not complete within `timeout`, or within a minute.
        ActionInterrupted: The vehicle was disarmed meanwhile.
        RemoteError: An error that all actions share; see `Vehicle`.
    """
    await _transition(vehicle, _STATE.MC, wait=wait, timeout=timeout)


async def _transition(
    vehicle: Vehicle, state: common.MavVtolState, *, wait: bool, timeout: float | None
) -> None:
    """Change to a MAV_VTOL_STATE, and wait until EXTENDED_SYS_STATE reports it."""
    operation = f"transition to {_NAMES[state]} of"
    check_preconditions(vehicle, "transition", operation)
    await detect_quadplane(vehicle)
    if vehicle.vehicle_type is not VehicleType.VTOL:
        raise firmware_of(vehicle).unsupported(f"change to {_NAMES[state]}")
    async with ActionMonitor(vehicle, operation, timeout) as monitor:
        command = vehicle.component.command(common.MavCmd.DO_VTOL_TRANSITION, state)
        await with_status_texts(vehicle, command)
        if wait:
            await monitor.wait_until_reached(
                ActionGoal(lambda: vehicle.vtol_state == state, armed=True, stall_timeout=TRANSITION_TIMEOUT)
            )
