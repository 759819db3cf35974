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
    from mavstack.vehicle.vehicle import Vehicle

    _Event: TypeAlias = ComponentLost | ComponentRebooted | ComponentReturned | ComponentFound

_CMD: Final = common.MavCmd
#: Param 2 of COMPONENT_ARM_DISARM that makes ArduPilot and PX4 skip their checks.
FORCE: Final = 21196.0
#: The time in which a heartbeat must confirm the armed state, in seconds: heartbeats arrive once per second,
#: and some may be lost.
CONFIRMATION_TIMEOUT: Final = 10.0
#: The time in which a vehicle must be back after a reboot, in seconds.
REBOOT_TIMEOUT: Final = 60.0
#: The time to wait for the vehicle's clock before a reboot, in seconds: only the clock shows that a quick
#: reboot happened.
CLOCK_TIMEOUT: Final = 3.0
_ARMING: Final = "arming"
_ALLOW: Final = "allow_flight=True (--allow-flight) arms it anyway"
_REBOOTING: Final = "rebooting"
_BACK: Final = (ComponentRebooted, ComponentReturned, ComponentFound)


async def arm(
    vehicle: Vehicle,
    *,
    force: bool = False,
    allow_flight: bool = False,
    keep_mode: bool = False,
    timeout: float | None = None,
) -> None:
    """Arm the vehicle: let its motors run (MAV_CMD_COMPONENT_ARM_DISARM).

    A vehicle stays in RTL, LAND or AUTO after its landing, where most firmwares do not arm. Then it first
    enters the mode in which it waits on the ground: GUIDED (ArduPilot's copters), FLY_BY_WIRE_A (planes),
    HOLD (rovers) or LOITER (PX4). In a mode that starts by itself, such as TAKEOFF or MISSION, arming is
    refused. If the vehicle refuses to arm, its mode is restored.

    Args:
        force: Skip the firmware's checks, as far as it allows that.
        allow_flight: Arm in a mode in which the vehicle starts to fly or drive at once.
        keep_mode: Refuse instead of leaving a mode in which the firmware does not arm.
        timeout: Seconds for the whole call; None: until retries are exhausted or progress stalls.

    Raises:
        ActionRefused: The mode would start a flight, or does not allow arming; nothing was sent.
        CommandDenied: The vehicle refused; the text holds the failed checks.
        CommandTimeout: The vehicle did not answer.
        ActionTimeout: The vehicle accepted, and its heartbeat did not confirm it in time.
        ContactLost: No heartbeat of the vehicle arrives.
        RemoteCancelled: The connection was closed, or a disarming came before the vehicle armed.
    """
    changes = Changes(vehicle)
    await arm_as_step(
        vehicle, changes, force=force, allow_flight=allow_flight, keep_mode=keep_mode, timeout=timeout
    )


async def arm_as_step(
    vehicle: Vehicle,
    changes: Changes,
    *,
    force: bool = False,
    allow_flight: bool = False,
    keep_mode: bool = False,
    timeout: float | None = None,
) -> None:
    """Arm, and wait until a heartbeat confirms it, as a step of a call that has these changes."""
    check_preconditions(vehicle, "arm", _ARMING)
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


async def disarm(vehicle: Vehicle, *, force: bool = False, timeout: float | None = None) -> None:
    """Disarm the vehicle: stop its motors (MAV_CMD_COMPONENT_ARM_DISARM).

    Args:
        force: Stop the motors even in the air.
        timeout: Seconds for the whole call; None: until retries are exhausted or progress stalls.

    Raises:
        CommandDenied: The vehicle refused, such as in the air.
        CommandTimeout: The vehicle did not answer.
        ActionTimeout: The vehicle accepted, and its heartbeat did not confirm it in time.
        ContactLost: No heartbeat of the vehicle arrives.
        RemoteCancelled: The connection was closed.
    """
    check_preconditions(vehicle, "disarm", "disarming")
    async with ActionMonitor(vehicle, "disarming", timeout) as monitor:
        command = vehicle.component.command(_CMD.COMPONENT_ARM_DISARM, 0.0, FORCE if force else 0.0)
        await with_status_texts(vehicle, command, "disarming")
        await monitor.wait_until_reached(_confirmed(vehicle, armed=False))


async def enter_waiting_mode(vehicle: Vehicle, changes: Changes) -> None:
    """Enter the mode in which the vehicle waits on the ground when it is armed, if there is a known one."""
    firmware = firmware_of(vehicle, changes)
    if firmware.waiting_mode:
        await firmware.changes.set_mode(firmware.waiting_mode)


def _leaves_mode(vehicle: Vehicle, *, allow_flight: bool, keep_mode: bool) -> bool:
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


def _confirmed(vehicle: Vehicle, *, armed: bool) -> ActionGoal:
    return ActionGoal(lambda: vehicle.armed == armed, stall_timeout=CONFIRMATION_TIMEOUT)


async def terminate(vehicle: Vehicle, *, timeout: float | None = None) -> None:
    """Terminate the flight: stop the motors permanently, wherever the vehicle is. It crashes.

    Only a reboot ends the termination. ArduPilot may need AFS_ENABLE for it
    (MAV_CMD_DO_FLIGHTTERMINATION).

    Args:
        timeout: Seconds for the whole call; None: until retries are exhausted or progress stalls.

    Raises:
        CommandDenied: The vehicle refused, such as PX4 while it is disarmed.
        ActionTimeout: The vehicle accepted, and its heartbeat did not confirm it in time.
        RemoteError: An error that all actions share; see `Vehicle`.
    """
    check_preconditions(vehicle, "terminate", "flight termination of")

    def terminated() -> bool:
        return vehicle.armed is False or vehicle.system_status == common.MavState.FLIGHT_TERMINATION

    async with ActionMonitor(vehicle, "flight termination of", timeout) as monitor:
        await with_status_texts(vehicle, vehicle.component.command(_CMD.DO_FLIGHTTERMINATION, 1))
        await monitor.wait_until_reached(ActionGoal(terminated, stall_timeout=CONFIRMATION_TIMEOUT))


async def reboot(vehicle: Vehicle, *, wait: bool = True, timeout: float | None = None) -> None:
    """Reboot the autopilot (MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN).

    It may be gone before its acknowledgement arrives; then the command is not repeated, since that would
    reboot it once more.

    Args:
        wait: Wait until the autopilot is back.
        timeout: Seconds for the whole call; None: until retries are exhausted, or it stays away.

    Raises:
        CommandDenied: The vehicle refused, such as in the air.
        CommandTimeout: The vehicle did not answer.
        ContactLost: Without `wait`: the vehicle fell silent and did not acknowledge.
        ActionTimeout: The vehicle did not come back in time.
        RemoteCancelled: The connection was closed.
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


async def _wait_until_back(vehicle: Vehicle, events: Subscription[_Event]) -> None:
    try:
        async with asyncio.timeout(REBOOT_TIMEOUT):
            while not isinstance(await _next_event(vehicle, events), _BACK):
                pass
    except TimeoutError:
        answer = f"did not come back in {REBOOT_TIMEOUT:g} s"
        raise ActionTimeout(_REBOOTING, str(vehicle.address), answer=answer) from None


async def _request_reboot(vehicle: Vehicle, events: Subscription[_Event]) -> _Event | None:
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


async def _next_event(vehicle: Vehicle, events: Subscription[_Event]) -> _Event:
    async for event in events:
        if event.component.address == vehicle.address:
            return event
    raise RemoteCancelled(_REBOOTING, str(vehicle.address), answer="the connection was closed")
