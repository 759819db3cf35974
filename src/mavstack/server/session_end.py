"""The end of a session ends what it opened: WebSockets and streams of events, which outlast their request.

A session ends when its client logs out, when it was not used for `SESSION_LIFETIME`, or when newer sessions
of its role take its place. Requests use a session, and so does each message of its WebSockets.
"""

from __future__ import annotations

import asyncio
from contextlib import asynccontextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import AsyncIterator

    from mavstack.server.access import Access


@asynccontextmanager
async def ending_with_session(access: Access, token: str) -> AsyncIterator[None]:
    """Run a block that is left as soon as a session ends; what follows the block then runs.

    Args:
        access: The sessions.
        token: The token of the session; empty: the client has none, and the block is never left early.

    Yields:
        None.
    """
    if not token:
        yield
        return
    loop = asyncio.get_running_loop()
    timer: asyncio.TimerHandle | None = None
    limit = asyncio.timeout(None)

    def watch() -> None:
        nonlocal timer
        if left := access.seconds_left(token):  # 0: the session ended, and `access` has called the listener
            timer = loop.call_later(left, watch)

    try:
        async with limit:
            with access.listening(token, lambda: limit.reschedule(loop.time())):
                watch()
                yield
    except TimeoutError:
        if not limit.expired():  # the error comes from the `with` block itself
            raise
    finally:
        if timer is not None:
            timer.cancel()
