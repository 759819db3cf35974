"""Following the clock of another component (guide: time synchronization protocol).

A TIMESYNC with `tc1` 0 is a request and carries the sender's time in `ts1`; the answer has both. Peers of
the protocol's first version answer to everybody, so an answer counts only if its `ts1` is one that we said
and did not have back yet. Requests are frequent until the estimate is good and rare from then on.
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

FIRST_INTERVAL = 0.2
#: For so many requests the first interval holds, also if no one answers.
FIRST_REQUESTS = 20
OUTSTANDING = 16
#: An exchange that took longer says nothing about a clock.
LONGEST_ROUND_TRIP = 5.0


def unix_nanoseconds(now: float) -> int:
    """The clock that a service has: Unix time."""
    return round(now * 1e9)


@dataclass(frozen=True, slots=True)
class TimeOffsetChanged(Event):
    """There is a new estimate; `jumped` if a clock was set or the other end was started anew."""

    estimate: TimeOffset
    jumped: bool = False


class TimesyncClient(Service):
    """Asks one component for its time, again and again."""

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
        #: Whether the target answers to us alone; False if it speaks the first version of the protocol.
        self.addressed: bool | None = None
        self._interval = interval
        self._clock = clock
        self._estimator = OffsetEstimator()
        self._outstanding: OrderedDict[int, float] = OrderedDict()
        self._sent = 0
        self._due = 0.0

    @property
    def estimate(self) -> TimeOffset | None:
        """What is known; None until the first answer."""
        return self._estimator.estimate

    def to_remote(self, local_nanoseconds: int) -> int | None:
        """A time of our clock as the other clock tells it."""
        known = self.estimate
        return None if known is None else local_nanoseconds + round(known.offset * 1e9)

    def to_local(self, remote_nanoseconds: int) -> int | None:
        """A time of the other clock as ours tells it."""
        known = self.estimate
        return None if known is None else remote_nanoseconds - round(known.offset * 1e9)

    def receive(self, packet: Packet, now: float) -> None:
        match packet.message:
            case common.Timesync(tc1=theirs, ts1=ours) as answer if theirs and ours in self._outstanding:
                sent_at = self._outstanding.pop(ours)
                self.addressed = answer.target_system != 0
                if now - sent_at <= LONGEST_ROUND_TRIP:
                    middle = (ours + self._clock(now)) // 2
                    self._measured((theirs - middle) / 1e9, now - sent_at)

    def next_timeout(self) -> float:
        return self._due

    def handle_timeout(self, now: float) -> None:
        if now < self._due:
            return
        known = self.estimate
        early = self._sent < FIRST_REQUESTS and not (known and known.converged)
        self._due = now + (min(FIRST_INTERVAL, self._interval) if early else self._interval)
        self._request(now)

    def _request(self, now: float) -> None:
        stamp = self._clock(now)
        self._outstanding[stamp] = now
        if len(self._outstanding) > OUTSTANDING:
            self._outstanding.popitem(last=False)
        self._sent += 1
        to = self.target
        self.send(
            common.Timesync(tc1=0, ts1=stamp, target_system=to.system, target_component=to.component), to
        )

    def _measured(self, offset: float, round_trip: float) -> None:
        jumped = self._estimator.add(offset, round_trip)
        known = self.estimate
        if known is not None:
            self.emit(TimeOffsetChanged(known, jumped))
