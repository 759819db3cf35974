"""Requests under way: several at once, as many as what arrives shows to be good.

The window grows by one for each answer until something is lost or the round trip has become several times
the shortest seen (a queue fills somewhere), then by one a round trip. A loss halves it only if it is a sign
of a full queue: if the round trip has grown, or if much is lost. A link that loses one packet in ten by
chance keeps its window; a slow radio, or a server that takes five requests at a time, gets a small one.

A request that three later ones overtook, or that is not answered in time, is sent again as it was.
"""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass
from typing import TYPE_CHECKING, Generic, TypeVar

from mavstack.services.timing import RoundTrip

if TYPE_CHECKING:
    from collections.abc import Iterator

What = TypeVar("What")

FIRST_WINDOW = 4.0
MOST_WINDOW = 64.0
OVERTAKEN = 3
REMEMBERED = 128
#: Added to each wait, in seconds: a repetition too many costs more than one too late.
SLACK = 0.05
#: A round trip of so many times the shortest means a queue.
QUEUED, FULL = 2.0, 4.0
#: A share of losses above this is no chance.
MUCH_LOST = 0.7
#: The wait for a repetition is doubled no further: a link may lose many in a row by chance.
MOST_DOUBLED = 3


@dataclass(slots=True)
class _Request(Generic[What]):
    what: What
    order: int
    sent_at: float
    due: float
    attempts: int = 1
    overtaken: int = 0


class Flight(Generic[What]):
    """What is under way to one peer, by sequence number."""

    def __init__(self) -> None:
        self.window = FIRST_WINDOW
        self.attempts = 1
        self.known_delay = 0.0  # what other traffic tells of the round trip
        self._round_trip = RoundTrip(
            initial=0.5, least=0.05, most=3.0
        )  # full packets take longer than others
        self._requests: dict[int, _Request[What]] = {}
        self._answered: OrderedDict[int, tuple[float, int]] = OrderedDict()
        self._order = 0
        self._shortest = float("inf")
        self._latest = 0.0
        self._loss = 0.0
        self._starting = True
        self._cut_until = 0.0

    def __len__(self) -> int:
        return len(self._requests)

    def __iter__(self) -> Iterator[What]:
        return (request.what for request in self._requests.values())

    @property
    def has_room(self) -> bool:
        """Whether another request may go."""
        return len(self._requests) < int(self.window)

    def add(self, sequence: int, what: What, now: float) -> None:
        """A request was sent."""
        self._order += 1
        self._requests[sequence] = _Request(what, self._order, now, now + self._wait(1))

    def find(self, sequence: int) -> What | None:
        """What was asked with that number, if it is not answered yet."""
        request = self._requests.get(sequence)
        return None if request is None else request.what

    def answered(self, sequence: int, now: float) -> None:
        """A request was answered."""
        request = self._requests.pop(sequence)
        self._answered[sequence] = (now - request.sent_at, request.attempts)
        while len(self._answered) > REMEMBERED:
            self._answered.popitem(last=False)
        self._loss -= self._loss / 16
        for other in self._requests.values():
            other.overtaken += other.order < request.order
        if request.attempts == 1:
            self._latest = now - request.sent_at
            self._shortest = min(self._shortest, self._latest)
            self._round_trip.measured(self._latest)
        self._grow()

    def answered_again(self, sequence: int) -> None:
        """A second answer: the repetition was not needed, and the first answer is a measure after all."""
        took, attempts = self._answered.pop(sequence, (0.0, 1))
        if attempts > 1:
            self._latest = took
            self._round_trip.measured(took)

    def lost(self, now: float) -> list[tuple[int, What]]:
        """What is to be sent again, now; counts as sent."""
        missing = [
            (sequence, request)
            for sequence, request in self._requests.items()
            if request.overtaken >= OVERTAKEN or request.due <= now
        ]
        for _, request in missing:
            self._order += 1
            request.order, request.overtaken = self._order, 0
            request.attempts += 1
            request.due = now + self._wait(request.attempts)
            self.attempts = max(self.attempts, request.attempts)
            self._loss += (1.0 - self._loss) / 16
        if missing:
            self._shrink(now)
        return [(sequence, request.what) for sequence, request in missing]

    def next_timeout(self) -> float | None:
        """When something may have to be sent again."""
        return min((request.due for request in self._requests.values()), default=None)

    def _wait(self, attempt: int) -> float:
        learned = self._round_trip.timeout(min(attempt, MOST_DOUBLED))
        return max(learned, 2 * self._latest, 2 * self.known_delay) + SLACK

    def _grow(self) -> None:
        if self._latest > QUEUED * self._shortest:
            self._starting = False
        if self._latest <= FULL * self._shortest:
            self.window += 1.0 if self._starting else 1.0 / self.window
        self.window = min(self.window, MOST_WINDOW)

    def _shrink(self, now: float) -> None:
        congested = self._latest > QUEUED * self._shortest or self._loss > MUCH_LOST
        if congested and now >= self._cut_until:
            self.window = max(self.window / 2, 1.0)
            self._starting = False
            self._cut_until = now + (self._round_trip.smoothed or 0.0)
