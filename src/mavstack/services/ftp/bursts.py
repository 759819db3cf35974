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
#: So many packets earlier is the next burst asked for if the end of this one is only known from experience.
EARLIER = 3.0
#: So many bursts in a row must bring all that was expected before more is.
FULL_ONES = 16
#: Below this share of new data among what bursts bring they are not worth it.
LEAST_NOVELTY = 0.85
#: Reads ask for each packet and lose some, so bursts are worth it while they leave less than this idle.
LEAST_USE, LEAST_CYCLES = 0.75, 12


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
    first_at: float = 0.0
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
        self._cycles = 0
        self._use = 1.0
        self._doubling = True
        self._full = 0
        self._short_ones = 0
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
            burst.first_at = now
            self._settle_before(burst, now)
        burst.packets += 1
        self._heard_at = now
        burst.received += end - start
        burst.last_at = now
        burst.furthest = max(burst.furthest, end)
        if start == burst.run:
            burst.run = end
        self.novelty += (new / (end - start) - self.novelty) * (end - start) / MOST_DATA / 32

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

    @property
    def delay(self) -> float:
        """How long a request takes to show effect, 0 if not known."""
        return self._latency.smoothed or 0.0

    @property
    def overrun(self) -> bool:
        """Whether bursts end where a queue is full: then a hole's answer would take the place of a packet."""
        return self.expected is not None and not self._exact

    @property
    def leave_link_idle(self) -> bool:
        """Whether the link waits for requests so much that several reads at once use it better."""
        return self.overrun and self._cycles >= LEAST_CYCLES and self._use < LEAST_USE

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
        packets = 0.8 * latency / max(gap, 1e-5) + (0.0 if self._exact else EARLIER)
        return packets * MOST_DATA

    def _settle_before(self, burst: Burst, now: float) -> None:
        """The first packet of a burst ends the one before it."""
        place = next(index for index, known in enumerate(self._recent) if known is burst)
        if place and self._recent[place - 1].packets and burst is self.active and self.expected is not None:
            self._learn(self._recent[place - 1])
            self._measure_use(self._recent[place - 1], now)

    def _measure_use(self, burst: Burst, now: float) -> None:
        """What share of the time from one burst to the next its packets took, at their own pace."""
        cycle = now - burst.first_at
        use = burst.packets * (self._gaps.smoothed or 0.0) / max(cycle, 1e-6)
        self._cycles += 1
        self._use += (min(use, 1.0) - self._use) / 8

    def _learn(self, burst: Burst) -> None:
        length, expected = max(burst.length, MOST_DATA), self.expected
        if expected is None:
            self.expected = length
        elif self._exact and length * 2 >= expected:
            return
        elif length >= expected:
            self._brought_all(length, expected)
        elif self._short_ones or length * 4 < expected * 3:
            self.expected, self._doubling, self._exact = length, False, False
            self._full = self._short_ones = 0
        else:
            self._full, self._short_ones, self._doubling = 0, 1, False

    def _brought_all(self, length: int, expected: int) -> None:
        """What comes twice is dearer than a hole, so what was brought beyond is expected at once."""
        self._full, self._short_ones = self._full + 1, 0
        if self._doubling:
            self.expected = max(length, 2 * expected)
        elif self._full >= FULL_ONES:
            self.expected, self._full = max(length, expected + MOST_DATA), 0
        else:
            self.expected = length
