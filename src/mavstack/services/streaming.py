"""Sending one kind of message at a kept rate: setpoints, stick positions, whatever is worthless when late.

The beats lie on a grid from the start on, so the rate does not drift. What a stall or a full link kept from
being sent is not made up for: on each beat goes what is newest then, once, and if the link has room for it
only later, it is made later.
"""

from __future__ import annotations

from abc import abstractmethod
from math import floor
from typing import TYPE_CHECKING

from mavstack.errors import FieldRangeError
from mavstack.services.service import Outgoing, Priority, Service

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.dialects import Message
    from mavstack.services.addressing import Address
    from mavstack.services.service import HasRoom

FASTEST = 1000.0


class Beats:
    """A grid of moments, `rate` a second, the first being `start`."""

    def __init__(self, rate: float, start: float) -> None:
        self._period = 1.0 / rate
        self._start = start
        self._number = 0

    @property
    def next(self) -> float:
        """The beat that is due next."""
        return self._start + self._number * self._period

    def passed(self, now: float) -> bool:
        """Whether a beat is due; all that are count as one."""
        if now < self.next:
            return False
        self._number = max(self._number, floor((now - self._start) / self._period)) + 1
        while self.next <= now:  # rounding
            self._number += 1
        return True


class StreamSender(Service):
    """Sends what `current_message` makes, at a kept rate, while it is started."""

    def __init__(self, local: Address, target: Address, rate: float) -> None:
        super().__init__(local)
        self.target = target
        self.rate = _checked(rate)
        self.sent = 0
        self._beats: Beats | None = None
        self._pending = False

    @abstractmethod
    def current_message(self, now: float) -> Message | None:
        """What to send now; None if there is nothing yet."""

    @property
    def active(self) -> bool:
        """Whether it is started."""
        return self._beats is not None

    def start(self, now: float, rate: float | None = None) -> None:
        """Begin, or go on at another rate."""
        self.rate = self.rate if rate is None else _checked(rate)
        self._beats = Beats(self.rate, now)
        self.handle_timeout(now)

    def stop(self, now: float) -> None:
        """Send nothing more."""
        self._beats = None
        self._pending = False

    def next_timeout(self) -> float | None:
        return None if self._beats is None else self._beats.next

    def handle_timeout(self, now: float) -> None:
        if self._beats is not None and self._beats.passed(now):
            self._pending = True

    def bulk_messages(self, now: float, has_room: HasRoom) -> Iterator[Outgoing]:
        if self._pending and has_room(self.target, Priority.STREAM):
            self._pending = False
            message = self.current_message(now)
            if message is not None:
                self.sent += 1
                yield Outgoing(message, self.target, Priority.STREAM)


def _checked(rate: float) -> float:
    if not 0.0 < rate <= FASTEST:
        raise FieldRangeError(f"{rate} a second is no rate from above 0 to {FASTEST:.0f}")
    return float(rate)
