"""Bursts: one request, many packets; the last packet says where the burst ends, if it arrives.

A server that does not know the speed of the link behind it sends a burst at once, and a radio drops the
packets that its queue does not hold. That costs no link capacity, as long as the next request arrives when
the queue runs empty. So the tracker learns from the received packets how many bytes a burst brings
(`expected`), and the next burst, for the data behind it, is requested one round trip before the end of the
current one. A server that limits its bursts is treated alike. A burst of a paced server is not cut: nothing
ends it before the server says so.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from mavstack.services.ftp.exchange import BURST_SEQUENCES
from mavstack.services.ftp.payload import MAX_DATA, SEQUENCES
from mavstack.services.timing import RoundTrip

if TYPE_CHECKING:
    from mavstack.services.ftp.payload import FtpPayload

MAX_BURSTS = 8
#: Seconds added to the timeout of a burst request, because a repeated request makes the server send the burst
#: twice.
TIMEOUT_MARGIN = 0.05
#: The number of packets by which the next burst is requested earlier while `expected` is only an estimate.
EARLY_PACKETS = 3.0
#: The number of consecutive bursts with all expected bytes after which more bytes are expected.
FULL_BURSTS_BEFORE_GROWTH = 16
#: Bursts are not worthwhile if a smaller share of their data is new.
MIN_NOVELTY = 0.85
#: Bursts are not worthwhile either if they use a smaller share of the link, measured over at least this
#: number of bursts.
MIN_LINK_USE, MIN_MEASURED_BURSTS = 0.75, 12


@dataclass(slots=True)
class Burst:
    """One burst, as far as it was received."""

    request: FtpPayload
    sent_at: float
    attempts: int = 1
    packets: int = 0
    received: int = 0
    run: int = field(init=False)  # the end of the data received without a gap
    furthest: int = field(init=False)
    first_at: float = 0.0
    last_at: float = 0.0

    def __post_init__(self) -> None:
        self.run = self.furthest = self.start

    @property
    def start(self) -> int:
        """The requested offset."""
        return self.request.offset

    @property
    def length(self) -> int:
        """The number of bytes that it spans, including lost packets but not stale ones."""
        span = self.furthest - self.start
        return span if self.received * 2 >= span else self.run - self.start


class BurstTracker:
    """The tracker of the bursts of one transfer."""

    def __init__(self) -> None:
        self.expected: int | None = None
        self.novelty = 1.0
        self.active: Burst | None = None
        self._recent: list[Burst] = []
        self._exact = False
        self._received_at = 0.0
        self._measured_bursts = 0
        self._link_use = 1.0
        self._doubling = True
        self._full_bursts = 0
        self._short_bursts = 0
        self._spacing = RoundTrip(initial=0.2, minimum=0.005, maximum=2.0)
        self._latency = RoundTrip(initial=0.5, minimum=0.02, maximum=3.0)

    def begin(self, request: FtpPayload, now: float, *, attempts: int = 1) -> None:
        """Record the request of a burst; the one before may still deliver packets.

        `attempts` is more than 1 if the requests before it were not answered.
        """
        self.active = burst = Burst(request, now, attempts)
        self._recent = [*self._recent[1 - MAX_BURSTS :], burst]

    def of(self, reply: FtpPayload) -> Burst | None:
        """Return the burst that a packet belongs to."""
        for burst in reversed(self._recent):
            if (reply.sequence - burst.request.sequence - 1) % SEQUENCES < BURST_SEQUENCES:
                return burst
        return None

    def arrived(self, burst: Burst, start: int, end: int, new: int, now: float) -> None:
        """Record a packet of a burst; `new` of its bytes were missing."""
        if burst.packets:
            self._spacing.add_sample(now - burst.last_at)
        else:
            if burst.attempts == 1:
                self._latency.add_sample(now - burst.sent_at)
            burst.first_at = now
            self._end_previous(burst, now)
        burst.packets += 1
        self._received_at = now
        burst.received += end - start
        burst.last_at = now
        burst.furthest = max(burst.furthest, end)
        if start == burst.run:
            burst.run = end
        self.novelty += (new / (end - start) - self.novelty) * (end - start) / MAX_DATA / 32

    def completed(self, burst: Burst) -> None:
        """Record that the server ended a burst."""
        if burst is self.active:
            self.expected, self._exact = max(burst.length, MAX_DATA), True
            self.active = None

    def timed_out(self) -> None:
        """Record that the active burst timed out."""
        burst, self.active = self.active, None
        if burst is not None and burst.packets:
            self._learn(burst)

    def timeout_at(self) -> float | None:
        """Return when the active burst times out."""
        burst = self.active
        if burst is None:
            return None
        if not burst.packets:
            waiting_since = max(burst.sent_at, self._received_at)
            return waiting_since + self._latency.timeout(burst.attempts) + TIMEOUT_MARGIN
        return burst.last_at + max(2 * self._spacing.timeout(), self._latency.smoothed or 0.0, 0.03)

    @property
    def delay(self) -> float:
        """Seconds from a request to its first packet; 0 if unknown."""
        return self._latency.smoothed or 0.0

    @property
    def overrun(self) -> bool:
        """True if bursts end where a queue is full: then a read would displace a packet of the burst."""
        return self.expected is not None and not self._exact

    @property
    def leave_link_idle(self) -> bool:
        """True if the link is idle so much that several concurrent reads use it better."""
        return self.overrun and self._measured_bursts >= MIN_MEASURED_BURSTS and self._link_use < MIN_LINK_USE

    def next_start(self) -> int | None:
        """Return the offset of the next burst to request during the current one; None: not yet."""
        burst = self.active
        if burst is None or self.expected is None or burst.packets < min(3, self.expected // MAX_DATA):
            return None
        rest = burst.start + self.expected - burst.furthest
        return burst.start + self.expected if rest <= self._lead() else None

    def _lead(self) -> float:
        """Return the bytes that still arrive before a request takes effect."""
        gap, latency = self._spacing.smoothed, self._latency.smoothed
        if gap is None or latency is None:
            return 0.0
        packets = 0.8 * latency / max(gap, 1e-5) + (0.0 if self._exact else EARLY_PACKETS)
        return packets * MAX_DATA

    def _end_previous(self, burst: Burst, now: float) -> None:
        """End the burst before a burst that delivers its first packet."""
        position = next(index for index, known in enumerate(self._recent) if known is burst)
        if (
            position
            and self._recent[position - 1].packets
            and burst is self.active
            and self.expected is not None
        ):
            self._learn(self._recent[position - 1])
            self._measure_use(self._recent[position - 1], now)

    def _measure_use(self, burst: Burst, now: float) -> None:
        """Measure the share of the time between two bursts that the packets of the first one took."""
        cycle = now - burst.first_at
        use = burst.packets * (self._spacing.smoothed or 0.0) / max(cycle, 1e-6)
        self._measured_bursts += 1
        self._link_use += (min(use, 1.0) - self._link_use) / 8

    def _learn(self, burst: Burst) -> None:
        length, expected = max(burst.length, MAX_DATA), self.expected
        if expected is None:
            self.expected = length
        elif self._exact and length * 2 >= expected:
            return
        elif length >= expected:
            self._raise_expected(length, expected)
        elif self._short_bursts or length * 4 < expected * 3:
            self.expected, self._doubling, self._exact = length, False, False
            self._full_bursts = self._short_bursts = 0
        else:
            self._full_bursts, self._short_bursts, self._doubling = 0, 1, False

    def _raise_expected(self, length: int, expected: int) -> None:
        """Raise `expected`: data received twice costs more than missing data."""
        self._full_bursts, self._short_bursts = self._full_bursts + 1, 0
        if self._doubling:
            self.expected = max(length, 2 * expected)
        elif self._full_bursts >= FULL_BURSTS_BEFORE_GROWTH:
            self.expected, self._full_bursts = max(length, expected + MAX_DATA), 0
        else:
            self.expected = length
