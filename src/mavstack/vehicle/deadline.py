"""The timeout of a whole call: one deadline for all of its requests, with a typed error at its end."""

from __future__ import annotations

import asyncio
from contextlib import asynccontextmanager
from typing import TYPE_CHECKING

from mavstack.errors import ActionTimeout, RemoteError, RemoteTimeout
from mavstack.services.arguments import check_timeout

if TYPE_CHECKING:
    from collections.abc import AsyncIterator


@asynccontextmanager
async def deadline(
    timeout: float | None, operation: str, target: object, error: type[RemoteTimeout] = ActionTimeout
) -> AsyncIterator[None]:
    """Cancel the block after `timeout` seconds (None: never), and raise `error` for it."""
    check_timeout(timeout)
    try:
        async with asyncio.timeout(timeout) as timer:
            yield
    except TimeoutError as expired:
        # A typed error of the block, and an error of another timer in the block, are not errors of this
        # deadline.
        if timeout is None or not timer.expired() or isinstance(expired, RemoteError):
            raise
        raise error(operation, str(target), answer=f"not done in {timeout:g} s") from None
