"""A sender of one message at a constant rate: setpoints, stick positions, and others useless when late.

The ticks lie on a grid that begins at the start, so the rate does not drift. Ticks missed during a stall are
not sent later: each tick sends the newest value once, and on a full link the message is made when there is
room.
"""

from __future__ import annotations

from abc import abstractmethod
from math import floor
from typing import TYPE_CHECKING

from mavstack.errors import InvalidArgumentError
from mavstack.services.service import Outgoing, Priority, Service

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.dialects import Message
    from mavstack.services.addressing import Address
    from mavstack.services.service import HasRoom

MAX_RATE = 1000.0


class Ticker:
    """Ticks at `rate` hertz, the first at `start`."""

    def __init__(self, rate: float, start: float) -> None:
        self._period = 1.0 / rate
        self._start = start
        self._number = 0

    @property
    def next(self) -> float:
        """The time of the next tick."""
        return self._start + self._number * self._period

    def passed(self, now: float) -> bool:
        """Return whether a tick is due; several that are due count as one."""
        if now < self.next:
            return False
        self._number = max(self._number, floor((now - self._start) / self._period)) + 1
        while self.next <= now:  # the next time may still have passed, because of rounding
            self._number += 1
        return True


class StreamSender(Service):
    """A sender of the message that `current_message` returns, at `rate` hertz, while it is started."""

    def __init__(self, local: Address, target: Address, rate: float) -> None:
        super().__init__(local)
        self.target = target
        self.rate = _checked_rate(rate)
        self.sent = 0
        self._ticker: Ticker | None = None
        self._pending = False

    @abstractmethod
    def current_message(self, now: float) -> Message | None:
        """Return the message to send now, or None."""

    @property
    def active(self) -> bool:
        """True while it is started."""
        return self._ticker is not None

    def start(self, now: float, rate: float | None = None) -> None:
        """Start, or continue at another rate (hertz)."""
        self.rate = self.rate if rate is None else _checked_rate(rate)
        self._ticker = Ticker(self.rate, now)
        self.handle_timeout(now)

    def stop(self, now: float) -> None:
        """Stop sending."""
        self._ticker = None
        self._pending = False

    def next_timeout(self) -> float | None:
        return None if self._ticker is None else self._ticker.next

    def handle_timeout(self, now: float) -> None:
        if self._ticker is not None and self._ticker.passed(now):
            self._pending = True

    def bulk_messages(self, now: float, has_room: HasRoom) -> Iterator[Outgoing]:
        if self._pending and has_room(self.target, Priority.STREAM):
            self._pending = False
            message = self.current_message(now)
            if message is not None:
                self.sent += 1
                yield Outgoing(message, self.target, Priority.STREAM)


def _checked_rate(rate: float) -> float:
    if not 0.0 < rate <= MAX_RATE:
        raise InvalidArgumentError(f"rate must be above 0 and at most {MAX_RATE:.0f} Hz, got {rate}")
    return float(rate)
