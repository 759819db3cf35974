"""Setting many parameters of a vehicle, with a result for each.

    for result in await apply(vehicle.params, file.by_name().values()):
        print(result.name, result.outcome.value, result.reason)

The vehicle's parameters are fetched first, so what it holds already is not sent. What belongs to one vehicle
alone (its counters, its id, the calibration of its sensors) and what the file marks @READONLY is left out
unless `everything` asks for it. Parameters that reveal others (`*_ENABLE`) are set first; what the vehicle
did not know is looked for again after that, as often as something new was set. Its system id is set last,
since it answers under another address from then on.

`ParameterLoad.results` has an entry for each parameter at every moment, also if the load is cancelled or the
link breaks: what was not tried says so.
"""

from __future__ import annotations

import asyncio
from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING

from mavstack.errors import MavstackError, RemoteError, RemoteTimeout
from mavstack.files.parameters.compare import is_same, matched
from mavstack.files.parameters.kinds import needs_reboot, owner_of, turn_of
from mavstack.services.parameters.value import fitted, type_name

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from mavstack.files.parameters.stored import StoredParameter
    from mavstack.node.params import Params
    from mavstack.services.parameters import Parameter

#: So many are on their way at once.
AT_ONCE = 8
#: So often it is looked whether what was set revealed others.
MOST_ROUNDS = 5
#: After so many in a row that were not answered, no more are tried.
MOST_SILENT = 3
_LAST_TURN = 2


class Outcome(Enum):
    """What became of a parameter."""

    SET = "set"
    UNCHANGED = "unchanged"
    SKIPPED = "skipped"
    REFUSED = "refused"
    UNKNOWN = "unknown"
    UNANSWERED = "unanswered"
    UNTRIED = "untried"


_GOOD = frozenset({Outcome.SET, Outcome.UNCHANGED, Outcome.SKIPPED})


@dataclass(frozen=True, slots=True)
class Applied:
    """What became of one parameter: as it was to be, as it was, and as it is, if that is known."""

    wanted: StoredParameter
    outcome: Outcome = Outcome.UNTRIED
    before: Parameter | None = None
    after: Parameter | None = None
    reason: str = ""

    @property
    def name(self) -> str:
        """The name, as the vehicle writes it if it has it."""
        return self.wanted.name if self.before is None else self.before.name

    @property
    def ok(self) -> bool:
        """Whether the vehicle holds the value, or was not meant to."""
        return self.outcome in _GOOD

    @property
    def needs_reboot(self) -> bool:
        """Whether a new value was set that is known to count only after a reboot."""
        return self.outcome is Outcome.SET and needs_reboot(self.name)


class ParameterLoad:
    """Sets parameters of one component; `run` it once."""

    def __init__(
        self,
        parameters: Params,
        wanted: Iterable[StoredParameter],
        *,
        everything: bool = False,
        dry_run: bool = False,
        tell: Callable[[Applied], None] | None = None,
    ) -> None:
        self._parameters = parameters
        self._everything = everything
        self._dry_run = dry_run
        self._tell = tell
        self._silent = 0
        self._set_any = False
        self._slots = asyncio.Semaphore(AT_ONCE)
        self._results = {each.name: Applied(each) for each in wanted}

    @property
    def results(self) -> tuple[Applied, ...]:
        """What became of each so far, in the order in which they were given."""
        return tuple(self._results.values())

    async def run(
        self, *, timeout: float | None = None, progress: Callable[[int, int], None] | None = None
    ) -> tuple[Applied, ...]:
        """Do it; raises only if the vehicle's parameters cannot be fetched to begin with.

        `timeout` and `progress` are those of fetching them.
        """
        await self._parameters.download(timeout=timeout, progress=progress)
        unknown = await self._rounds([each.name for each in self.results if turn_of(each.name) < _LAST_TURN])
        unknown += await self._set_known(
            [each.name for each in self.results if turn_of(each.name) == _LAST_TURN]
        )
        for name in unknown:
            self._ended(name, Outcome.UNKNOWN, "the vehicle has no such parameter")
        return self.results

    async def _rounds(self, names: list[str]) -> list[str]:
        """Set what the vehicle knows, again while that reveals more; gives what it never knew."""
        unknown = names
        for _ in range(MOST_ROUNDS):
            self._set_any = False
            unknown = await self._set_known(unknown)
            if not (unknown and self._set_any) or self._gave_up:
                break
            try:
                await self._parameters.download()
            except RemoteError:
                break
        return unknown

    async def _set_known(self, names: list[str]) -> list[str]:
        """Set those that the vehicle knows, in their turns; gives the others."""
        pairs = matched(names, self._parameters.cached)
        for turn in sorted({turn_of(name) for name in pairs}):
            async with asyncio.TaskGroup() as group:
                for name, theirs in pairs.items():
                    if turn_of(name) == turn:
                        group.create_task(self._apply(name, self._parameters.cached[theirs]))
        return [name for name in names if name not in pairs]

    async def _apply(self, name: str, held: Parameter) -> None:
        wanted = self._results[name].wanted
        if is_same(wanted, held):
            self._ended(name, Outcome.UNCHANGED, before=held, after=held)
            return
        reason = "" if self._everything else _reason_to_skip(wanted)
        if reason:
            self._ended(name, Outcome.SKIPPED, reason, before=held, after=held)
        elif fitted(wanted.value, int(held.type)) is None:
            answer = f"its type {type_name(int(held.type))} cannot hold {wanted.value}"
            self._ended(name, Outcome.REFUSED, answer, before=held, after=held)
        elif self._dry_run:
            self._ended(name, Outcome.SET, before=held, after=held)
        else:
            async with self._slots:
                await self._set(name, wanted, held)

    async def _set(self, name: str, wanted: StoredParameter, held: Parameter) -> None:
        if self._gave_up:
            self._ended(name, Outcome.UNTRIED, "the vehicle no longer answers", before=held)
            return
        try:
            after = await self._parameters.set(held.name, wanted.value)
        except RemoteTimeout as error:
            self._silent += 1
            self._ended(name, Outcome.UNANSWERED, error.answer, before=held)
        except MavstackError as error:
            self._silent = 0
            answer = error.answer if isinstance(error, RemoteError) else str(error)
            self._ended(name, Outcome.REFUSED, answer, before=held, after=held)
        else:
            self._silent, self._set_any = 0, True
            self._ended(name, Outcome.SET, before=held, after=after)

    @property
    def _gave_up(self) -> bool:
        return self._silent >= MOST_SILENT

    def _ended(
        self,
        name: str,
        outcome: Outcome,
        reason: str = "",
        *,
        before: Parameter | None = None,
        after: Parameter | None = None,
    ) -> None:
        result = Applied(self._results[name].wanted, outcome, before, after, reason)
        self._results[name] = result
        if self._tell is not None:
            self._tell(result)


async def apply(
    parameters: Params,
    wanted: Iterable[StoredParameter],
    *,
    everything: bool = False,
    dry_run: bool = False,
    tell: Callable[[Applied], None] | None = None,
) -> tuple[Applied, ...]:
    """Set many parameters; a result for each, in their order. See `ParameterLoad`."""
    return await ParameterLoad(parameters, wanted, everything=everything, dry_run=dry_run, tell=tell).run()


def _reason_to_skip(wanted: StoredParameter) -> str:
    if wanted.read_only:
        return "the file marks it @READONLY"
    owner = owner_of(wanted.name)
    return "" if owner is None else owner.value
