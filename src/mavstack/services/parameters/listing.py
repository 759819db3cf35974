"""The download of a list of parameters, plain or extended.

    request the list ── entries ──► complete ──► result
      │                    ├── missing entries ──► requested individually (see `missing_entries`)
      │                    ├── silence ──► ParameterTimeout, with the number of received entries
      │                    └── the table changed (its count, or a name at two indexes) ──► restart
      └── silence ──► request again

An entry counts only with its index: a value that another client set is sent without one. Received values stay
in the client even if the download fails.
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

#: The largest number of entries; larger indexes cannot be requested.
MAX_ENTRIES = 32768
#: How often the table may change during a download before the download fails.
MAX_RESTARTS = 5
#: How often the count may change in total: a table that grows and shrinks would otherwise make progress for
#: ever.
MAX_COUNTS = 1000
#: The number of unanswered requests for one entry, with no other answer, after which the list is requested
#: again.
ATTEMPTS_BEFORE_LIST = 4


class Listing(Operation[Result]):
    """The download of a list whose entries have an index, the count and a name."""

    timeout_error = ParameterTimeout
    min_rate = 0.25

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
        self._list_requested_at = 0.0
        self._list_due: float | None = None
        self._list_repetitions = 0

    # Methods that a listing overrides

    @abstractmethod
    def list_request(self) -> Message:
        """Return the message that requests the list."""

    @abstractmethod
    def entry_request(self, index: int) -> Message:
        """Return the message that requests one entry."""

    @abstractmethod
    def finish_list(self, names: list[str], now: float) -> None:
        """Finish with a complete list of these names, in order."""

    # Methods that a listing calls

    def receive_entry(self, index: int, count: int, name: str, now: float, *, reordered: bool) -> None:
        """Handle an entry with its index."""
        if count > MAX_ENTRIES:
            return
        if reordered and (self._missing.total != count or index in self._missing.received):
            return  # a duplicate, or an entry from before a change of the table
        self._receive_count(count, now)
        if self.done or not 0 <= index < self._missing.total:
            return
        known = self._names.get(index)
        if known not in (None, name) or self._places.get(name, index) != index:
            self._changed = True
        first = not self._missing.received
        if self._missing.receive(index, now):
            self._names[index], self._places[name] = name, index
            self.report_progress(now, len(self._missing.received), self._missing.total)
        if first and self.attempts == 1:
            self.round_trip.add_sample(now - self._list_requested_at)
        self._list_due = None
        self._check_complete(now)

    def entry_refused(self, index: int, error: int, now: float) -> None:
        """Handle the refusal of an entry: it does not exist, or cannot be read."""
        if self.done or not 0 <= index < self._missing.total or index in self._missing.received:
            return
        if error == common.MavParamError.DOES_NOT_EXIST:
            self._restart(now)
        else:
            self.fail(denied(self, error))

    def restart_download(self, now: float) -> None:
        """Restart, because the component rebooted."""
        if not self.done and self.attempts:
            self._restart(now)

    # Methods of an operation

    def start(self, now: float) -> None:
        self._request_list(now)

    def handle_timeout(self, now: float) -> None:
        if self._list_due is not None and now >= self._list_due:
            self._request_list(now)
        self._missing.handle_timeout(now)
        unanswered = self._missing.max_attempts >= ATTEMPTS_BEFORE_LIST * (self._list_repetitions + 1)
        if unanswered and not self._missing.answers:
            self._list_repetitions += 1
            self.send(self.list_request())
        self._arm()

    def bulk_messages(self, now: float, has_room: HasRoom) -> Iterator[Outgoing]:
        while (index := self._missing.next_wanted()) is not None and has_room(self.target):
            self._missing.request(index, now)
            self._arm()
            yield Outgoing(self.entry_request(index), self.target)

    def time_out(self, now: float, answer: str = "no answer") -> None:
        if self._missing.total:
            answer = f"{len(self._missing.received)} of {self._missing.total} entries arrived"
        super().time_out(now, answer)

    def _request_list(self, now: float) -> None:
        self.attempts += 1
        self.send(self.list_request())
        if self.attempts == 1:
            self._reset(now)
        self._list_requested_at = now
        self._list_due = now + self.round_trip.timeout(self.attempts)
        self._arm()

    def _receive_count(self, count: int, now: float) -> None:
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
                self._drop_from(count)
        self._missing.total = count

    def _drop_from(self, count: int) -> None:
        self._missing.received = {index for index in self._missing.received if index < count}
        for index in [index for index in self._names if index >= count]:
            self._places.pop(self._names.pop(index), None)

    def _check_complete(self, now: float) -> None:
        if not self._missing.complete:
            self._arm()
        elif self._changed:
            self._restart(now)
        else:
            self.finish_list([self._names[index] for index in range(self._missing.total)], now)

    def _restart(self, now: float) -> None:
        """Restart the download: indexes from before and after a change do not match."""
        self._restarts += 1
        if self._restarts > MAX_RESTARTS:
            super().time_out(now, "the table kept changing")
            return
        self._reset(now)
        self._request_list(now)

    def _reset(self, now: float) -> None:
        self._missing = MissingEntries(self.round_trip, now)
        self._names, self._places = {}, {}
        self._changed = False
        self._list_repetitions = 0

    def _arm(self) -> None:
        if not self.done:
            self.timer = earliest(self._list_due, self._missing.next_timeout())


def denied(operation: Operation[Result], error: int, answer: str = "") -> ParameterDenied:
    """Return the error of a PARAM_ERROR."""
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
