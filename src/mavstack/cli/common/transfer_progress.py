"""Progress of a transfer: one line on a terminal with rate and time left, nothing in a pipe.

The line appears after half a second, so that a short transfer leaves no trace. A transfer counted in bytes
shows its rate; any other shows only the percentage.
"""

from __future__ import annotations

import sys
from time import monotonic
from typing import TYPE_CHECKING, Final, Self

from mavstack.cli.common.output import echo_progress
from mavstack.cli.common.text import duration_text, size_text

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import TracebackType

#: Seconds before the first progress line, and between two progress lines.
SHOW_DELAY: Final = 0.5
_SHOW_INTERVAL: Final = 0.2
_MAX_TIME_LEFT: Final = 360_000.0


class TransferProgress:
    """A progress callback that draws on stderr if that is a terminal."""

    def __init__(self, title: str, *, in_bytes: bool = True, clock: Callable[[], float] = monotonic) -> None:
        self._title = title
        self._in_bytes = in_bytes
        self._clock = clock
        self._started = clock()
        self._first: int | None = None
        self._next = self._started + SHOW_DELAY
        self._shown = False
        self._enabled = sys.stderr.isatty()

    def __call__(self, done: int, total: int) -> None:
        """Report that `done` of `total` is transferred; a total of 0 is unknown."""
        now = self._clock()
        if self._first is None:
            self._first = done  # the rate counts only this transfer, not the part that it resumes
        if self._enabled and now >= self._next:
            self._next = now + _SHOW_INTERVAL
            self._shown = True
            echo_progress(self.text(done, total))

    def text(self, done: int, total: int) -> str:
        """Return the progress line."""
        parts = [f"{min(100 * done // total, 100)} %"] if total > 0 else []
        rate = self._rate(done)
        if self._in_bytes:
            parts.append(f"{size_text(done)} of {size_text(total)}" if total > 0 else size_text(done))
            parts += [f"{size_text(rate)}/s"] if rate > 0 else []
        if rate > 0 and total > done and (left := (total - done) / rate) < _MAX_TIME_LEFT:
            parts.append(f"{duration_text(left)} left")
        return f"{self._title}: {', '.join(parts)}"

    def _rate(self, done: int) -> float:
        elapsed = self._clock() - self._started
        return (done - (self._first or 0)) / elapsed if elapsed > 0 else 0.0

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._shown:
            echo_progress("")
