"""Fetching a whole list, of parameters or of extended ones.

    asked for the list ── entries ──► whole ──► result
      │                      ├── gaps ──► asked for singly, as `gaps` says
      │                      ├── silence ──► ParameterTimeout, saying how many came
      │                      └── the table changed (its count, or a name in two places) ──► asked for anew
      └── silence ──► asked again

An entry fills its place in the list only if it tells its index: a value that someone set is told without, and
says nothing about which place it has. What has come stays known to the client even if the listing fails.
"""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING, TypeVar

from mavstack.dialects import common
from mavstack.errors import ParameterDenied, ParameterTimeout
from mavstack.services.operation import Operation
from mavstack.services.parameters.missing_entries import MissingEntries
from mavstack.services.service import Outgoing, earliest

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.dialects import Message
    from mavstack.services.service import HasRoom
    from mavstack.services.timing import RoundTrip

Result = TypeVar("Result")

#: A greater index cannot be asked for.
MAX_ENTRIES = 32768
#: So often a table may change while it is listed.
MAX_RESTARTS = 5
#: So often the count may change in all: a table that grows and shrinks for ever always has something new.
MAX_COUNTS = 1000
#: After so many vain requests for one entry, and none answered, the list is asked for once more.
ATTEMPTS_BEFORE_LIST = 4


class Listing(Operation[Result]):
    """Fetches a list of which each entry tells its index, the count and its name."""

    timeout_error = ParameterTimeout

    def __init__(
        self,
        description: str,
        round_trip: RoundTrip,
        *,
        timeout: float | None = None,
        idle_timeout: float = 10.0,
    ) -> None:
        super().__init__(description, timeout=timeout, idle_timeout=idle_timeout)
        self.round_trip = round_trip
        self._missing = MissingEntries(round_trip, 0.0)
        self._names: dict[int, str] = {}
        self._places: dict[str, int] = {}
        self._restarts = 0
        self._changed = False
        self._counts = 0
        self._list_asked_at = 0.0
        self._list_due: float | None = None
        self._asked_again_for = 0

    # What a listing overrides

    @abstractmethod
    def list_request(self) -> Message:
        """The message that asks for the list."""

    @abstractmethod
    def entry_request(self, index: int) -> Message:
        """The message that asks for one entry."""

    @abstractmethod
    def listed(self, names: list[str], now: float) -> None:
        """The list is whole, with these names in its order: finish."""

    # What a listing calls

    def entry_came(self, index: int, count: int, name: str, now: float, *, overtaken: bool) -> None:
        """An entry came that told its index."""
        if count > MAX_ENTRIES:
            return
        if overtaken and (self._missing.total != count or index in self._missing.received):
            return  # a copy, or of a table that is no more
        self._count_came(count, now)
        if self.done or not 0 <= index < self._missing.total:
            return
        known = self._names.get(index)
        if known not in (None, name) or self._places.get(name, index) != index:
            self._changed = True
        first = not self._missing.received
        if self._missing.take(index, now):
            self._names[index], self._places[name] = name, index
            self.report_progress(now, len(self._missing.received), self._missing.total)
        if first and self.attempts == 1:
            self.round_trip.add_sample(now - self._list_asked_at)
        self._list_due = None
        self._look(now)

    def entry_refused(self, index: int, error: int, now: float) -> None:
        """The component says that there is no such entry, or that it cannot be read."""
        if self.done or not 0 <= index < self._missing.total or index in self._missing.received:
            return
        if error == common.MavParamError.DOES_NOT_EXIST:
            self._restart(now)
        else:
            self.fail(denied(self, error))

    def begin_anew(self, now: float) -> None:
        """The component started anew: nothing that came before counts."""
        if not self.done and self.attempts:
            self._restart(now)

    # As an operation

    def start(self, now: float) -> None:
        self._ask_for_list(now)

    def handle_timeout(self, now: float) -> None:
        if self._list_due is not None and now >= self._list_due:
            self._ask_for_list(now)
        self._missing.handle_timeout(now)
        stubborn = self._missing.most_attempts >= ATTEMPTS_BEFORE_LIST * (self._asked_again_for + 1)
        if stubborn and not self._missing.answers:
            self._asked_again_for += 1
            self.send(self.list_request())
        self._arm()

    def bulk_messages(self, now: float, has_room: HasRoom) -> Iterator[Outgoing]:
        while (index := self._missing.next_wanted()) is not None and has_room(self.target):
            self._missing.ask(index, now)
            self._arm()
            yield Outgoing(self.entry_request(index), self.target)

    def time_out(self, now: float, answer: str = "no answer") -> None:
        if self._missing.total:
            answer = f"{len(self._missing.received)} of {self._missing.total} came"
        super().time_out(now, answer)

    def _ask_for_list(self, now: float) -> None:
        self.attempts += 1
        self.send(self.list_request())
        if self.attempts == 1:
            self._begin_anew(now)
        self._list_asked_at = now
        self._list_due = now + self.round_trip.timeout(self.attempts)
        self._arm()

    def _count_came(self, count: int, now: float) -> None:
        if count == self._missing.total or count == 0:
            return
        self._counts += 1
        if self._counts > MAX_COUNTS:
            super().time_out(now, "the table kept changing")
            return
        if self._missing.total:
            self._changed = True
            grown = count > self._missing.total
            self._missing.total = count
            if not grown:
                self._forget_from(count)
        self._missing.total = count

    def _forget_from(self, count: int) -> None:
        self._missing.received = {index for index in self._missing.received if index < count}
        for index in [index for index in self._names if index >= count]:
            self._places.pop(self._names.pop(index), None)

    def _look(self, now: float) -> None:
        if not self._missing.complete:
            self._arm()
        elif self._changed:
            self._restart(now)
        else:
            self.listed([self._names[index] for index in range(self._missing.total)], now)

    def _restart(self, now: float) -> None:
        """Fetch it all again: indexes that were told before and after a change do not fit together."""
        self._restarts += 1
        if self._restarts > MAX_RESTARTS:
            super().time_out(now, "the table kept changing")
            return
        self._begin_anew(now)
        self._ask_for_list(now)

    def _begin_anew(self, now: float) -> None:
        self._missing = MissingEntries(self.round_trip, now)
        self._names, self._places = {}, {}
        self._changed = False
        self._asked_again_for = 0

    def _arm(self) -> None:
        if not self.done:
            self.timer = earliest(self._list_due, self._missing.next_timeout())


def denied(operation: Operation[Result], error: int, answer: str = "") -> ParameterDenied:
    """The error of a PARAM_ERROR."""
    try:
        reason = common.MavParamError(error).name
    except ValueError:
        reason = f"error {error}"
    return ParameterDenied(
        operation.description,
        str(operation.target),
        attempts=operation.attempts,
        answer=answer or reason,
        code=error,
    )
