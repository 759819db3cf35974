"""Pacing of a channel, so that the queue of a slow radio never grows.

A `Pacer` is a token bucket in bytes that fills at the channel's bandwidth. Every byte sent takes from it,
those of control messages too, which never wait; on a half-duplex link every byte received as well, since both
directions share the air. Bulk messages are sent only while the bucket is above zero, so they get the
bandwidth that the others leave; stream messages may overdraw the bucket a little, so they precede bulk.
Telemetry often needs more than a radio carries, and a transfer would never end: while bulk messages wait,
streams are limited to a share.

The bandwidth is known (`bandwidth=` of the link, a serial port's baud rate) or estimated: a radio reports in
RADIO_STATUS how much of its queue is free (`txbuf`, percent). From the first report on, the estimate follows
it, down quickly and up slowly, as autopilots do. With neither, there is no limit. The queue of an idle
radio is empty at any bandwidth, so above the first estimate it rises only while the bandwidth is used. Any
program on a shared link can forge a RADIO_STATUS: only reports of radio components count, at a limited rate;
an estimate that no report confirms is forgotten after 10 s, and reports of an empty queue bring it back to
the first estimate within half a minute. On a link that verifies signatures only signed reports count: a radio
sends none, so such a link is given its `bandwidth`.

A link without a known bandwidth may have a `bulk_rate`, in packets per second: a UDP receiver buffers a few
hundred packets and drops the tail of a large burst.
"""

from __future__ import annotations

from math import inf

from mavstack.dialects import common
from mavstack.services import Priority

#: By how much each priority may overdraw the token bucket, in seconds of bandwidth.
MAX_OVERDRAFT = {Priority.CONTROL: inf, Priority.STREAM: 0.15, Priority.BULK: 0.0}
#: Share of the bandwidth that streams get while bulk messages wait.
STREAM_SHARE = 0.15
#: Seconds after a refusal for which bulk messages count as waiting.
BULK_WAIT_TIMEOUT = 0.5
#: Size of the bucket in seconds of bandwidth: the longest burst after a pause.
MAX_BURST = 0.05
#: Minimum size of the bucket in bytes: one packet.
MIN_DEPTH = 300.0
#: First estimate of the bandwidth in bytes per second: a radio with factory settings.
DEFAULT_ESTIMATE = 5760.0
MIN_ESTIMATE = 200.0
MAX_ESTIMATE = 1e6
#: Minimum seconds between two RADIO_STATUS that change the estimate: radios send one or two per second.
MIN_STATUS_INTERVAL = 0.1
#: Seconds without RADIO_STATUS after which an estimate is discarded.
ESTIMATE_TIMEOUT = 10.0
#: Minimum used share of the estimated bandwidth for the estimate to rise.
MIN_USED_SHARE = 0.6
#: The largest burst of bulk packets on a channel that only `bulk_rate` limits, in packets.
MAX_BULK_BURST = 100.0

_RADIO_COMPONENTS = frozenset({common.MavComponent.TELEMETRY_RADIO, common.MavComponent.UDP_BRIDGE})


