"""Changes of parameters at one end or at both, such that the radios still hear each other afterwards.

A pair is changed over the air that the change may cut off. The remote radio is therefore written and stored
first, while it still runs with its old parameters, then the local one; then both restart, and the pair must
talk again. If the remote radio cannot be written, the local one is not touched. If the pair does not talk
after the restart, the local radio goes back to its old parameters to find a remote radio that did not
restart, and undoes the change; if none is found there, the error says in which state both are and what to
do.
"""

from __future__ import annotations

import asyncio
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from mavstack.errors import InvalidArgumentError, RadioError
from mavstack.radio.parameters import BAUD_RATES, SHARED
from mavstack.radio.session import Reply
from mavstack.radio.sik_radio import SikRadio, check_values, require_known

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from mavstack.radio.modem import SikModem
    from mavstack.radio.replies import StoredParameter

#: Attempts to reach the remote radio after a restart, and seconds between them: radios need time to find each
#: other.
REUNION_ATTEMPTS, REUNION_PAUSE = 6, 2.0
_POWER_CYCLE: Final = "switch the remote radio off and on; it has stored the new parameters"


@dataclass(frozen=True, slots=True)
class Change:
    """The changes of one radio.

    Attributes:
        radio: The radio.
        known: Its parameters before.
        values: The new values of those that differ, by name.
    """

    radio: SikRadio
    known: Mapping[str, StoredParameter]
    values: Mapping[str, int]

    @property
    def old(self) -> dict[str, int]:
        """The values before, by name."""
        return {name: self.known[name].value for name in self.values}

    @property
    def baud(self) -> int | None:
        """Baud rate after the restart, if it changes."""
        return BAUD_RATES.get(self.values.get("SERIAL_SPEED", 0))

    async def write(self, values: Mapping[str, int]) -> None:
        """Set and store values; undone as far as possible if the radio fails."""
        try:
            for name, value in values.items():
                await self.radio.set_value(self.known[name].number, value)
            await self.radio.store()
        except RadioError:
            with suppress(RadioError):
                for name in values:
                    await self.radio.set_value(self.known[name].number, self.known[name].value)
            raise


async def plan_change(radio: SikRadio, values: Mapping[str, int]) -> Change:
    """Read the parameters of a radio, and return the values that differ from it.

    Args:
        radio: The radio.
        values: The wanted values by name.

    Raises:
        InvalidArgumentError: A value is not valid, or the radio has no such parameter.
        RadioError: The radio does not answer.
    """
    check_values(values)
    known = await radio.get_parameters()
    require_known(values, known, radio)
    return Change(radio, known, {name: value for name, value in values.items() if known[name].value != value})


async def change_one(radio: SikRadio, values: Mapping[str, int]) -> Change:
    """Set, store and apply parameters of one radio by a restart.

    A remote radio with other shared parameters cannot be heard any more.

    Args:
        radio: The radio.
        values: The wanted values by name.

    Returns:
        The values that changed.

    Raises:
        InvalidArgumentError: A value is not valid, or the radio has no such parameter.
        RadioError: The radio does not answer or refuses a value; nothing is stored then.
    """
    change = await plan_change(radio, values)
    if change.values:
        await change.write(change.values)
        await radio.restart(baud=change.baud)
        if not radio.remote:
            await _require_values(change)
    return change


async def change_both(
    modem: SikModem,
    local: Mapping[str, int],
    remote: Mapping[str, int],
    on_step: Callable[[str], None] = lambda text: None,
) -> tuple[Change, Change]:
    """Set, store and apply parameters of both radios, and wait until they talk again.

    Args:
        modem: The modem of the local radio.
        local: The wanted values of the local radio by name.
        remote: The wanted values of the remote radio.
        on_step: Called with each step, in a few words.

    Returns:
        The changes of the local and of the remote radio.

    Raises:
        InvalidArgumentError: A value is not valid, a radio has no such parameter, or the shared parameters
            would differ.
        RadioError: A radio does not answer or refuses a value; the text says in which state both are.
    """
    near, far = SikRadio(modem), SikRadio(modem, remote=True)
    changes = await plan_change(near, local), await _plan_remote(far, remote)
    mine, theirs = changes
    if not (mine.values or theirs.values):
        return changes
    _require_equal(mine, theirs)
    on_step("writing the remote radio")
    await _write_remote(theirs)
    on_step("writing the local radio")
    await _write_local(mine, theirs)
    on_step("restarting both")
    await _restart_both(mine, theirs)
    on_step("waiting until they talk again")
    if not await talks(far):
        await _undo(mine, theirs, on_step)
    for change in changes:
        await _require_values(change)
    return changes


