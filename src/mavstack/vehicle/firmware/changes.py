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
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.errors import ContactLost, MavstackError, RemoteCancelled, RemoteError, RemoteTimeout

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Awaitable, Callable

    from mavstack.vehicle.vehicle import Vehicle

#: Timeout in seconds of reversing the changes of a failed call.
UNDO_TIMEOUT: Final = 8.0
_ARM_DISARM: Final = common.MavCmd.COMPONENT_ARM_DISARM


@dataclass(frozen=True, slots=True)
class _Reversal:
    """The reversal of one change.

    Attributes:
        run: Reverses it.
        text: Returns what it restores, for the error of a call whose change remains.
        is_due: Returns whether the change is still there.
    """

    run: Callable[[], Awaitable[object]]
    text: Callable[[], str]
    is_due: Callable[[], bool] = lambda: True


class Changes:
    """The changes of one call."""

    def __init__(self, vehicle: Vehicle) -> None:
        self._vehicle = vehicle
        self._reversals: list[_Reversal] = []
        #: The former values of the changed parameters that the vehicle reads only at the start of the action.
        self._starting: dict[str, float] = {}
        #: True once a request was sent that may have changed the mode; True once a request was sent that may
        #: have armed the vehicle.
        self.requested = self.arming_requested = False
        #: The texts that describe the changes that remained when the call failed.
        self.kept: tuple[str, ...] = ()

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
        self._reversals.append(
            _Reversal(lambda: self._restore_parameter(name, before), lambda: _parameter_text(name, before))
        )
        if starting:
            self._starting[name] = float(before)

    async def arm(self, force: float) -> None:
        """Arm, with the second parameter of COMPONENT_ARM_DISARM."""
        before = self._vehicle.armed
        self.arming_requested = before is False
        await self._vehicle.component.command(_ARM_DISARM, 1.0, force)
        if before is False:
            self._reversals.append(_Reversal(self._disarm, self._disarmed_text))

    async def undo(self, *, reachable: bool = True) -> tuple[str, ...]:
        """Reverse the changes, the last one first; return the texts of those that could not be reversed.

        Args:
            reachable: False if the vehicle cannot be reached, so that all of them stay.
        """
        kept = []
        self._starting.clear()
        while self._reversals:
            reversal = self._reversals.pop()
            if reversal.is_due() and not (reachable and await _succeeds(reversal.run())):
                kept.append(reversal.text())
        return tuple(kept)

    def unknown(self, mode: str | None) -> tuple[str, ...]:
        """Return the texts of changes by requests whose outcome is not known.

        Args:
            mode: The mode before the call.
        """
        vehicle = self._vehicle
        texts = []
        if self.requested and mode and mode != vehicle.mode:
            texts.append(_mode_text(mode, vehicle.mode))
        if self.arming_requested and vehicle.armed:
            texts.append(self._disarmed_text())
        return tuple(texts)

    async def undo_after_start(self, *, reachable: bool) -> tuple[str, ...]:
        """Restore the parameters that count at the start of the action; return the texts of the others.

        Args:
            reachable: False if the vehicle cannot be reached, so that all of them stay.
        """
        texts = []
        for name, before in self._starting.items():
            if not (reachable and await _succeeds(self._restore_parameter(name, before))):
                texts.append(_parameter_text(name, before))
        self._starting.clear()
        return tuple(texts)

    def _note_mode(self, before: str | None) -> None:
        entered = self._vehicle.mode
        if before is None or entered is None or entered == before:
            return
        restoring = self._vehicle.component.modes.set
        self._reversals.append(
            _Reversal(
                lambda: restoring(before, timeout=UNDO_TIMEOUT),
                lambda: _mode_text(before, entered),
                lambda: self._vehicle.mode == entered,
            )
        )

    async def _restore_parameter(self, name: str, before: float) -> None:
        await self._vehicle.params.set(name, before, timeout=UNDO_TIMEOUT)

    def _disarmed_text(self) -> str:
        return f"disarmed (it {'is' if self._vehicle.armed else 'may be'} armed)"

    async def _disarm(self) -> None:
        await self._vehicle.component.command(_ARM_DISARM, 0.0, 0.0, timeout=UNDO_TIMEOUT)


@asynccontextmanager
async def undone_on_failure(changes: Changes) -> AsyncIterator[None]:
    """Reverse the changes of a block that fails or is cancelled; the error names what remains changed."""
    mode = changes.mode
    try:
        yield
    except BaseException as error:
        kept = await changes.undo(reachable=_is_reachable(error))
        if not kept and isinstance(error, RemoteTimeout):
            kept = changes.unknown(mode)
        changes.kept = kept
        _report_kept(error, kept)
        raise


@asynccontextmanager
async def kept_only_if_reached(changes: Changes) -> AsyncIterator[None]:
    """Restore the parameters of an action that has started if the block fails; a cancelled one keeps them.

    The error of a timeout around the steps of the action names what remained changed after these.
    """
    try:
        yield
    except MavstackError as error:
        kept = await changes.undo_after_start(reachable=_is_reachable(error))
        _report_kept(error, (*changes.kept, *kept))
        raise


def _is_reachable(error: BaseException) -> bool:
    return not isinstance(error, ContactLost | RemoteCancelled)


def _report_kept(error: BaseException, kept: tuple[str, ...]) -> None:
    """Let an error name the changes that could not be undone."""
    if isinstance(error, RemoteError):
        missing = (text for text in kept if text not in error.not_restored)
        error.not_restored = (*error.not_restored, *missing)
    elif kept:
        error.add_note(f"not restored: {', '.join(kept)}")


def _parameter_text(name: str, before: float) -> str:
    return f"parameter {name} {before:g}"


def _mode_text(before: str, now: str | None) -> str:
    return f"mode {before} (it is in {now})"


async def _succeeds(restoring: Awaitable[object]) -> bool:
    try:
        async with asyncio.timeout(UNDO_TIMEOUT):
            await restoring
    except (MavstackError, TimeoutError):
        return False
    return True
