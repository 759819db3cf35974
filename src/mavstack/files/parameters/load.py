"""Loading a parameter set into a vehicle, with a result for each parameter.

    for result in await apply(vehicle.params, file.by_name().values()):
        print(result.name, result.outcome.value, result.reason)

The vehicle's parameters are downloaded first, so that only differences are sent. Parameters that belong to
one vehicle (its counters, its id, the calibration of its sensors) and those that the file marks @READONLY are
skipped unless `everything` is set. Parameters that reveal others (`*_ENABLE`) are set first; the parameters
that the vehicle did not know are looked up again after that, for as long as something new was set. The system
id is set last, since the vehicle answers under another address from then on.

`ParameterLoad.results` always has an entry for each parameter, even if the load is cancelled or the link
breaks; parameters that were not tried are marked as such.
"""

from __future__ import annotations

import asyncio
from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING, Protocol

from mavstack.errors import MavstackError, RemoteError, RemoteTimeout
from mavstack.files.parameters.compare import is_same, matched
from mavstack.files.parameters.traits import needs_reboot, owner_of, round_of
from mavstack.services.parameters.value import fitted, type_name

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from mavstack.files.parameters.parameter_file import StoredParameter
    from mavstack.services.parameters import Parameter, Value

#: Maximum number of parameters that are set at the same time.
MAX_CONCURRENCY = 8
#: Maximum number of searches for parameters that exist only after others were set.
MAX_ROUNDS = 5
#: Number of consecutive unanswered requests after which no more parameters are set.
MAX_UNANSWERED = 3
_LAST_ROUND = 2


class ParameterStore(Protocol):
    """The parameters of a component; `mavstack.node.params.Params` is the implementation."""

    @property
    def cached(self) -> Mapping[str, Parameter]:
        """Every parameter that was received, by name."""
        ...

    async def download(
        self,
        *,
        timeout: float | None = None,  # noqa: ASYNC109 (its typed error tells what is missing)
        progress: Callable[[int, int], None] | None = None,
    ) -> Mapping[str, Parameter]:
        """Download all parameters."""
        ...

    async def set(self, name: str, value: Value) -> Parameter:
        """Set one parameter; return it as the component confirmed it."""
        ...


class Outcome(Enum):
    """The outcome for one parameter."""

    SET = "set"
    UNCHANGED = "unchanged"
    SKIPPED = "skipped"
    REFUSED = "refused"
    UNKNOWN = "unknown"
    UNANSWERED = "unanswered"
    UNTRIED = "untried"


_GOOD = frozenset({Outcome.SET, Outcome.UNCHANGED, Outcome.SKIPPED})


@dataclass(frozen=True, slots=True)
class AppliedParameter:
    """The result for one parameter: its wanted value, and its values before and after, as far as known."""

    wanted: StoredParameter
    outcome: Outcome = Outcome.UNTRIED
    before: Parameter | None = None
    after: Parameter | None = None
    reason: str = ""

    @property
    def name(self) -> str:
        """The name, as the vehicle writes it if it has the parameter."""
        return self.wanted.name if self.before is None else self.before.name

    @property
    def ok(self) -> bool:
        """True if the vehicle has the value, or the parameter was skipped on purpose."""
        return self.outcome in _GOOD

    @property
    def needs_reboot(self) -> bool:
        """True if a value was set that is known to take effect after a reboot only."""
        return self.outcome is Outcome.SET and needs_reboot(self.name)


class ParameterLoad:
    """A load of parameters into one component; call `run` once.

    Args:
        parameters: The component's parameters: `vehicle.params`.
        wanted: The parameters to set.
        everything: Set those too that belong to one vehicle only, or are marked @READONLY.
        dry_run: Set nothing, and report the parameters that would be set.
        on_result: Called with each result.
    """

    def __init__(
        self,
        parameters: ParameterStore,
        wanted: Iterable[StoredParameter],
        *,
        everything: bool = False,
        dry_run: bool = False,
        on_result: Callable[[AppliedParameter], None] | None = None,
    ) -> None:
        self._parameters = parameters
        self._everything = everything
        self._dry_run = dry_run
        self._on_result = on_result
        self._silent = 0
        self._set_any = False
        self._slots = asyncio.Semaphore(MAX_CONCURRENCY)
        self._results = {each.name: AppliedParameter(each) for each in wanted}

    @property
    def results(self) -> tuple[AppliedParameter, ...]:
        """The result of each parameter so far, in the order in which they were given."""
        return tuple(self._results.values())

    async def run(
        self,
        *,
        timeout: float | None = None,  # noqa: ASYNC109 (its typed error tells what is missing)
        progress: Callable[[int, int], None] | None = None,
    ) -> tuple[AppliedParameter, ...]:
        """Download the vehicle's parameters and set those that differ.

        Args:
            timeout: Seconds for the download; None: until retries are exhausted or progress stalls.
            progress: Called with the number of parameters received and the number of all parameters.

        Returns:
            The result of each parameter.

        Raises:
            ParameterTimeout: The vehicle's parameters could not be downloaded.
        """
        await self._parameters.download(timeout=timeout, progress=progress)
        unknown = await self._rounds(
            [each.name for each in self.results if round_of(each.name) < _LAST_ROUND]
        )
        unknown += await self._set_known(
            [each.name for each in self.results if round_of(each.name) == _LAST_ROUND]
        )
        for name in unknown:
            self._ended(name, Outcome.UNKNOWN, "the vehicle has no such parameter")
        return self.results

    async def _rounds(self, names: list[str]) -> list[str]:
        """Set the parameters that the vehicle knows, while that reveals more; return the unknown ones."""
        unknown = names
        for _ in range(MAX_ROUNDS):
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
        """Set the parameters that the vehicle knows, in their turns; return the others."""
        pairs = matched(names, self._parameters.cached)
        for number in sorted({round_of(name) for name in pairs}):
            async with asyncio.TaskGroup() as group:
                for name, theirs in pairs.items():
                    if round_of(name) == number:
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
        return self._silent >= MAX_UNANSWERED

    def _ended(
        self,
        name: str,
        outcome: Outcome,
        reason: str = "",
        *,
        before: Parameter | None = None,
        after: Parameter | None = None,
    ) -> None:
        result = AppliedParameter(self._results[name].wanted, outcome, before, after, reason)
        self._results[name] = result
        if self._on_result is not None:
            self._on_result(result)


async def apply(
    parameters: ParameterStore,
    wanted: Iterable[StoredParameter],
    *,
    everything: bool = False,
    dry_run: bool = False,
    on_result: Callable[[AppliedParameter], None] | None = None,
) -> tuple[AppliedParameter, ...]:
    """Set many parameters of a vehicle.

    Args:
        parameters: The vehicle's parameters: `vehicle.params`.
        wanted: The parameters to set.
        everything: Set those too that belong to one vehicle only, or are marked @READONLY.
        dry_run: Set nothing, and report the parameters that would be set.
        on_result: Called with each result.

    Returns:
        The result of each parameter, in the order in which they were given.

    Raises:
        ParameterTimeout: The vehicle's parameters could not be downloaded.
    """
    return await ParameterLoad(
        parameters, wanted, everything=everything, dry_run=dry_run, on_result=on_result
    ).run()


def _reason_to_skip(wanted: StoredParameter) -> str:
    if wanted.read_only:
        return "the file marks it @READONLY"
    owner = owner_of(wanted.name)
    return "" if owner is None else owner.value
