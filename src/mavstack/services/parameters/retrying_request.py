"""What reading and setting have in common, for plain and extended parameters alike.

One request is sent until it is answered, each time with more patience. A value can be set only as the type
that the component holds, so who does not know it asks for the parameter first.
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
#: So many answers with another value say that the component keeps it.
MAX_REFUSALS = 3
IDLE_TIMEOUT = 30.0


class RetryingRequest(Operation[Result]):
    """An operation that sends one request until it is answered."""

    timeout_error = ParameterTimeout

    def __init__(self, description: str, *, timeout: float | None = None) -> None:
        super().__init__(description, timeout=timeout, idle_timeout=IDLE_TIMEOUT)
        self._sent_at = 0.0
        self._silent = 0  # attempts in a row without any answer

    @property
    @abstractmethod
    def round_trip(self) -> RoundTrip:
        """The round trips of its client."""

    @abstractmethod
    def send_request(self) -> None:
        """Send what is asked."""

    def start(self, now: float) -> None:
        self.transmit(now)

    def handle_timeout(self, now: float) -> None:
        if self.attempts >= ATTEMPTS:
            self.time_out(now)
        else:
            self._silent += 1
            self.transmit(now)

    def transmit(self, now: float) -> None:
        """Send the request and wait."""
        self.send_request()
        self.attempts += 1
        self._sent_at = now
        self.timer = now + self.round_trip.timeout(self._silent + 1)

    def answered(self, now: float) -> None:
        """An answer came; an only request measures the round trip."""
        if self.attempts == 1:
            self.round_trip.add_sample(now - self._sent_at)


class SetRequest(RetryingRequest[Result]):
    """Sets one parameter; begins by asking for its type, if that is not known."""

    def __init__(self, name: str, kind: int | None, text: str, *, timeout: float | None = None) -> None:
        super().__init__(f"setting parameter {name} to {text} on", timeout=timeout)
        self.name = name
        self._kind = kind
        self._refusals = 0

    @abstractmethod
    def known_kind(self) -> int | None:
        """The type that the component told before."""

    @abstractmethod
    def reading(self) -> Operation[Any]:
        """What asks for the parameter, to learn its type."""

    @abstractmethod
    def begin_setting(self, now: float) -> None:
        """The type is known: send the value."""

    def start(self, now: float) -> None:
        if self._kind is None:
            self._kind = self.known_kind()
        if self._kind is None:
            self.begin(self.reading(), now)
        else:
            self.begin_setting(now)

    def child_ended(self, child: Operation[Any], now: float) -> None:
        if self.done:
            return
        if child.error is not None:
            self.fail(child.error)
        else:
            self._kind = child.result().type
            self.report_progress(now)
            self.begin_setting(now)
