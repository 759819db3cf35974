"""Arming, disarming, reboots."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from typing import TYPE_CHECKING, Final, TypeAlias

from mavstack.dialects import common
from mavstack.errors import ActionTimeout, CommandDenied, ContactLost, RemoteCancelled, RemoteTimeout
from mavstack.services.heartbeat import ComponentFound, ComponentLost, ComponentRebooted, ComponentReturned
from mavstack.vehicle.action_monitor import ActionGoal, ActionMonitor
from mavstack.vehicle.status_text_capture import with_status_texts

if TYPE_CHECKING:
    from mavstack.node.subscription import Subscription
    from mavstack.vehicle.vehicle import Vehicle

    _News: TypeAlias = ComponentLost | ComponentRebooted | ComponentReturned | ComponentFound

_CMD: Final = common.MavCmd
#: What ArduPilot and PX4 take as a wish to skip their checks.
FORCE: Final = 21196.0
#: A heartbeat comes once a second, and some may be lost.
CONFIRMED_WITHIN: Final = 10.0
#: How long a vehicle may take to come back from a reboot, in seconds.
REBOOT_LIMIT: Final = 60.0
#: How long to wait for its clock before, in seconds: a quick reboot shows by nothing else.
CLOCK_PATIENCE: Final = 3.0
_BACK: Final = (ComponentRebooted, ComponentReturned, ComponentFound)


async def set_armed(vehicle: Vehicle, *, armed: bool, force: bool) -> None:
    """Arm or disarm, and see that its heartbeat says so."""
    what = "arming" if armed else "disarming"
    async with ActionMonitor(vehicle) as watch:
        asked = vehicle.component.command(_CMD.COMPONENT_ARM_DISARM, float(armed), FORCE if force else 0.0)
        await with_status_texts(vehicle, asked)
        await watch.until(ActionGoal(what, lambda: vehicle.armed == armed, limit=CONFIRMED_WITHIN))


async def reboot(vehicle: Vehicle, *, wait: bool) -> None:
    """Reboot the autopilot, and see it come back.

    It may be gone before its acknowledgement comes: then it is not asked again, lest it reboots once more.
    """
    if wait and vehicle.age(common.SystemTime) is None:
        with suppress(CommandDenied, RemoteTimeout):
            await vehicle.wait_for_message(common.SystemTime, timeout=CLOCK_PATIENCE)
    kinds: tuple[type[_News], ...] = (ComponentLost, *_BACK)
    async with vehicle.connection.events(*kinds) as events:
        news = await _ask_to_reboot(vehicle, events)
        if not wait and isinstance(news, ComponentLost):
            raise ContactLost("reboot", str(vehicle.address), answer="it fell silent and did not acknowledge")
        if not wait or isinstance(news, _BACK):
            return
        try:
            async with asyncio.timeout(REBOOT_LIMIT):
                while not isinstance(news, _BACK):
                    news = await _news_of(vehicle, events)
        except TimeoutError:
            answer = f"did not come back in {REBOOT_LIMIT:g} s"
            raise ActionTimeout("reboot", str(vehicle.address), answer=answer) from None


async def _ask_to_reboot(vehicle: Vehicle, events: Subscription[_News]) -> _News | None:
    """Ask until it is acknowledged, or something happens to the vehicle, which is the result."""
    command = vehicle.component.command(_CMD.PREFLIGHT_REBOOT_SHUTDOWN, 1)
    asking = asyncio.ensure_future(with_status_texts(vehicle, command))
    watching = asyncio.ensure_future(_news_of(vehicle, events))
    try:
        await asyncio.wait((asking, watching), return_when=asyncio.FIRST_COMPLETED)
    finally:
        for task in (asking, watching):
            task.cancel()
        await asyncio.gather(asking, watching, return_exceptions=True)
    if not asking.cancelled():
        asking.result()
    return None if watching.cancelled() else watching.result()


async def _news_of(vehicle: Vehicle, events: Subscription[_News]) -> _News:
    async for event in events:
        if event.component.address == vehicle.address:
            return event
    raise RemoteCancelled("reboot", str(vehicle.address), answer="the connection was closed")
