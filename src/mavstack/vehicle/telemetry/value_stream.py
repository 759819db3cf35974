"""A stream of one telemetry value, and the wait for the first value.

    async for battery in vehicle.stream_battery(rate=1):
        print(battery.voltage)

A value can come from several messages, such as the attitude from ATTITUDE or ATTITUDE_QUATERNION. The message
that arrives already is the one that is requested at the rate, otherwise the first one that the vehicle does
not refuse.
"""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Generic, TypeVar

from mavstack.errors import CommandDenied, MessageTimeout, RemoteCancelled
from mavstack.node.api_object import ReadOnly
from mavstack.vehicle.telemetry.periodic import is_periodic
from mavstack.vehicle.telemetry.stream import MessageStream

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from types import TracebackType
    from typing import Any, Self

    from mavstack.dialects import Message
    from mavstack.vehicle.telemetry.telemetry import Telemetry

TelemetryValue = TypeVar("TelemetryValue")

#: A message that was received within this time, in seconds, is taken to be sent without a request.
_ARRIVES = 5.0
_QUEUE = 100


class ValueStream(ReadOnly, Generic[TelemetryValue]):
    """An async iterator of a telemetry value; made by `Vehicle.stream_position` and the like.

    It returns a value whenever the vehicle reports one. `async with` ends the stream with the block, and so
    does dropping the last reference to it. A slow reader gets the latest value.
    """

    def __init__(
        self,
        telemetry: Telemetry,
        read: Callable[[Telemetry], TelemetryValue | None],
        messages: tuple[type[Message], ...],
        rate: float | None,
        *,
        changes: bool = False,
    ) -> None:
        self._telemetry, self._read, self._messages, self._rate = telemetry, read, messages, rate
        self._changes = changes
        self._last: TelemetryValue | None = None
        self._refusal: CommandDenied | None = None
        self._candidates = [message for message in messages if is_periodic(message)]
        self._candidates.sort(key=lambda message: not self._arrives(message))
        self._stream = self._open()

    @property
    def latest(self) -> TelemetryValue | None:
        """The last value that the vehicle reported; None before the first one."""
        return self._read(self._telemetry)

    def close(self) -> None:
        """Unsubscribe, and release the requested rate. Idempotent."""
        self._stream.close()

    def __aiter__(self) -> Self:
        return self

    async def __anext__(self) -> TelemetryValue:
        """Return the next value.

        Raises:
            CommandDenied: The vehicle refused to send the messages that hold the value.
            StopAsyncIteration: The stream or its connection was closed.
        """
        while True:
            try:
                await anext(self._stream)
            except CommandDenied as refusal:
                self._refusal = self._refusal or refusal
                if not self._candidates:
                    raise self._refusal from None
                self._stream = self._open()
                continue
            self._stream.drain()
            value = self._read(self._telemetry)
            if value is not None and not (self._changes and value == self._last):
                self._last = value
                return value

    async def __aenter__(self) -> Self:
        await self._stream.__aenter__()
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _arrives(self, message: type[Message]) -> bool:
        age = self._telemetry.age(message)
        return age is not None and age <= _ARRIVES

    def _open(self) -> MessageStream[Message]:
        """Request the next candidate, and subscribe to it; without a rate, to all messages with the value."""
        requested = (self._candidates.pop(0),) if self._candidates else self._messages
        messages = self._messages if self._rate is None else requested
        subscription = self._telemetry.component.stream(*messages, queue=_QUEUE)
        rate = self._rate if is_periodic(requested[0]) else None
        return MessageStream(self._telemetry, requested, subscription, rate)


async def wait_for_values(
    telemetry: Telemetry, streams: Mapping[str, ValueStream[Any]], timeout: float | None
) -> None:
    """Wait until each value was received; see `Vehicle.wait_for_telemetry`."""
    target = str(telemetry.component.address)
    missing = [name for name, stream in streams.items() if stream.latest is None]

    async def receive(name: str) -> None:
        async with streams[name] as stream:
            try:
                await anext(stream)
            except StopAsyncIteration:
                raise RemoteCancelled(operation(), target, answer="the connection was closed") from None
        missing.remove(name)

    def operation() -> str:
        return f"waiting for {', '.join(missing)} of"

    waiting = [asyncio.ensure_future(receive(name)) for name in missing]
    try:
        async with asyncio.timeout(timeout):
            await asyncio.gather(*waiting)
    except TimeoutError:
        raise MessageTimeout(operation(), target, answer=f"not received in {timeout:g} s") from None
    finally:
        for task in waiting:
            task.cancel()
        await asyncio.gather(*waiting, return_exceptions=True)
        for stream in streams.values():
            stream.close()