class Pacer:
    """The token bucket of one channel; `bandwidth` in bytes per second, None: not known."""

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
        self._bulk_level = MAX_BULK_BURST
        self.half_duplex = half_duplex
        self._known = bandwidth is not None
        self._level = MIN_DEPTH
        self._stream_level = 0.0
        self._sent_since_status = 0
        self._status_at: float | None = None
        self._learned_at = -inf
        self._bulk_waited_at = -inf
        self._filled_at: float | None = None

    def sent(self, size: int, now: float, priority: Priority = Priority.CONTROL) -> None:
        """Record bytes that were sent over the channel."""
        if self.learned:
            self._forget_old_estimate(now)
        if self.bandwidth is not None:
            self._fill(now)
            self._level -= size
            self._sent_since_status += size
            if priority is Priority.STREAM:
                self._stream_level = max(self._stream_level - size, -MIN_DEPTH)
        elif self.bulk_rate is not None and priority is Priority.BULK:
            self._bulk_level -= 1.0

    def received(self, size: int, now: float) -> None:
        """Record bytes that were received; on a half-duplex channel they take from the bucket too."""
        if self.half_duplex and self.bandwidth is not None:
            self._fill(now)
            self._level = max(self._level - size, -self.bandwidth * MAX_OVERDRAFT[Priority.STREAM])

    def has_room(self, priority: Priority, now: float) -> bool:
        """Return whether a message of that priority may be sent now."""
        if self.learned:
            self._forget_old_estimate(now)
        if self.bandwidth is None:
            return priority is not Priority.BULK or self._bulk_wait(now) <= 0
        self._fill(now)
        if (
            priority is Priority.STREAM
            and self._stream_level <= 0
            and now < self._bulk_waited_at + BULK_WAIT_TIMEOUT
        ):
            return False
        room = self._level > -self.bandwidth * MAX_OVERDRAFT[priority]
        if priority is Priority.BULK and not room:
            self._bulk_waited_at = now
        return room

    def room_at(self, now: float) -> float:
        """Return the time at which bulk messages have room again, if nothing else is sent until then."""
        if self.bandwidth is None:
            return now + self._bulk_wait(now)
        self._fill(now)
        missing = 1.0 - self._level
        return now + max(missing, 0.0) / self.bandwidth

    def radio_status(self, free_percent: int, now: float) -> None:
        """Update the estimate from a radio's free queue space in percent; 255: not known."""
        if self._known or not 0 <= free_percent <= 100:
            return
        if self.learned and now < self._learned_at + MIN_STATUS_INTERVAL:
            return
        self._learned_at = now
        if self.bandwidth is None:
            self.bandwidth, self.learned = DEFAULT_ESTIMATE, True
        self._fill(now)
        used = self._rate_since_status(now)
        change = _estimate_factor(free_percent)
        is_confirmed = used >= MIN_USED_SHARE * self.bandwidth or self.bandwidth < DEFAULT_ESTIMATE
        if change > 1 and not is_confirmed:
            return
        if change < 1:
            self.bandwidth = min(self.bandwidth, max(used, MIN_ESTIMATE))
        self.bandwidth = min(max(self.bandwidth * change, MIN_ESTIMATE), MAX_ESTIMATE)

    def _bulk_wait(self, now: float) -> float:
        """Return the seconds that bulk messages have to wait where only `bulk_rate` limits them."""
        if self.bulk_rate is None:
            return 0.0
        since = now if self._filled_at is None else self._filled_at
        gained = max(now - since, 0.0) * self.bulk_rate
        self._bulk_level, self._filled_at = min(self._bulk_level + gained, MAX_BULK_BURST), now
        return max(1.0 - self._bulk_level, 0.0) / self.bulk_rate

    def _rate_since_status(self, now: float) -> float:
        """Return the bytes per second sent since the last report; infinite at the first."""
        since, sent = self._status_at, self._sent_since_status
        self._status_at, self._sent_since_status = now, 0
        return inf if since is None else sent / max(now - since, 0.001)

    def _forget_old_estimate(self, now: float) -> None:
        """Forget an estimate that no report has confirmed for `ESTIMATE_TIMEOUT`: the radio is gone."""
        if self.learned and now >= self._learned_at + ESTIMATE_TIMEOUT:
            self.bandwidth, self.learned, self._status_at = None, False, None
            self._level, self._stream_level, self._filled_at = MIN_DEPTH, 0.0, None

    def _fill(self, now: float) -> None:
        bandwidth = self.bandwidth or 0.0
        if self._filled_at is None:
            self._filled_at = now
        depth = max(bandwidth * MAX_BURST, MIN_DEPTH)
        gained = max(now - self._filled_at, 0.0) * bandwidth
        self._level = min(self._level + gained, depth)
        self._stream_level = min(self._stream_level + gained * STREAM_SHARE, depth * STREAM_SHARE)
        self._filled_at = now


def is_radio(component: int) -> bool:
    """Return whether a component id is that of a radio: SiK radios use 51/68, bridges 240 of any system."""
    return component in _RADIO_COMPONENTS


def _estimate_factor(free_percent: int) -> float:
    """Return the factor for the estimate: below 1 for a filling queue, above 1 for a nearly empty one."""
    if free_percent < 20:
        return 0.6
    if free_percent < 50:
        return 0.85
    if free_percent > 95:
        return 1.15
    if free_percent > 90:
        return 1.05
    return 1.0
