"""Which entries of a numbered list have come, and which to ask for singly, and when.

A component that was asked for its list sends the entries in order, and some are lost. Nothing is asked for
while the list goes on: ArduPilot answers single requests before it goes on with its list, so that a few of
them under way hold the list up, and what it would have sent by the hundred comes one by one. When the list
has come to its end, or fallen quiet (nothing came for several times the longest pause that it made before),
what is missing is asked for singly, so many at a time as the `window` says: one more for each answer, less if
answers stay out, since a vehicle's queue and a radio's are both short. How long an answer is awaited follows
from those that surely belong to their question, also from late ones; each time that answers stay out it
doubles, each answer takes a doubling back.

A silence may be the list's end or a pause: autopilots pause when a radio tells that its queue is full, or to
catch up with their telemetry. What has not come yet is therefore asked for from the last entry downwards. A
list that goes on is known by its next entry, which nobody asked for; it is listened to again until it meets
what was asked for. Asked for upwards, the answers and the list would tell the same entries side by side, and
neither could be told from the other.
"""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING

from mavstack.services.service import earliest

if TYPE_CHECKING:
    from mavstack.services.timing import RoundTrip

#: A longer leap is believed when the next entry confirms it: it may have been a single value, not the list.
LEAP = 32
INITIAL_WINDOW = 8.0
MIN_WINDOW = 4.0
#: ArduPilot has room for so many requests.
MAX_WINDOW = 20.0
#: How far the doubling goes.
MAX_BACKOFF = 3
#: The list is quiet after so many of its longest pauses, within limits in seconds.
PAUSES = 3.0
MIN_QUIET = 0.05
MAX_QUIET = 2.0
#: So near its end a list that falls quiet has ended, and its last entries were lost; before, it may pause.
NEAR_END = 32
MIN_PAUSE = 0.3
#: What the longest pause is multiplied by with each entry: old pauses are forgotten.
FORGETTING = 0.98


class MissingEntries:
    """The state of one listing; entries have indexes from 0 to `total` - 1."""

    def __init__(self, round_trip: RoundTrip, now: float) -> None:
        self.total = 0
        self.window = INITIAL_WINDOW
        self.received: set[int] = set()
        self._round_trip = round_trip
        self._frontier = -1
        self._leap = -1
        self._pointer = 0  # all below it have come, or were asked for
        self._end = 0  # from here to the end as well
        self._end_of = 0  # the total that this end belongs to
        self._asked: dict[int, float] = {}  # when, for the last time
        self._attempts: dict[int, int] = {}
        self._first_asked: dict[int, float] = {}
        self.answers = 0  # to single requests
        self._backoff = 1
        self._unclear: dict[int, float] = {}  # how long after the first of several requests
        self._narrow_again_at = now
        self._again: deque[int] = deque()
        self._last_entry = now
        self._longest_pause = 0.0
        self._quiet = False

    @property
    def complete(self) -> bool:
        """Whether every entry has come."""
        return 0 < self.total == len(self.received)

    @property
    def most_attempts(self) -> int:
        """How often the most stubborn entry was asked for in vain."""
        return max((self._attempts[index] for index in self._again), default=0)

    def take(self, index: int, now: float) -> bool:
        """An entry came; True if it is new."""
        if not 0 <= index < self.total:
            return False
        if self._asked.pop(index, None) is not None:
            self.answers += 1
            self.window = min(self.window + 1, MAX_WINDOW)
            self._backoff = max(self._backoff - 1, 1)
        if index not in self._attempts:
            self._flowed(index, now)
        elif index in self._first_asked:
            self._measure(index, now)
        if index in self.received:
            return False
        self.received.add(index)
        return True

    def next_wanted(self) -> int | None:
        """The entry to ask for next, if there is one and the window has room."""
        if not self._quiet or len(self._asked) >= int(self.window):
            return None
        while self._again:
            if self._again[0] not in self.received:
                return self._again[0]
            self._again.popleft()
        while self._pointer < min(self._frontier, self.total):
            if self._is_open(self._pointer):
                return self._pointer
            self._pointer += 1
        return self._last_wanted()

    def ask(self, index: int, now: float) -> None:
        """The entry that `next_wanted` gave was asked for."""
        if self._again and self._again[0] == index:
            self._again.popleft()
        self._first_asked.setdefault(index, now)
        self._attempts[index] = self._attempts.get(index, 0) + 1
        self._asked[index] = now

    def next_timeout(self) -> float | None:
        """When `handle_timeout` has something to do."""
        quiet_at = None if self._quiet else self._quiet_at
        return earliest(quiet_at, *map(self._due, self._asked))

    def handle_timeout(self, now: float) -> None:
        """See what stayed out."""
        if now >= self._quiet_at:
            self._quiet = True
        late = [index for index in self._asked if now >= self._due(index)]
        for index in late:
            del self._asked[index]
            self._again.append(index)
        if late and now >= self._narrow_again_at:
            self.window = max(self.window * 0.7, MIN_WINDOW)
            self._backoff = min(self._backoff + 1, MAX_BACKOFF)
            self._narrow_again_at = now + self._round_trip.timeout(self._backoff)

    def _is_open(self, index: int) -> bool:
        """Whether an entry neither came nor was ever asked for."""
        return index not in self.received and index not in self._attempts

    def _last_wanted(self) -> int | None:
        """The last entry beyond the list's own that is open."""
        if self._end_of != self.total:
            self._end = self._end_of = self.total
        while self._end - 1 > self._frontier:
            if self._is_open(self._end - 1):
                return self._end - 1
            self._end -= 1
        return None

    @property
    def _quiet_at(self) -> float:
        if not self._longest_pause:
            return self._last_entry + self._round_trip.timeout()
        pause = PAUSES * self._longest_pause
        minimum = MIN_QUIET if self._frontier >= self._end - NEAR_END else MIN_PAUSE
        return self._last_entry + min(max(pause, minimum), MAX_QUIET)

    def _due(self, index: int) -> float:
        return self._asked[index] + self._round_trip.timeout(self._backoff)

    def _measure(self, index: int, now: float) -> None:
        """Learn the round trip from an answer.

        Which of two requests was answered nobody knows, until the other is answered as well: then the first
        answer was to the first request, and the waiting is too short.
        """
        if index in self.received:
            self._round_trip.add_sample(self._unclear.pop(index, 0.0) or now - self._first_asked[index])
            del self._first_asked[index]
        elif self._attempts[index] == 1:
            self._backoff = 1
            self._round_trip.add_sample(now - self._first_asked.pop(index))
        else:
            self._unclear[index] = now - self._first_asked[index]

    def _flowed(self, index: int, now: float) -> None:
        """An entry came by itself: of the list, or a single value that someone changed."""
        if index <= self._frontier:
            return
        if index > self._frontier + LEAP and not self._leap < index <= self._leap + LEAP:
            self._leap = index
            return
        if self._frontier >= 0:
            self._longest_pause = max(self._longest_pause * FORGETTING, now - self._last_entry)
        self._frontier, self._leap, self._last_entry = index, -1, now
        self._quiet = self._last_wanted() is None
