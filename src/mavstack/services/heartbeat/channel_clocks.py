"""The boot clock of one address as each channel shows it: two clocks on two channels are two vehicles.

The arrival time of a message less its `time_boot_ms` is the moment of the boot, later by the delay of the
channel. Over two links to one vehicle the moments differ by the difference of the delays. A delay is at most
the round trip of the channel, which TIMESYNC measures; a link that does not answer may have any delay up to
`MAX_PATH_DELAY`. The least delay of the last seconds counts, so that jitter and other messages in a queue do
not matter. A clock that does not run at the pace of real time (a simulator that is slower, faster or paused)
or a queue that grows shifts its moment; it is no evidence until the moment is steady.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

#: The length of a period in seconds; the minimum delay is taken over the last two periods.
BUCKET = 1.0
#: Minimum number of messages in each of these two periods.
MIN_MESSAGES = 2
#: Seconds by which the boot time may differ between these two periods.
MAX_SHIFT = 0.25
#: Seconds by which the difference of two clocks must exceed the round trip: messages carry the time of their
#: measurement.
MARGIN = 1.0
#: Seconds for which two clocks must contradict each other to show a conflict.
CONTRADICTION_TIME = 2.0
#: Seconds without a message after which the clock of a channel is not known.
MAX_SILENCE = 1.5
MAX_CHANNELS = 8
_WRAP = 4294967.296


@dataclass(slots=True)
class _Clock:
    """The moments of the boot that one channel shows: the earliest of this bucket and of the one before."""

    began_at: float
    moment: float
    seen_at: float
    messages: int = 1
    previous: float | None = None
    previous_messages: int = 0

    def add(self, moment: float, now: float) -> None:
        if now - self.began_at >= BUCKET:
            is_next = now - self.began_at < 2 * BUCKET
            self.previous = self.moment if is_next else None
            self.previous_messages = self.messages
            self.began_at, self.moment, self.messages = now, moment, 0
        self.moment = min(self.moment, moment)
        self.messages += 1
        self.seen_at = now

    def steady(self, now: float) -> float | None:
        """Return the earliest moment of the last seconds; None if it is not steady."""
        enough = min(self.messages, self.previous_messages) >= MIN_MESSAGES
        if self.previous is None or not enough or now - self.seen_at > MAX_SILENCE:
            return None
        return min(self.moment, self.previous) if abs(self.moment - self.previous) <= MAX_SHIFT else None


class ChannelClocks:
    """The boot clocks of one address by channel.

    Args:
        round_trip: Returns the longest round trip of late to the address over a channel, in seconds.
    """

    def __init__(self, round_trip: Callable[[str, float], float]) -> None:
        self._round_trip = round_trip
        self._clocks: dict[str, _Clock] = {}
        #: The times of the first and the last contradiction of two channels.
        self._contradicted_since: dict[tuple[str, str], tuple[float, float]] = {}

    def add(self, time_boot_ms: int, now: float, channel: str) -> tuple[str, ...]:
        """Record a message; return the channels whose clocks contradict each other, or none."""
        moment = now - time_boot_ms / 1000
        clock = self._clocks.get(channel)
        if clock is None:
            if len(self._clocks) >= MAX_CHANNELS:
                self.forget_channel(min(self._clocks, key=lambda name: self._clocks[name].seen_at))
            self._clocks[channel] = _Clock(now, moment, now)
            return ()
        clock.add(moment, now)
        if len(self._clocks) == 1:
            return ()
        return next((pair for other in self._clocks if (pair := self._compare(channel, other, now))), ())

    def forget_channel(self, channel: str) -> None:
        """Forget a channel, or a boot that has ended."""
        self._clocks.pop(channel, None)
        pairs = [pair for pair in self._contradicted_since if channel in pair]
        for pair in pairs:
            del self._contradicted_since[pair]

    def _compare(self, channel: str, other: str, now: float) -> tuple[str, ...]:
        if channel == other:
            return ()
        pair = (channel, other) if channel < other else (other, channel)
        contradicts = self._contradicts(channel, other, now)
        if contradicts is None:
            return ()
        since, seen_at = self._contradicted_since.pop(pair, (now, now))
        if not contradicts:
            return ()
        if now - seen_at > CONTRADICTION_TIME:
            since = now
        self._contradicted_since[pair] = since, now
        return pair if now - since >= CONTRADICTION_TIME else ()

    def _contradicts(self, channel: str, other: str, now: float) -> bool | None:
        """Return whether two channels show boots further apart than the delay of the slower one explains.

        None: one of them is not steady.
        """
        mine, theirs = self._clocks[channel].steady(now), self._clocks[other].steady(now)
        if mine is None or theirs is None:
            return None
        gap = (mine - theirs + _WRAP / 2) % _WRAP - _WRAP / 2
        slower = channel if gap > 0 else other
        return abs(gap) > self._round_trip(slower, now) + MARGIN
