"""The time synchronisation client (guide: time synchronization protocol).

A TIMESYNC with `tc1` 0 is a request and carries the sender's time in `ts1`; the answer has both. Peers of
the protocol's first version broadcast their answers, so an answer counts only if its `ts1` is that of a
request that is not answered yet. Requests are frequent until the estimate has converged and rare afterwards.
"""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.addressing import Address, message_ids
from mavstack.services.service import Event, Service
from mavstack.services.timesync.estimator import OffsetEstimator, TimeOffset

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.wire import Packet

INITIAL_INTERVAL = 0.2
#: The number of requests at the initial interval, answered or not.
INITIAL_REQUESTS = 20
MAX_OUTSTANDING = 16
#: Exchanges with a longer round trip in seconds are ignored.
MAX_ROUND_TRIP = 5.0


def unix_nanoseconds(now: float) -> int:
    """Return the default clock: Unix time in nanoseconds."""
    return round(now * 1e9)


@dataclass(frozen=True, slots=True)
class TimeOffsetChanged(Event):
    """The estimate changed; `jumped` if a clock was set or the remote component rebooted."""

    estimate: TimeOffset
    jumped: bool = False


class TimesyncClient(Service):
    """The client that estimates the clock offset of one component.

    Args:
        local: The local component.
        target: The remote component.
        interval: Seconds between two requests after convergence.
        clock: Returns the local time in nanoseconds for a `now`.
    """

    handles = message_ids(common.Timesync)

    def __init__(
        self,
        local: Address,
        target: Address,
        *,
        interval: float = 5.0,
        clock: Callable[[float], int] = unix_nanoseconds,
    ) -> None:
        super().__init__(local)
        self.target = self.source_filter = target
        #: True if the answers of the target carry an address; False if it uses the first version of the
        #: protocol; None if not known.
        self.addressed: bool | None = None
        self._interval = interval
        self._clock = clock
        self._estimator = OffsetEstimator()
        self._outstanding: OrderedDict[int, float] = OrderedDict()
        self._sent = 0
        self._due = 0.0

    @property
    def estimate(self) -> TimeOffset | None:
        """The estimated offset; None until the first answer."""
        return self._estimator.estimate

    def to_remote(self, local_nanoseconds: int) -> int | None:
        """Convert a time of the local clock to the remote clock, nanoseconds; None without an estimate."""
        known = self.estimate
        return None if known is None else local_nanoseconds + round(known.offset * 1e9)

    def to_local(self, remote_nanoseconds: int) -> int | None:
        """Convert a time of the remote clock to the local clock, nanoseconds; None without an estimate."""
        known = self.estimate
        return None if known is None else remote_nanoseconds - round(known.offset * 1e9)

    def receive(self, packet: Packet, now: float) -> None:
        match packet.message:
            case common.Timesync(tc1=theirs, ts1=ours) as answer if theirs and ours in self._outstanding:
                sent_at = self._outstanding.pop(ours)
                self.addressed = answer.target_system != 0
                if now - sent_at <= MAX_ROUND_TRIP:
                    middle = (ours + self._clock(now)) // 2
                    self._add_sample((theirs - middle) / 1e9, now - sent_at)

    def next_timeout(self) -> float:
        return self._due

    def handle_timeout(self, now: float) -> None:
        if now < self._due:
            return
        known = self.estimate
        early = self._sent < INITIAL_REQUESTS and not (known and known.converged)
        self._due = now + (min(INITIAL_INTERVAL, self._interval) if early else self._interval)
        self._request(now)

    def _request(self, now: float) -> None:
        stamp = self._clock(now)
        self._outstanding[stamp] = now
        if len(self._outstanding) > MAX_OUTSTANDING:
            self._outstanding.popitem(last=False)
        self._sent += 1
        to = self.target
        self.send(
            common.Timesync(tc1=0, ts1=stamp, target_system=to.system, target_component=to.component), to
        )

    def _add_sample(self, offset: float, round_trip: float) -> None:
        jumped = self._estimator.add(offset, round_trip)
        known = self.estimate
        if known is not None:
            self.emit(TimeOffsetChanged(known, jumped))
