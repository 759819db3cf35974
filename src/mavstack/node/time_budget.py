"""The timeout of a call that consists of several requests."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack.services.arguments import check_timeout

if TYPE_CHECKING:
    from collections.abc import Callable

#: Timeout of a request that begins after the timeout of the call has passed: it fails at once, with the typed
#: error of the request.
MIN_REMAINING = 0.001


class TimeBudget:
    """The remaining seconds of a call's `timeout`, by the clock `now`."""

    def __init__(self, timeout: float | None, now: Callable[[], float]) -> None:
        check_timeout(timeout)
        self._now = now
        self._deadline = None if timeout is None else now() + timeout

    def remaining(self, maximum: float | None = None) -> float | None:
        """Return the seconds that remain, at most `maximum`; None for no limit."""
        if self._deadline is None:
            return maximum
        seconds = max(self._deadline - self._now(), MIN_REMAINING)
        return seconds if maximum is None else min(seconds, maximum)
