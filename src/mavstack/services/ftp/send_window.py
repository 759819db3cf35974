"""The send window: the outstanding requests of one transfer, as many as the link carries.

The window grows by one per answer until a request is lost or the round trip exceeds a multiple of the
shortest one (a queue fills), then by one per round trip. A loss halves the window only if it indicates a full
queue: if the round trip has grown, or if most requests are lost. A link that loses one packet in ten at
random keeps its window; a slow radio, or a server that accepts five requests at a time, gets a small one.

A request that was overtaken by three later ones, or that timed out, is sent again unchanged.
"""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass
from typing import TYPE_CHECKING, Generic, TypeVar

from mavstack.services.timing import RoundTrip

if TYPE_CHECKING:
    from collections.abc import Iterator

Request = TypeVar("Request")

INITIAL_WINDOW = 4.0
MAX_WINDOW = 64.0
MAX_OVERTAKEN = 3
MAX_ANSWERED = 128
#: Seconds added to each timeout, because an unnecessary repetition costs more than a late one.
TIMEOUT_MARGIN = 0.05
#: The multiples of the shortest round trip that show that packets are queued, and that the queue is full.
QUEUED, FULL = 2.0, 4.0
#: Moving average (over about 16 answers and repetitions) of the share of repetitions; a larger share shows
#: congestion, not random loss.
MAX_RANDOM_LOSS = 0.7
#: The largest number of times a timeout is doubled: a link may lose several repetitions at random.
MAX_DOUBLINGS = 3


@dataclass(slots=True)
class _Outstanding(Generic[Request]):
    request: Request
    order: int
    sent_at: float
    due: float
    attempts: int = 1
    overtaken: int = 0


class SendWindow(Generic[Request]):
    """The outstanding requests to one server, by sequence number."""

    def __init__(self) -> None:
        self.window = INITIAL_WINDOW
        self.attempts = 1
        self.known_delay = 0.0  # the round trip that other traffic measured
        self._round_trip = RoundTrip(
            initial=0.5, minimum=0.05, maximum=3.0
        )  # measured separately, because full packets take longer than short ones
        self._requests: dict[int, _Outstanding[Request]] = {}
        self._answered: OrderedDict[int, tuple[float, int]] = OrderedDict()
        self._order = 0
        self._shortest = float("inf")
        self._latest = 0.0
        self._loss = 0.0
        self._starting = True
        self._cut_until = 0.0

    def __len__(self) -> int:
        return len(self._requests)

    def __iter__(self) -> Iterator[Request]:
        return (entry.request for entry in self._requests.values())

    @property
    def has_room(self) -> bool:
        """True if another request may be sent."""
        return len(self._requests) < int(self.window)

    def add(self, sequence: int, request: Request, now: float) -> None:
        """Record a request that was sent."""
        self._order += 1
        self._requests[sequence] = _Outstanding(request, self._order, now, now + self._timeout(1))

    def find(self, sequence: int) -> Request | None:
        """Return the request with a number, if it is not answered yet."""
        entry = self._requests.get(sequence)
        return None if entry is None else entry.request

    def answered(self, sequence: int, now: float) -> None:
        """Record the answer to a request."""
        entry = self._requests.pop(sequence)
        self._answered[sequence] = (now - entry.sent_at, entry.attempts)
        while len(self._answered) > MAX_ANSWERED:
            self._answered.popitem(last=False)
        self._loss -= self._loss / 16
        for other in self._requests.values():
            other.overtaken += other.order < entry.order
        if entry.attempts == 1:
            self._latest = now - entry.sent_at
            self._shortest = min(self._shortest, self._latest)
            self._round_trip.add_sample(self._latest)
        self._grow()

    def answered_again(self, sequence: int) -> None:
        """Record a second answer: the repetition was unnecessary, so the first answer is a sample."""
        took, attempts = self._answered.pop(sequence, (0.0, 1))
        if attempts > 1:
            self._latest = took
            self._round_trip.add_sample(took)

    def lost(self, now: float) -> list[tuple[int, Request]]:
        """Return the requests to send again now; they count as sent."""
        missing = [
            (sequence, entry)
            for sequence, entry in self._requests.items()
            if entry.overtaken >= MAX_OVERTAKEN or entry.due <= now
        ]
        for _, entry in missing:
            self._order += 1
            entry.order, entry.overtaken = self._order, 0
            entry.attempts += 1
            entry.due = now + self._timeout(entry.attempts)
            self.attempts = max(self.attempts, entry.attempts)
            self._loss += (1.0 - self._loss) / 16
        if missing:
            self._shrink(now)
        return [(sequence, entry.request) for sequence, entry in missing]

    def next_timeout(self) -> float | None:
        """Return when a request may have to be sent again."""
        return min((entry.due for entry in self._requests.values()), default=None)

    def _timeout(self, attempt: int) -> float:
        learned = self._round_trip.timeout(min(attempt, MAX_DOUBLINGS))
        return max(learned, 2 * self._latest, 2 * self.known_delay) + TIMEOUT_MARGIN

    def _grow(self) -> None:
        if self._latest > QUEUED * self._shortest:
            self._starting = False
        if self._latest <= FULL * self._shortest:
            self.window += 1.0 if self._starting else 1.0 / self.window
        self.window = min(self.window, MAX_WINDOW)

    def _shrink(self, now: float) -> None:
        congested = self._latest > QUEUED * self._shortest or self._loss > MAX_RANDOM_LOSS
        if congested and now >= self._cut_until:
            self.window = max(self.window / 2, 1.0)
            self._starting = False
            self._cut_until = now + (self._round_trip.smoothed or 0.0)
