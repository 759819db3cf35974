"""Answers that are streams of server-sent events."""

from __future__ import annotations

from typing import TYPE_CHECKING

from starlette.responses import StreamingResponse

if TYPE_CHECKING:
    from collections.abc import AsyncIterator


def event_stream(events: AsyncIterator[str]) -> StreamingResponse:
    """Return the answer whose body is a stream of events; proxies neither buffer nor store it."""
    headers = {"Cache-Control": "no-store", "X-Accel-Buffering": "no"}
    return StreamingResponse(events, media_type="text/event-stream", headers=headers)
