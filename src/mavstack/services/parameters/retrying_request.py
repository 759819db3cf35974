"""The base of getting and setting, for plain and extended parameters alike.

A request is repeated until it is answered, with increasing timeouts. A value can be set only with the type
that the component has, so a client that does not know the type requests the parameter first.
"""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING, TypeVar

from mavstack.errors import ParameterTimeout
from mavstack.services.operation import Operation

if TYPE_CHECKING:
    from typing import Any

    from mavstack.services.timing import RoundTrip

Result = TypeVar("Result")

ATTEMPTS = 6
#: The number of answers with another value after which the request counts as refused.
MAX_REFUSALS = 3
IDLE_TIMEOUT = 30.0


class RetryingRequest(Operation[Result]):
    """An operation that repeats one request until it is answered."""

    timeout_error = ParameterTimeout

    def __init__(self, description: str, *, timeout: float | None = None) -> None:
        super().__init__(description, timeout=timeout, idle_timeout=IDLE_TIMEOUT)
        self._sent_at = 0.0
        self._silent = 0  # consecutive attempts without any answer

    @property
    @abstractmethod
    def round_trip(self) -> RoundTrip:
        """The round trips of the client."""

    @abstractmethod
    def send_request(self) -> None:
        """Send the request."""

    def start(self, now: float) -> None:
        self.transmit(now)

    def handle_timeout(self, now: float) -> None:
        if self.attempts >= ATTEMPTS:
            self.time_out(now)
        else:
            self._silent += 1
            self.transmit(now)

    def transmit(self, now: float) -> None:
        """Send the request and set the timer."""
        self.send_request()
        self.attempts += 1
        self._sent_at = now
        self.timer = now + self.round_trip.timeout(self._silent + 1)

    def answered(self, now: float) -> None:
        """Record an answer; that to a single request is a round-trip sample."""
        if self.attempts == 1:
            self.round_trip.add_sample(now - self._sent_at)


class SetRequest(RetryingRequest[Result]):
    """The setting of one parameter; requests its type first, if that is unknown."""

    def __init__(self, name: str, kind: int | None, text: str, *, timeout: float | None = None) -> None:
        super().__init__(f"setting parameter {name} to {text} on", timeout=timeout)
        self.name = name
        self._kind = kind
        self._refusals = 0

    @abstractmethod
    def known_type(self) -> int | None:
        """Return the type as received before."""

    @abstractmethod
    def type_request(self) -> Operation[Any]:
        """Return the operation that requests the parameter, for its type."""

    @abstractmethod
    def send_value(self, now: float) -> None:
        """Send the value, once the type is known."""

    def start(self, now: float) -> None:
        if self._kind is None:
            self._kind = self.known_type()
        if self._kind is None:
            self.begin(self.type_request(), now)
        else:
            self.send_value(now)

    def child_ended(self, child: Operation[Any], now: float) -> None:
        if self.done:
            return
        if child.error is not None:
            self.fail(child.error)
        else:
            self._kind = child.result().type
            self.report_progress(now)
            self.send_value(now)
