"""The timeout of a call that consists of several requests."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

#: Seconds that the last request gets when the timeout has passed already: it fails at once, with its typed
#: error.
MIN_REMAINING = 0.001


class TimeBudget:
    """The remaining seconds of a call's `timeout`, by the clock `now`."""

    def __init__(self, timeout: float | None, now: Callable[[], float]) -> None:
        self._now = now
        self._deadline = None if timeout is None else now() + timeout

    def remaining(self, at_most: float | None = None) -> float | None:
        """Return the seconds that remain, at most `at_most`; None for no limit."""
        if self._deadline is None:
            return at_most
        seconds = max(self._deadline - self._now(), MIN_REMAINING)
        return seconds if at_most is None else min(seconds, at_most)
