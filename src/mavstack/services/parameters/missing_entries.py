"""The missing entries of a numbered list: which to request individually, and when.

A component that was asked for its list sends the entries in order, and some are lost. Nothing is requested
while the list continues: ArduPilot answers individual requests before it continues its list, so that a few of
them delay the list, and hundreds of entries would arrive one by one. When the list has ended, or is quiet
(nothing arrived for several times its longest pause), the missing entries are requested individually, as many
at a time as the `window` allows: one more for each answer, fewer after timeouts, since a vehicle's queue and
a radio's are both short. The timeout follows from round trips of answers that surely belong to their request,
late ones included; it doubles when answers are missing, and each answer takes one doubling back.

A silence is either the list's end or a pause: autopilots pause when a radio reports a full queue, or to catch
up with their telemetry. The entries beyond the list's position are therefore requested from the last one
downwards. A list that continues is recognised by its next entry, which was not requested; then requests stop
until the list meets the entries that were requested. With requests upwards, the answers and the list would
contain the same entries, and could not be told apart.
"""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING

from mavstack.services.service import earliest

if TYPE_CHECKING:
    from mavstack.services.timing import RoundTrip

#: An entry that is further ahead counts only when the next entry confirms it: it may be a single value
#: outside the list.
MAX_JUMP = 32
INITIAL_WINDOW = 8.0
MIN_WINDOW = 4.0
#: The largest window: ArduPilot can queue this number of requests.
MAX_WINDOW = 20.0
#: The largest number of doublings of the timeout.
MAX_BACKOFF = 3
#: The list has become quiet after this multiple of its longest pause, within these limits in seconds.
QUIET_FACTOR = 3.0
MIN_QUIET = 0.05
MAX_QUIET = 2.0
#: A list that becomes quiet this close to its end has ended, and its last entries were lost; earlier in the
#: list it may only pause.
NEAR_END = 32
MIN_PAUSE = 0.3
#: The factor by which the longest pause is reduced with each entry, so that old pauses lose their effect.
PAUSE_DECAY = 0.98


class MissingEntries:
    """The state of one download; entries have indexes from 0 to `total` - 1."""

    def __init__(self, round_trip: RoundTrip, now: float) -> None:
        self.total = 0
        self.window = INITIAL_WINDOW
        self.received: set[int] = set()
        self._round_trip = round_trip
        self._frontier = -1
        self._jump = -1
        self._pointer = 0  # all entries below this index were received or requested
        self._end = 0  # all entries from this index on were received or requested
        self._end_of = 0  # the total for which `_end` was set
        self._requested: dict[int, float] = {}  # the time of the last request, by entry
        self._attempts: dict[int, int] = {}
        self._first_requested: dict[int, float] = {}
        self.answers = 0  # the number of answers to individual requests
        self._backoff = 1
        # by entry that was requested several times: seconds since the first request
        self._ambiguous: dict[int, float] = {}
        self._shrink_at = now
        self._repeat: deque[int] = deque()
        self._last_entry = now
        self._max_pause = 0.0
        self._quiet = False

    @property
    def complete(self) -> bool:
        """True if every entry was received."""
        return 0 < self.total == len(self.received)

    @property
    def max_attempts(self) -> int:
        """The largest number of unanswered requests for one entry."""
        return max((self._attempts[index] for index in self._repeat), default=0)

    def receive(self, index: int, now: float) -> bool:
        """Record an entry; returns True if it is new."""
        if not 0 <= index < self.total:
            return False
        if self._requested.pop(index, None) is not None:
            self.answers += 1
            self.window = min(self.window + 1, MAX_WINDOW)
            self._backoff = max(self._backoff - 1, 1)
        if index not in self._attempts:
            self._record_list_entry(index, now)
        elif index in self._first_requested:
            self._measure(index, now)
        if index in self.received:
            return False
        self.received.add(index)
        return True

    def next_wanted(self) -> int | None:
        """Return the entry to request next, if there is one and the window has room."""
        if not self._quiet or len(self._requested) >= int(self.window):
            return None
        while self._repeat:
            if self._repeat[0] not in self.received:
                return self._repeat[0]
            self._repeat.popleft()
        while self._pointer < min(self._frontier, self.total):
            if self._is_open(self._pointer):
                return self._pointer
            self._pointer += 1
        return self._last_wanted()

    def request(self, index: int, now: float) -> None:
        """Record the request of the entry from `next_wanted`."""
        if self._repeat and self._repeat[0] == index:
            self._repeat.popleft()
        self._first_requested.setdefault(index, now)
        self._attempts[index] = self._attempts.get(index, 0) + 1
        self._requested[index] = now

    def next_timeout(self) -> float | None:
        """Return when to call `handle_timeout`."""
        quiet_at = None if self._quiet else self._quiet_at
        return earliest(quiet_at, *map(self._due, self._requested))

    def handle_timeout(self, now: float) -> None:
        """Handle requests without an answer."""
        if now >= self._quiet_at:
            self._quiet = True
        late = [index for index in self._requested if now >= self._due(index)]
        for index in late:
            del self._requested[index]
            self._repeat.append(index)
        if late and now >= self._shrink_at:
            self.window = max(self.window * 0.7, MIN_WINDOW)
            self._backoff = min(self._backoff + 1, MAX_BACKOFF)
            self._shrink_at = now + self._round_trip.timeout(self._backoff)

    def _is_open(self, index: int) -> bool:
        """Return whether an entry was neither received nor requested."""
        return index not in self.received and index not in self._attempts

    def _last_wanted(self) -> int | None:
        """Return the last open entry beyond the position of the list."""
        if self._end_of != self.total:
            self._end = self._end_of = self.total
        while self._end - 1 > self._frontier:
            if self._is_open(self._end - 1):
                return self._end - 1
            self._end -= 1
        return None

    @property
    def _quiet_at(self) -> float:
        if not self._max_pause:
            return self._last_entry + self._round_trip.timeout()
        pause = QUIET_FACTOR * self._max_pause
        minimum = MIN_QUIET if self._frontier >= self._end - NEAR_END else MIN_PAUSE
        return self._last_entry + min(max(pause, minimum), MAX_QUIET)

    def _due(self, index: int) -> float:
        return self._requested[index] + self._round_trip.timeout(self._backoff)

    def _measure(self, index: int, now: float) -> None:
        """Add the round trip of an answer.

        Which of two requests was answered is unknown until the other one is answered too: then the first
        answer belongs to the first request, and the timeout is too short.
        """
        if index in self.received:
            self._round_trip.add_sample(self._ambiguous.pop(index, 0.0) or now - self._first_requested[index])
            del self._first_requested[index]
        elif self._attempts[index] == 1:
            self._backoff = 1
            self._round_trip.add_sample(now - self._first_requested.pop(index))
        else:
            self._ambiguous[index] = now - self._first_requested[index]

    def _record_list_entry(self, index: int, now: float) -> None:
        """Record an entry that was not requested: of the list, or a value that a client changed."""
        if index <= self._frontier:
            return
        if index > self._frontier + MAX_JUMP and not self._jump < index <= self._jump + MAX_JUMP:
            self._jump = index
            return
        if self._frontier >= 0:
            self._max_pause = max(self._max_pause * PAUSE_DECAY, now - self._last_entry)
        self._frontier, self._jump, self._last_entry = index, -1, now
        self._quiet = self._last_wanted() is None