async def talks(far: SikRadio, attempts: int = REUNION_ATTEMPTS) -> bool:
    """Return whether the remote radio answers.

    Args:
        far: The remote radio.
        attempts: Attempts, with a pause after each.
    """
    for attempt in range(attempts):
        if attempt:
            await asyncio.sleep(REUNION_PAUSE)
        with suppress(RadioError):
            await far.run("I", Reply.LINE, attempts=1)
            return True
    return False


def shared_differences(
    local: Mapping[str, StoredParameter], remote: Mapping[str, StoredParameter]
) -> dict[str, tuple[int, int]]:
    """Return the shared parameters that differ.

    Args:
        local: The parameters of the local radio.
        remote: The parameters of the remote radio.

    Returns:
        The local and the remote value by name.
    """
    return {
        name: (local[name].value, remote[name].value)
        for name in local
        if name in SHARED and name in remote and local[name].value != remote[name].value
    }


def _require_equal(mine: Change, theirs: Change) -> None:
    """Raise an error if the shared parameters would differ after the restart."""
    local, remote = (
        {name: change.values.get(name, each.value) for name, each in change.known.items()}
        for change in (mine, theirs)
    )
    differing = sorted(name for name in SHARED & local.keys() & remote.keys() if local[name] != remote[name])
    if differing:
        raise InvalidArgumentError(
            f"the radios would lose each other: they differ in {', '.join(differing)}; set these at both"
        )


async def _plan_remote(far: SikRadio, values: Mapping[str, int]) -> Change:
    try:
        return await plan_change(far, values)
    except RadioError as error:
        raise RadioError(
            f"{error}; nothing was changed. To change this radio alone use --local, and the other one by its "
            "own cable"
        ) from None


async def _write_remote(theirs: Change) -> None:
    try:
        if theirs.values:
            await theirs.write(theirs.values)
    except RadioError as error:
        raise RadioError(
            f"writing the remote radio failed: {error}; the local radio was not changed. "
            "Run `mav radio show --both` to see both before another attempt"
        ) from None


async def _write_local(mine: Change, theirs: Change) -> None:
    try:
        if mine.values:
            await mine.write(mine.values)
    except RadioError as error:
        try:
            if theirs.values:
                await theirs.write(theirs.old)
        except RadioError:
            raise RadioError(
                f"writing the local radio failed: {error}; the remote radio has stored "
                f"{_text(theirs.values)} and uses it after its next start: set it back while it still answers"
            ) from None
        raise RadioError(
            f"writing the local radio failed: {error}; the remote radio has its old parameters again"
        ) from None


async def _restart_both(mine: Change, theirs: Change) -> None:
    with suppress(RadioError):  # the caller looks for the remote radio afterwards
        if theirs.values:
            await theirs.radio.restart()
            await theirs.radio.restart()  # in case the radio did not receive the first
    try:
        await mine.radio.restart(baud=mine.baud)
    except RadioError as error:
        raise RadioError(
            f"restarting the local radio failed: {error}; both have stored the new parameters: "
            "switch both off and on"
        ) from None


async def _undo(mine: Change, theirs: Change, on_step: Callable[[str], None]) -> None:
    """Look for a remote radio that did not restart, undo the change, and raise an error."""
    on_step("no answer: looking for the remote radio with the old parameters")
    back_baud = BAUD_RATES.get(mine.old.get("SERIAL_SPEED", 0))
    if mine.values:
        await mine.write(mine.old)
        await mine.radio.restart(baud=back_baud)
        if await talks(theirs.radio, 3):
            if theirs.values:
                await theirs.write(theirs.old)
            raise RadioError("the radios did not talk after the change; both have their old parameters again")
        await mine.write(mine.values)
        await mine.radio.restart(baud=mine.baud)
    state = f"the local radio has {_text(mine.values)}" if mine.values else "the local radio was not changed"
    raise RadioError(
        f"the remote radio does not answer after the change; {state}. Do this: {_POWER_CYCLE}. "
        f"If it stays silent, connect it by its own cable and set {_text(theirs.values or mine.values)}"
    )


async def _require_values(change: Change) -> None:
    """Raise an error if a radio has other values after its restart than it was given."""
    present = await change.radio.get_parameters()
    wrong = {
        name: present[name].value
        for name, value in change.values.items()
        if name in present and present[name].value != value and name not in _ROUNDED
    }
    if wrong:
        raise RadioError(f"the {change.radio.name} radio has {_text(wrong)} after its restart")


#: Parameters for which the radio stores the nearest value that it supports.
_ROUNDED: Final = frozenset({"AIR_SPEED", "TXPOWER", "MIN_FREQ", "MAX_FREQ", "NUM_CHANNELS"})


def _text(values: Mapping[str, int]) -> str:
    return ", ".join(f"{name}={value}" for name, value in values.items())
