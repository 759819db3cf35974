"""Arming, disarming, termination and rebooting.

A vehicle that is armed in TAKEOFF, AUTO or MISSION starts to fly at once, so arming there is refused unless
the program allows the flight. In RTL, LAND or AUTO, in which a vehicle stays after its landing, most
firmwares do not arm; arming then enters the mode in which the vehicle waits on the ground
(`Firmware.WAITING_MODES`). If arming is refused, or no heartbeat confirms it, the vehicle is disarmed and in
the mode of before again, or the error names what remained.
"""

from __future__ import annotations

import asyncio
from contextlib import suppress
from typing import TYPE_CHECKING, Final, TypeAlias

from mavstack.dialects import common
from mavstack.errors import ActionTimeout, CommandDenied, ContactLost, RemoteCancelled, RemoteTimeout
from mavstack.services.heartbeat import ComponentFound, ComponentLost, ComponentRebooted, ComponentReturned
from mavstack.vehicle.action_monitor import ActionGoal, ActionMonitor
from mavstack.vehicle.actions.preconditions import check_preconditions, refusal
from mavstack.vehicle.deadline import deadline
from mavstack.vehicle.firmware import firmware_of
from mavstack.vehicle.firmware.changes import Changes, kept_only_if_reached, undone_on_failure
from mavstack.vehicle.status_text_capture import with_status_texts

if TYPE_CHECKING:
    from mavstack.node.subscription import Subscription
    from mavstack.vehicle.vehicle_state import VehicleState

    _Event: TypeAlias = ComponentLost | ComponentRebooted | ComponentReturned | ComponentFound

_CMD: Final = common.MavCmd
#: Param 2 of COMPONENT_ARM_DISARM that makes ArduPilot and PX4 skip their checks.
FORCE: Final = 21196.0
#: The time in which a heartbeat confirms the armed state, in seconds: one per second, and some may be lost.
CONFIRMATION_TIMEOUT: Final = 10.0
#: The time in which a vehicle is back after a reboot, in seconds.
REBOOT_TIMEOUT: Final = 60.0
#: The time to wait for the vehicle's clock before a reboot, in seconds: only the clock shows a quick reboot.
CLOCK_TIMEOUT: Final = 3.0
_ARMING: Final = "arming"
_ALLOW: Final = "allow_flight=True (--allow-flight) arms it anyway"
_REBOOTING: Final = "rebooting"
_BACK: Final = (ComponentRebooted, ComponentReturned, ComponentFound)


async def arm(
    vehicle: VehicleState,
    changes: Changes | None = None,
    *,
    force: bool = False,
    allow_flight: bool = False,
    keep_mode: bool = False,
    timeout: float | None = None,
) -> None:
    """Arm, and wait until a heartbeat confirms it; `changes` are those of a call that arms as one step."""
    check_preconditions(vehicle, "arm", _ARMING)
    changes = Changes(vehicle) if changes is None else changes
    leaves = _leaves_mode(vehicle, allow_flight=allow_flight, keep_mode=keep_mode)
    async with (
        kept_only_if_reached(changes),
        ActionMonitor(vehicle, _ARMING, timeout) as monitor,
        undone_on_failure(changes),
    ):
        if leaves:
            await with_status_texts(vehicle, enter_waiting_mode(vehicle, changes))
        await with_status_texts(vehicle, changes.arm(FORCE if force else 0.0), _ARMING)
        await monitor.wait_until_reached(_confirmed(vehicle, armed=True))


async def disarm(vehicle: VehicleState, *, force: bool, timeout: float | None) -> None:
    """Disarm, and wait until a heartbeat confirms it."""
    check_preconditions(vehicle, "disarm", "disarming")
    async with ActionMonitor(vehicle, "disarming", timeout) as monitor:
        command = vehicle.component.command(_CMD.COMPONENT_ARM_DISARM, 0.0, FORCE if force else 0.0)
        await with_status_texts(vehicle, command, "disarming")
        await monitor.wait_until_reached(_confirmed(vehicle, armed=False))


async def enter_waiting_mode(vehicle: VehicleState, changes: Changes) -> None:
    """Enter the mode in which the vehicle waits on the ground when it is armed, if there is a known one."""
    firmware = firmware_of(vehicle, changes)
    if firmware.waiting_mode:
        await firmware.set_mode(firmware.waiting_mode)


