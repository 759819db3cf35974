"""The ping client (guide: PING protocol).

A PING whose target fields are 0 is a request, and each component that receives it answers with its number and
time, addressed to the sender. So the request is routed toward one component only, and answers of others are
ignored. An answer counts once, and late ones count until the wait for the last ping ends.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services.addressing import Address, message_ids
from mavstack.services.operation import Client, Operation
from mavstack.services.ping.statistics import PingStatistics

if TYPE_CHECKING:
    from mavstack.wire import Packet

SEQUENCES = 1 << 32


class PingOperation(Operation[PingStatistics]):
    """Several pings; it ends when `enough` were answered, and fails if none was."""

    def __init__(
        self,
        first: int,
        count: int,
        *,
        interval: float,
        enough: int,
        wait: float,
        timeout: float | None = None,
    ) -> None:
        super().__init__("pinging", timeout=timeout, idle_timeout=count * interval + wait + 1.0)
        self._next = first
        self._count, self._interval, self._enough, self._wait = count, interval, enough, wait
        # by sequence number: `time_usec`, and the time of sending
        self._outstanding: dict[int, tuple[int, float]] = {}
        self._answered: set[int] = set()
        self._round_trips: list[float] = []
        self._duplicates = 0

    def start(self, now: float) -> None:
        self._transmit(now)

    def receive(self, packet: Packet, now: float) -> None:
        match packet.message:
            case common.Ping(seq=number, time_usec=stamp, target_system=to) if to:
                self._answer(number, stamp, now)

    def handle_timeout(self, now: float) -> None:
        if self.attempts < self._count:
            self._transmit(now)
        elif self._round_trips:
            self._end()
        else:
            self.time_out(now)

    def _transmit(self, now: float) -> None:
        number, stamp = self._next, round(now * 1e6)
        self._next = (self._next + 1) % SEQUENCES
        self._outstanding[number] = stamp, now
        self.attempts += 1
        self.timer = now + (self._interval if self.attempts < self._count else self._wait)
        self.send(common.Ping(time_usec=stamp, seq=number))

    def _answer(self, number: int, stamp: int, now: float) -> None:
        if number in self._answered:
            self._duplicates += 1
        elif number in self._outstanding and self._outstanding[number][0] == stamp:
            sent_at = self._outstanding.pop(number)[1]
            self._answered.add(number)
            self._round_trips.append(now - sent_at)
            self.report_progress(now, len(self._round_trips), self._count)
            if len(self._round_trips) >= self._enough:
                self._end()

    def _end(self) -> None:
        self.finish(PingStatistics(self.attempts, tuple(self._round_trips), self._duplicates))


class PingClient(Client):
    """The ping client of one component."""

    handles = message_ids(common.Ping)

    def __init__(self, local: Address, target: Address) -> None:
        super().__init__(local, target)
        self._next = 0

    def ping(
        self,
        now: float,
        *,
        count: int = 4,
        interval: float = 1.0,
        enough: int | None = None,
        wait: float = 2.0,
        timeout: float | None = None,
    ) -> PingOperation:
        """Send pings until enough of them are answered.

        Args:
            now: The time, Unix seconds.
            count: The maximum number of pings.
            interval: Seconds between two pings.
            enough: The number of answers after which to stop; None: `count`.
            wait: Seconds to wait for an answer to the last ping.
            timeout: Seconds for the whole operation; None sets no overall limit.

        Returns:
            The operation, whose result is a `PingStatistics`.

        Raises:
            InvalidArgumentError: An argument is out of range.
        """
        if count < 1 or interval <= 0 or wait <= 0 or (enough is not None and not 1 <= enough <= count):
            raise InvalidArgumentError(
                "ping needs count, interval and wait above 0, and enough from 1 to count"
            )
        first, self._next = self._next, (self._next + count) % SEQUENCES
        operation = PingOperation(
            first, count, interval=interval, enough=enough or count, wait=wait, timeout=timeout
        )
        return self.begin(operation, now)
