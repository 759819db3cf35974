"""How much a channel may carry: so that a slow radio's queue never grows behind our back.

A `Pacer` is a bucket of bytes that fills at the channel's bandwidth and that every byte sent empties, also
those that never wait (control messages), and on a link known to be half-duplex those that were received,
since both directions share the air. Bulk messages go only while there is something in the bucket, so they
take what the others leave; streams may run it a little below zero, so they go before bulk. But telemetry
often wants more than a radio carries, and a transfer would never end: while bulk waits, streams keep to a
share.

The bandwidth is known (`bandwidth=` of the link, a serial port's baud rate) or learned: a radio reports in
RADIO_STATUS how much of its queue is free (`txbuf`, percent). From the first report on the rate follows it,
down quickly and up slowly, as autopilots do; without either there is no limit. The queue of a radio that has
little to send is empty and says nothing about what it could carry, so the rate rises only while it is used.

Even a link without a limit may be told a `bulk_rate`, in packets a second: who listens by UDP has a buffer
for a few hundred packets, and of a whole file at once he gets its beginning.
"""

from __future__ import annotations

from math import inf

from mavstack.services import Priority

#: How far each priority may run the bucket below zero, in seconds of bandwidth.
DEBT = {Priority.CONTROL: inf, Priority.STREAM: 0.15, Priority.BULK: 0.0}
#: What streams may take of the bandwidth while bulk waits, and for how long it counts as waiting.
STREAM_SHARE = 0.15
WAITING = 0.5
#: What the bucket holds at most, in seconds of bandwidth: the longest burst after silence.
DEPTH = 0.05
#: The least that the bucket holds, in bytes: one packet, else nothing would ever go.
LEAST_DEPTH = 300.0
#: Where learning begins: what a radio at its factory settings carries, in bytes a second.
FIRST_ESTIMATE = 5760.0
LEAST_ESTIMATE = 200.0
#: The rate rises only if this share of it was used.
USED = 0.6
MOST_ESTIMATE = 1e6
#: So many packets of bulk go at once where only their rate is limited.
BULK_AT_ONCE = 100.0


class Pacer:
    """The bucket of one channel; `bandwidth` is in bytes a second, None for no limit known."""

    def __init__(
        self,
        bandwidth: float | None = None,
        *,
        half_duplex: bool = False,
        bulk_rate: float | None = None,
    ) -> None:
        self.bandwidth = bandwidth
        self.bulk_rate = bulk_rate
        self.learned = False
        self._bulk_level = BULK_AT_ONCE
        self.half_duplex = half_duplex
        self._known = bandwidth is not None
        self._level = LEAST_DEPTH
        self._stream_level = 0.0
        self._sent_since_status = 0
        self._status_at: float | None = None
        self._bulk_waited_at = -inf
        self._filled_at: float | None = None

    def sent(self, size: int, now: float, priority: Priority = Priority.CONTROL) -> None:
        """Bytes were handed to the channel."""
        if self.bandwidth is not None:
            self._fill(now)
            self._level -= size
            self._sent_since_status += size
            if priority is Priority.STREAM:
                self._stream_level = max(self._stream_level - size, -LEAST_DEPTH)
        elif self.bulk_rate is not None and priority is Priority.BULK:
            self._bulk_level -= 1.0

    def received(self, size: int, now: float) -> None:
        """Bytes came in, which took their time on the air too."""
        if self.half_duplex and self.bandwidth is not None:
            self._fill(now)
            self._level = max(self._level - size, -self.bandwidth * DEBT[Priority.STREAM])

    def has_room(self, priority: Priority, now: float) -> bool:
        """Whether a message of that priority may go now."""
        if self.bandwidth is None:
            return priority is not Priority.BULK or self._bulk_wait(now) <= 0
        self._fill(now)
        if priority is Priority.STREAM and self._stream_level <= 0 and now < self._bulk_waited_at + WAITING:
            return False
        room = self._level > -self.bandwidth * DEBT[priority]
        if priority is Priority.BULK and not room:
            self._bulk_waited_at = now
        return room

    def room_at(self, now: float) -> float:
        """When there is room for bulk again, if nothing else is sent until then."""
        if self.bandwidth is None:
            return now + self._bulk_wait(now)
        self._fill(now)
        missing = 1.0 - self._level
        return now + max(missing, 0.0) / self.bandwidth

    def radio_status(self, free_percent: int, now: float) -> None:
        """Take in what the radio tells about its transmit queue; 255 means that it does not know."""
        if self._known or not 0 <= free_percent <= 100:
            return
        if self.bandwidth is None:
            self.bandwidth, self.learned = FIRST_ESTIMATE, True
        self._fill(now)
        used = self._rate_since_status(now)
        change = _change(free_percent)
        if change > 1 and used < USED * self.bandwidth:
            return
        if change < 1:
            self.bandwidth = min(self.bandwidth, max(used, LEAST_ESTIMATE))
        self.bandwidth = min(max(self.bandwidth * change, LEAST_ESTIMATE), MOST_ESTIMATE)

    def _bulk_wait(self, now: float) -> float:
        """How long bulk has to wait where only its rate is limited, in seconds."""
        if self.bulk_rate is None:
            return 0.0
        since = now if self._filled_at is None else self._filled_at
        gained = max(now - since, 0.0) * self.bulk_rate
        self._bulk_level, self._filled_at = min(self._bulk_level + gained, BULK_AT_ONCE), now
        return max(1.0 - self._bulk_level, 0.0) / self.bulk_rate

    def _rate_since_status(self, now: float) -> float:
        """What was sent since the last report, in bytes a second; infinite at the first."""
        since, sent = self._status_at, self._sent_since_status
        self._status_at, self._sent_since_status = now, 0
        return inf if since is None else sent / max(now - since, 0.001)

    def _fill(self, now: float) -> None:
        bandwidth = self.bandwidth or 0.0
        if self._filled_at is None:
            self._filled_at = now
        depth = max(bandwidth * DEPTH, LEAST_DEPTH)
        gained = max(now - self._filled_at, 0.0) * bandwidth
        self._level = min(self._level + gained, depth)
        self._stream_level = min(self._stream_level + gained * STREAM_SHARE, depth * STREAM_SHARE)
        self._filled_at = now


def _change(free_percent: int) -> float:
    """By what the estimate is multiplied: a queue half full is near its end, an empty one takes more."""
    if free_percent < 20:
        return 0.6
    if free_percent < 50:
        return 0.85
    if free_percent > 95:
        return 1.15
    if free_percent > 90:
        return 1.05
    return 1.0