def _leaves_mode(vehicle: VehicleState, *, allow_flight: bool, keep_mode: bool) -> bool:
    """Return whether arming has to leave the present mode; raise if it may not arm there."""
    if vehicle.armed is not False:
        return False
    firmware, mode = firmware_of(vehicle), vehicle.mode
    starts, arms = firmware.starts_by_itself(mode), firmware.allows_arming(mode)
    if allow_flight and starts:
        return False
    if arms:
        if starts:
            remedy = f"change the mode{_to(firmware.waiting_mode)} first, or {_ALLOW}"
            raise refusal(vehicle, _ARMING, f"in mode {mode} it would start by itself; {remedy}")
        return False
    if keep_mode or not firmware.waiting_mode:
        raise refusal(
            vehicle,
            _ARMING,
            f"it does not arm in mode {mode}; change the mode{_to(firmware.waiting_mode)} first",
        )
    return True


def _to(mode: str) -> str:
    return f" to {mode}" if mode else ""


def _confirmed(vehicle: VehicleState, *, armed: bool) -> ActionGoal:
    return ActionGoal(lambda: vehicle.armed == armed, stall_timeout=CONFIRMATION_TIMEOUT)


async def terminate(vehicle: VehicleState, *, timeout: float | None) -> None:
    """Terminate the flight, and wait until a heartbeat confirms it."""
    check_preconditions(vehicle, "terminate", "flight termination of")

    def terminated() -> bool:
        return vehicle.armed is False or vehicle.system_status == common.MavState.FLIGHT_TERMINATION

    async with ActionMonitor(vehicle, "flight termination of", timeout) as monitor:
        await with_status_texts(vehicle, vehicle.component.command(_CMD.DO_FLIGHTTERMINATION, 1))
        await monitor.wait_until_reached(ActionGoal(terminated, stall_timeout=CONFIRMATION_TIMEOUT))


async def reboot(vehicle: VehicleState, *, wait: bool, timeout: float | None) -> None:
    """Reboot the autopilot, and wait until it is back.

    It may be gone before its acknowledgement arrives; then the command is not repeated, since that would
    reboot it once more.
    """
    check_preconditions(vehicle, "reboot", _REBOOTING)
    async with deadline(timeout, _REBOOTING, vehicle.address):
        if wait and vehicle.age(common.SystemTime) is None:
            with suppress(CommandDenied, RemoteTimeout):
                await vehicle.wait_for_message(common.SystemTime, timeout=CLOCK_TIMEOUT)
        kinds: tuple[type[_Event], ...] = (ComponentLost, *_BACK)
        async with vehicle.connection.events(*kinds) as events:
            event = await _request_reboot(vehicle, events)
            if not wait and isinstance(event, ComponentLost):
                answer = "it fell silent without an acknowledgement"
                raise ContactLost(_REBOOTING, str(vehicle.address), answer=answer)
            if wait and not isinstance(event, _BACK):
                await _wait_until_back(vehicle, events)


async def _wait_until_back(vehicle: VehicleState, events: Subscription[_Event]) -> None:
    try:
        async with asyncio.timeout(REBOOT_TIMEOUT):
            while not isinstance(await _next_event(vehicle, events), _BACK):
                pass
    except TimeoutError:
        answer = f"did not come back in {REBOOT_TIMEOUT:g} s"
        raise ActionTimeout(_REBOOTING, str(vehicle.address), answer=answer) from None


async def _request_reboot(vehicle: VehicleState, events: Subscription[_Event]) -> _Event | None:
    """Send the command until it is acknowledged; return the event that made it needless, if any."""
    command = vehicle.component.command(_CMD.PREFLIGHT_REBOOT_SHUTDOWN, 1)
    acknowledged = asyncio.ensure_future(with_status_texts(vehicle, command))
    event = asyncio.ensure_future(_next_event(vehicle, events))
    try:
        await asyncio.wait((acknowledged, event), return_when=asyncio.FIRST_COMPLETED)
    finally:
        for task in (acknowledged, event):
            task.cancel()
        await asyncio.gather(acknowledged, event, return_exceptions=True)
    if not acknowledged.cancelled():
        acknowledged.result()
    return None if event.cancelled() else event.result()


async def _next_event(vehicle: VehicleState, events: Subscription[_Event]) -> _Event:
    async for event in events:
        if event.component.address == vehicle.address:
            return event
    raise RemoteCancelled(_REBOOTING, str(vehicle.address), answer="the connection was closed")
