"""The end of connections that are unused between two requests."""

from __future__ import annotations

import asyncio
from time import monotonic
from typing import Final

#: Seconds after an answer within which the next request must arrive.
IDLE_TIMEOUT: Final = 5.0


class IdleTimer:
    """Closes a connection that is unused for too long; frequent requests arm no timer again."""

    def __init__(self) -> None:
        self._transport: asyncio.Transport | None = None
        self._unused_since: float | None = None
        self._timer: asyncio.TimerHandle | None = None

    def begin(self, transport: asyncio.Transport) -> None:
        """Note that a connection has answered."""
        self._transport = transport
        self._unused_since = monotonic()
        if self._timer is None:
            self._wait(IDLE_TIMEOUT)

    def end(self) -> None:
        """Note that the connection is in use."""
        self._unused_since = None

    def stop(self) -> None:
        """Close nothing any more. Idempotent."""
        self._unused_since = None
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None

    def _wait(self, seconds: float) -> None:
        self._timer = asyncio.get_running_loop().call_later(seconds, self._check)

    def _check(self) -> None:
        self._timer = None
        if self._unused_since is None or self._transport is None:
            return
        left = self._unused_since + IDLE_TIMEOUT - monotonic()
        if left > 0.0:
            self._wait(left)
        else:
            self._transport.close()
