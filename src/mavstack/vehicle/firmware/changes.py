"""The changes that the steps of one call make on a vehicle, and their reversal if a later step fails.

An action may need several steps: a parameter, a mode, the command itself. A call that is refused at its last
step must leave the vehicle as it was before the first. So every step of a firmware class that changes a mode,
a parameter or the armed state goes through its `Changes`, and `undone_on_failure` reverses them, the last one
first:

    changes = Changes(vehicle)
    async with undone_on_failure(changes):
        await changes.set_parameter("TKOFF_ALT", 12.0)
        await changes.set_mode("TAKEOFF")

Only what a step changed is changed back: a mode that a pilot or a failsafe has selected since is kept. A step
whose outcome is not known, since its acknowledgement was lost, is not reversed: the vehicle may fly by it.
The error names each difference that remains (`RemoteError.not_restored`).
"""

from __future__ import annotations

import asyncio
from contextlib import asynccontextmanager
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.errors import ContactLost, MavstackError, RemoteCancelled, RemoteError, RemoteTimeout

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Awaitable, Callable

    from mavstack.vehicle.firmware.interface import FirmwareVehicle

#: The time in which the changes of a failed call are reversed, in seconds.
UNDO_TIMEOUT: Final = 8.0


class Changes:
    """The changes of one call."""

    def __init__(self, vehicle: FirmwareVehicle) -> None:
        self._vehicle = vehicle
        #: How to reverse each change: returns the text of a change that could not be reversed.
        self._reversals: list[Callable[[], Awaitable[str | None]]] = []
        #: The parameters that the vehicle reads at the start of the action only, and their values before.
        self._starting: dict[str, float] = {}
        #: True once a request was sent that may have changed the mode.
        self.requested = False

    @property
    def mode(self) -> str | None:
        """The mode of the vehicle now."""
        return self._vehicle.mode

    async def set_mode(self, mode: str | int) -> None:
        """Enter a mode of the firmware."""
        before = self._vehicle.mode
        self.requested = True
        await self._vehicle.component.modes.set(mode)
        self._note_mode(before)

    async def set_standard_mode(self, mode: int) -> None:
        """Enter a MAV_STANDARD_MODE."""
        before = self._vehicle.mode
        self.requested = True
        await self._vehicle.component.modes.set_standard(mode)
        self._note_mode(before)

    async def set_parameter(self, name: str, value: float, *, starting: bool = False) -> None:
        """Set a parameter, unless it has the value.

        Args:
            name: The name.
            value: The value.
            starting: True if the vehicle reads it at the start of the action only; then it is restored also
                if the action fails after its start.
        """
        before = (await self._vehicle.params.get(name)).value
        if before == value:
            return
        await self._vehicle.params.set(name, value)
        self._reversals.append(lambda: self._restore_parameter(name, before))
        if starting:
            self._starting[name] = float(before)

    async def arm(self, force: float) -> None:
        """Arm, with the second parameter of COMPONENT_ARM_DISARM."""
        before = self._vehicle.armed
        await self._vehicle.component.command(common.MavCmd.COMPONENT_ARM_DISARM, 1.0, force)
        if before is False:
            self._reversals.append(self._disarm)

    async def undo(self) -> tuple[str, ...]:
        """Reverse the changes, the last one first; return the texts of those that could not be reversed."""
        kept = []
        self._starting.clear()
        while self._reversals:
            text = await self._reversals.pop()()
            if text is not None:
                kept.append(text)
        return tuple(kept)

    async def undo_after_start(self, *, reachable: bool) -> tuple[str, ...]:
        """Restore the parameters that count at the start of the action; return the texts of the others.

        Args:
            reachable: False if the vehicle cannot be reached, so that all of them stay.
        """
        texts = []
        for name, before in self._starting.items():
            text = await self._restore_parameter(name, before) if reachable else _parameter_text(name, before)
            texts += [] if text is None else [text]
        self._starting.clear()
        return tuple(texts)

    def _note_mode(self, before: str | None) -> None:
        entered = self._vehicle.mode
        if before is not None and entered is not None and entered != before:
            self._reversals.append(lambda: self._restore_mode(before, entered))

    async def _restore_mode(self, before: str, entered: str) -> str | None:
        if self._vehicle.mode != entered:
            return None
        restoring = self._vehicle.component.modes.set(before, timeout=UNDO_TIMEOUT)
        return await _outcome(restoring, f"mode {before} (it is in {entered})")

    async def _restore_parameter(self, name: str, before: float) -> str | None:
        restoring = self._vehicle.params.set(name, before, timeout=UNDO_TIMEOUT)
        return await _outcome(restoring, _parameter_text(name, before))

    async def _disarm(self) -> str | None:
        disarming = self._vehicle.component.command(
            common.MavCmd.COMPONENT_ARM_DISARM, 0.0, 0.0, timeout=UNDO_TIMEOUT
        )
        return await _outcome(disarming, "disarmed (it is armed)")


@asynccontextmanager
async def undone_on_failure(changes: Changes) -> AsyncIterator[None]:
    """Reverse the changes of a block that fails or is cancelled; the error names what remains changed."""
    mode = changes.mode
    try:
        yield
    except BaseException as error:
        kept = await changes.undo()
        unknown = changes.requested and isinstance(error, RemoteTimeout)
        if not kept and unknown and mode and mode != changes.mode:
            kept = (f"mode {mode} (it is in {changes.mode})",)
        _report_kept(error, kept)
        raise


@asynccontextmanager
async def kept_only_if_reached(changes: Changes) -> AsyncIterator[None]:
    """Restore the parameters of an action that has started if the block fails; a cancelled one keeps them."""
    try:
        yield
    except MavstackError as error:
        reachable = not isinstance(error, ContactLost | RemoteCancelled)
        _report_kept(error, await changes.undo_after_start(reachable=reachable))
        raise


def _report_kept(error: BaseException, kept: tuple[str, ...]) -> None:
    """Let an error name the changes that could not be undone."""
    if kept and isinstance(error, RemoteError):
        error.not_restored = (*error.not_restored, *kept)
    elif kept:
        error.add_note(f"not restored: {', '.join(kept)}")


def _parameter_text(name: str, before: float) -> str:
    return f"parameter {name} {before:g}"


async def _outcome(restoring: Awaitable[object], text: str) -> str | None:
    try:
        async with asyncio.timeout(UNDO_TIMEOUT):
            await restoring
    except (MavstackError, TimeoutError):
        return text
    return None
