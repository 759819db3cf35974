"""Answers that are streams of server-sent events."""

from __future__ import annotations

from contextlib import AbstractAsyncContextManager, nullcontext
from typing import TYPE_CHECKING, Annotated, Final

from msgspec import Meta
from starlette.responses import StreamingResponse

from mavstack.http.request_fields import Fields

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Callable

    from starlette.types import Receive, Scope, Send

_END: Final = {"type": "http.response.body", "body": b"", "more_body": False}


class EventsQuery(Fields):
    """The query of a stream of events."""

    count: Annotated[
        Annotated[int, Meta(ge=1)] | None,
        Meta(description="Events after which the stream ends; null: it has no end."),
    ] = None


class EventStream(StreamingResponse):
    """The answer whose body is a stream of events; proxies neither buffer nor store it.

    Args:
        events: The events.

    Attributes:
        limit: Returns the context in which the events are sent, which may end them early.
    """

    limit: Callable[[], AbstractAsyncContextManager[None]] = nullcontext

    def __init__(self, events: AsyncIterator[str]) -> None:
        headers = {"Cache-Control": "no-store", "X-Accel-Buffering": "no"}
        super().__init__(events, media_type="text/event-stream", headers=headers)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Send the events, and the end of the answer if the limit ends them early."""
        async with self.limit():
            await super().__call__(scope, receive, send)
            return
        await send(_END)
