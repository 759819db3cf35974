"""Bursts: one request, many packets, and the server says when it stops, if that is heard.

A server that does not know how slow the link behind it is sends a burst at once; what a radio's queue does
not hold is dropped. That costs the radio nothing, as long as the next request is there when its queue runs
dry. So from what arrives is learned how much one burst brings (`expected`), and the next one, for what comes
behind, is asked for while the rest is still to come: as early as a request needs to show effect. A server
with a limit of its own to a burst is treated alike. A paced server's burst is not cut: nothing in it ends
before it says so.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from mavstack.services.ftp.exchange import BURST_SEQUENCES
from mavstack.services.ftp.payload import MOST_DATA, SEQUENCES
from mavstack.services.timing import RoundTrip

if TYPE_CHECKING:
    from mavstack.services.ftp.payload import FtpPayload

REMEMBERED = 8
#: Added to the wait for a burst to begin, in seconds: asked for twice it comes twice.
SLACK = 0.05
#: Below this share of new data among what bursts bring they are not worth it.
LEAST_NOVELTY = 0.85


@dataclass(slots=True)
class Burst:
    """One burst as far as it was heard."""

    request: FtpPayload
    sent_at: float
    attempts: int = 1
    packets: int = 0
    received: int = 0
    run: int = field(init=False)  # where its unbroken beginning ends
    furthest: int = field(init=False)
    last_at: float = 0.0

    def __post_init__(self) -> None:
        self.run = self.furthest = self.start

    @property
    def start(self) -> int:
        """Where it was asked to begin."""
        return self.request.offset

    @property
    def length(self) -> int:
        """How far it reached, holes by chance included, strays not."""
        span = self.furthest - self.start
        return span if self.received * 2 >= span else self.run - self.start


class Bursts:
    """The bursts of one transfer, and what they teach."""

    def __init__(self) -> None:
        self.expected: int | None = None
        self.novelty = 1.0
        self.active: Burst | None = None
        self._recent: list[Burst] = []
        self._exact = False
        self._heard_at = 0.0
        self._doubling = True
        self._gaps = RoundTrip(initial=0.2, least=0.005, most=2.0)
        self._latency = RoundTrip(initial=0.5, least=0.02, most=3.0)

    def begin(self, request: FtpPayload, now: float) -> None:
        """A burst was asked for; what is still heard of the one before belongs to it."""
        self.active = burst = Burst(request, now)
        self._recent = [*self._recent[1 - REMEMBERED :], burst]

    def of(self, reply: FtpPayload) -> Burst | None:
        """The burst that a packet belongs to."""
        for burst in reversed(self._recent):
            if (reply.sequence - burst.request.sequence - 1) % SEQUENCES < BURST_SEQUENCES:
                return burst
        return None

    def arrived(self, burst: Burst, start: int, end: int, new: int, now: float) -> None:
        """A packet of a burst came; `new` of its bytes were missing."""
        if burst.packets:
            self._gaps.measured(now - burst.last_at)
        else:
            if burst.attempts == 1:
                self._latency.measured(now - burst.sent_at)
            self._settle_before(burst)
        burst.packets += 1
        self._heard_at = now
        burst.received += end - start
        burst.last_at = now
        burst.furthest = max(burst.furthest, end)
        if start == burst.run:
            burst.run = end
        self.novelty += ((new > 0) - self.novelty) / 32

    def completed(self, burst: Burst) -> None:
        """The server said that it stops here."""
        if burst is self.active:
            self.expected, self._exact = max(burst.length, MOST_DATA), True
            self.active = None

    def fell_silent(self) -> None:
        """Nothing more comes."""
        burst, self.active = self.active, None
        if burst is not None and burst.packets:
            self._learn(burst)

    def quiet_at(self) -> float | None:
        """When the active burst counts as silent."""
        burst = self.active
        if burst is None:
            return None
        if not burst.packets:
            silent_since = max(burst.sent_at, self._heard_at)
            return silent_since + self._latency.timeout(burst.attempts) + SLACK
        return burst.last_at + max(2 * self._gaps.timeout(), self._latency.smoothed or 0.0, 0.03)

    def next_start(self) -> int | None:
        """Where to ask for the next burst while this one still comes; None: not yet."""
        burst = self.active
        if burst is None or self.expected is None or burst.packets < min(3, self.expected // MOST_DATA):
            return None
        rest = burst.start + self.expected - burst.furthest
        return burst.start + self.expected if rest <= self._lead() else None

    def _lead(self) -> float:
        """What still comes in the time in which a request shows effect."""
        gap, latency = self._gaps.smoothed, self._latency.smoothed
        if gap is None or latency is None:
            return 0.0
        return (0.8 * latency / max(gap, 1e-5)) * MOST_DATA

    def _settle_before(self, burst: Burst) -> None:
        """The first packet of a burst ends the one before it."""
        place = next(index for index, known in enumerate(self._recent) if known is burst)
        if place and self._recent[place - 1].packets and burst is self.active and self.expected is not None:
            self._learn(self._recent[place - 1])

    def _learn(self, burst: Burst) -> None:
        length = max(burst.length, MOST_DATA)
        if self.expected is None:
            self.expected = length
        elif self._exact and length * 2 >= self.expected:
            return
        elif length >= self.expected:
            grown = 2 * self.expected if self._doubling else self.expected + MOST_DATA
            self.expected = max(length, grown)
        else:
            self.expected, self._doubling, self._exact = length, False, False
