"""The schedule of polled MSP messages: which one to request next, and when. It needs no event loop.

MSP sends nothing by itself; each value is requested, one request after the other. Each message has an
interval, that of the fastest MAVLink message made of it. The message that is late by most of its intervals
goes first, so that a line that is too slow for all of them thins out all alike. Polls use at most a share of
the time of the line: after a request that took a while the line rests for a part of that while, and
requests of the pilot and of parameters find it free. The engine below sends those before polls anyway.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING, Final, Generic, TypeVar

if TYPE_CHECKING:
    from collections.abc import Hashable, Mapping

#: The share of the time that polls may use.
DEFAULT_SHARE: Final = 0.8

Key = TypeVar("Key", bound="Hashable")


@dataclass(slots=True)
class _Poll:
    interval: float
    due: float


class PollSchedule(Generic[Key]):
    """The schedule of the polls of one flight controller.

    Args:
        share: The share of the time that polls may use, above 0 to 1.
    """

    def __init__(self, share: float = DEFAULT_SHARE) -> None:
        self._rest = 1 / share - 1
        self._polls: dict[Key, _Poll] = {}
        self._free_at = -inf

    @property
    def keys(self) -> frozenset[Key]:
        """The messages that are polled."""
        return frozenset(self._polls)

    def set_intervals(self, intervals: Mapping[Key, float], now: float) -> None:
        """Set the messages and their intervals in seconds; a new message is due at once."""
        for key in self._polls.keys() - intervals.keys():
            del self._polls[key]
        for key, interval in intervals.items():
            poll = self._polls.get(key)
            if poll is None:
                self._polls[key] = _Poll(interval, now)
            elif poll.interval != interval:
                poll.due = min(poll.due, now + interval)
                poll.interval = interval

    def remove(self, key: Key) -> None:
        """Poll a message no more, until the next `set_intervals`."""
        self._polls.pop(key, None)

    def next_due(self) -> float:
        """Return when the next message is to be requested; infinite without one."""
        earliest = min((poll.due for poll in self._polls.values()), default=inf)
        return max(earliest, self._free_at)

    def take(self, now: float) -> Key | None:
        """Return the message to request now, which then is due again after its interval; None: none yet."""
        if now < self._free_at:
            return None
        due = [(now - poll.due) / poll.interval for poll in self._polls.values()]
        latest = max(due, default=-1.0)
        if latest < 0:
            return None
        key = tuple(self._polls)[due.index(latest)]
        poll = self._polls[key]
        # Skip missed polls; otherwise keep the phase.
        poll.due = poll.due + poll.interval if now < poll.due + poll.interval else now + poll.interval
        return key

    def finished(self, started: float, now: float) -> None:
        """Record a request that began at `started` and has ended now."""
        self._free_at = now + (now - started) * self._rest
