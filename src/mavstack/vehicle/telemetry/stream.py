"""A stream of one vehicle's messages, which requests them where the vehicle does not send them by itself.

    started ── rate given ────────────────────────────────────► requested
      ├── no rate: REQUEST_DELAY ── some arrived ──► done
      │              └── none arrived ──► requested at DEFAULT_RATE
      └── a message that is sent only as an answer ───────────► requested once
    requested ── accepted ──► done
      └── refused: REFUSAL_DELAY ── some arrived anyway ──► done
                     └── none arrived ──► the stream raises the refusal

A rate that a stream requested is released when the stream ends. The default rate stays, since a program that
reads a message once will use its latest value too. If only some of several messages are refused, the stream
goes on with the others, and `denied` holds the refusals.
"""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Generic, TypeVar

from mavstack.dialects import Message
from mavstack.errors import CommandDenied, InvalidArgumentError, MavstackError, RemoteError
from mavstack.node.api_object import ReadOnly
from mavstack.vehicle.telemetry.periodic import is_answer, is_periodic

if TYPE_CHECKING:
    from types import TracebackType
    from typing import Any, Self

    from mavstack.node.subscription import Subscription
    from mavstack.vehicle.telemetry.rates import RateRequest
    from mavstack.vehicle.telemetry.telemetry import Telemetry

AnyMessage = TypeVar("AnyMessage", bound=Message)

#: The rate that is requested if none is given, in hertz.
DEFAULT_RATE = 4.0
#: The time to wait for messages that the vehicle may send by itself, in seconds.
REQUEST_DELAY = 1.5
#: The time in which messages may arrive after a refusal, in seconds; older messages do not count.
REFUSAL_DELAY = 4.0


class MessageStream(ReadOnly, Generic[AnyMessage]):
    """An async iterator of one vehicle's messages; made by `Vehicle.stream`.

    `async with` ends the stream with the block, and so does dropping the last reference to it. A reader that
    is too slow loses the oldest messages (`dropped`).
    """

    def __init__(
        self,
        source: Telemetry,
        messages: tuple[type[AnyMessage], ...],
        subscription: Subscription[AnyMessage],
        rate: float | None,
    ) -> None:
        if rate is not None and not messages:
            subscription.close()
            raise InvalidArgumentError("name the message classes to which the rate applies")
        self._request = _StreamRequest(source, messages, rate, subscription)
        self._subscription = subscription

    @property
    def dropped(self) -> int:
        """The number of messages that were lost because they were not read in time."""
        return self._subscription.dropped

    @property
    def denied(self) -> dict[type[Message], CommandDenied]:
        """The refusals of the rate, by message class."""
        return dict(self._request.denied)

    def drain(self) -> list[AnyMessage]:
        """Return all messages that arrived and were not read, without waiting."""
        return self._subscription.drain()

    def close(self) -> None:
        """Unsubscribe, and release the requested rate. Idempotent."""
        self._request.end()

    def __aiter__(self) -> Self:
        return self

    async def __anext__(self) -> AnyMessage:
        """Return the next message.

        Raises:
            CommandDenied: The vehicle refused to send the messages, and none arrived.
            StopAsyncIteration: The stream or its connection was closed.
        """
        request = self._request
        if not request.started:
            request.start()
        try:
            return await self._subscription.__anext__()
        except StopAsyncIteration:
            if request.error is None:
                raise
        raise request.error

    async def __aenter__(self) -> Self:
        if not self._request.started:
            self._request.start()
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def __del__(self) -> None:
        request = self.__dict__.get("_request")
        if request is not None:
            request.abandon()


class _StreamRequest:
    """Requests the messages of a stream. It holds no reference to the stream, which can be collected."""

    def __init__(
        self,
        source: Telemetry,
        messages: tuple[type[Message], ...],
        rate: float | None,
        subscription: Subscription[Any],
    ) -> None:
        self._source, self._messages, self._rate = source, messages, rate
        self._subscription = subscription
        self._requests: list[RateRequest] = []
        self._task: asyncio.Task[None] | None = None
        self._loop: asyncio.AbstractEventLoop | None = None
        self._since = 0.0
        self.denied: dict[type[Message], CommandDenied] = {}
        self.error: MavstackError | None = None
        self.started = False

    def start(self) -> None:
        """Wait for the messages, and request them if need be."""
        self.started = True
        if not self._messages or self._subscription.closed:
            return
        self._since = self._source.node.now() - REFUSAL_DELAY
        if self._rate is not None:
            self._requests = [self._source.rates.hold(message, self._rate) for message in self._messages]
        self._loop = asyncio.get_running_loop()
        self._task = self._loop.create_task(self._run())

    def end(self) -> None:
        """Unsubscribe, and release the requested rate. Idempotent."""
        self._subscription.close()
        if self._task is not None:
            self._task.cancel()
        requests, self._requests = self._requests, []
        for request in requests:
            self._source.rates.release(request)

    def abandon(self) -> None:
        """End the request from any thread, as the garbage collector does."""
        if self._loop is None:
            self._subscription.close()
        elif not self._loop.is_closed() and (self._requests or not self._subscription.closed):
            self._loop.call_soon_threadsafe(self.end)

    async def _run(self) -> None:
        try:
            await self._ask()
        except MavstackError as error:
            if not self._subscription.closed:
                self._fail(error)

    async def _ask(self) -> None:
        messages = self._messages
        for message in filter(is_answer, messages if self._rate is None else ()):
            await self._request_once(message)
        if self._rate is None and not all(map(is_answer, messages)):
            await asyncio.sleep(REQUEST_DELAY)
        for message in messages:
            if self._rate is not None or (is_periodic(message) and not self._arrived(message)):
                await self._ask_for(message)
        if self.denied:
            await asyncio.sleep(REFUSAL_DELAY)
            if not any(map(self._arrived, self._messages)):
                self._fail(next(iter(self.denied.values())))

    async def _ask_for(self, message: type[Message]) -> None:
        rates = self._source.rates
        if self._rate is None and message not in rates.held:
            rates.hold(message, DEFAULT_RATE)
        try:
            await rates.ask(message)
        except CommandDenied as error:
            self.denied[message] = error
        except RemoteError:
            return  # not answered: `Rates` repeats the request while the vehicle is alive

    async def _request_once(self, message: type[Message]) -> None:
        try:
            await self._source.component.request_message(message)
        except CommandDenied as error:
            self.denied[message] = error
        except RemoteError:
            return  # not answered: the message may still arrive

    def _arrived(self, message: type[Message]) -> bool:
        received_at = self._source.received_at(message)
        return received_at is not None and received_at >= self._since

    def _fail(self, error: MavstackError) -> None:
        self.error = error
        self._subscription.close()
