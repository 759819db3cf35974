"""Spans of operations: one for each that a connection runs, when it has ended.

A span has the target, the number of attempts, an event for each repetition and, if the operation failed, the
class of the error, the vehicle's own code and the text. Operations that are parts of others have no spans.
"""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Any, Final

from mavstack.bridges.core.enum_names import enum_name
from mavstack.dialects import common
from mavstack.errors import CommandDenied
from mavstack.services import OperationEnded

if TYPE_CHECKING:
    from types import TracebackType
    from typing import Self

    from opentelemetry.trace import Tracer

    from mavstack.services import Operation
    from mavstack.vehicle import Connection

_NANOSECONDS: Final = 1_000_000_000
#: Prepositions at the end of a description, after which the target follows.
_PREPOSITIONS: Final = ("of", "on", "to", "from", "by", "at", "with", "for")


class OperationSpans:
    """The spans of a connection; an async context manager.

    Args:
        connection: The open connection.
        tracer: The tracer.
    """

    def __init__(self, connection: Connection, tracer: Tracer) -> None:
        self._connection = connection
        self._tracer = tracer
        self._task: asyncio.Task[None] | None = None

    async def __aenter__(self) -> Self:
        """Follow the operations."""
        following = asyncio.Event()
        self._task = asyncio.get_running_loop().create_task(self._follow(following))
        await following.wait()
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Follow the operations no more."""
        if self._task is not None:
            await asyncio.sleep(0)  # let the task report an operation that has just ended
            self._task.cancel()
            await asyncio.gather(self._task, return_exceptions=True)

    async def _follow(self, following: asyncio.Event) -> None:
        async with self._connection.events(OperationEnded) as events:
            following.set()
            async for event in events:
                self.record(event.operation, self._connection.now())

    def record(self, operation: Operation[Any], now: float) -> None:
        """Make the span of an operation that has ended.

        Args:
            operation: The operation.
            now: The time of its end in Unix seconds.
        """
        from opentelemetry.trace import SpanKind

        begin = now if operation.launched_at is None else operation.launched_at
        span = self._tracer.start_span(
            name_of(operation),
            kind=SpanKind.CLIENT,
            attributes=_attributes(operation),
            start_time=_nanoseconds(begin),
        )
        for number, time in enumerate(operation.retry_times, 2):
            span.add_event("retry", {"mavlink.attempt": number}, timestamp=_nanoseconds(time))
        if operation.error is not None:
            _set_error(span, operation.error)
        span.end(end_time=_nanoseconds(now))


def name_of(operation: Operation[Any]) -> str:
    """Return the name of a span: the description without the preposition that leads to the target."""
    text, _, last = operation.description.rpartition(" ")
    return text if text and last in _PREPOSITIONS else operation.description


def _attributes(operation: Operation[Any]) -> dict[str, str | int]:
    system, component = operation.target
    return {
        "mavlink.operation": type(operation).__name__,
        "mavlink.target.system": system,
        "mavlink.target.component": component,
        "mavlink.attempts": operation.attempts,
    }


def _set_error(span: Any, error: Exception) -> None:  # noqa: ANN401 (a span of any implementation)
    from opentelemetry.trace import StatusCode

    span.set_attribute("error.type", type(error).__name__)
    code = getattr(error, "code", None)
    if isinstance(code, int):
        is_result = isinstance(error, CommandDenied)
        name = enum_name(common.MavResult, code) if is_result else str(int(code))
        span.set_attribute("mavlink.result", name)
    span.set_status(StatusCode.ERROR, str(error))


def _nanoseconds(seconds: float) -> int:
    return round(seconds * _NANOSECONDS)
