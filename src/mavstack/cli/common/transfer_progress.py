"""How far a transfer has come: one line on a terminal with rate and time left, nothing in a pipe.

It begins to tell after half a second, so quick work leaves no trace. What is counted in bytes is told with
its rate; anything else in percent alone.
"""

from __future__ import annotations

import sys
from time import monotonic
from typing import TYPE_CHECKING, Self

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import TracebackType

_PATIENCE = 0.5
_INTERVAL = 0.2
_ERASE = "\r\x1b[K"
_STEP = 1000.0
_UNITS = ("B", "kB", "MB", "GB", "TB")
_MINUTE, _HOUR = 60, 3600
_LONGEST = 100 * _HOUR


def size_text(size: float) -> str:
    """A number of bytes for people: 1.5 MB."""
    unit = 0
    while size >= _STEP - 0.5 and unit < len(_UNITS) - 1:
        size, unit = size / _STEP, unit + 1
    return f"{size:.0f} B" if unit == 0 else f"{size:.{1 if size < 100 else 0}f} {_UNITS[unit]}"


def duration_text(seconds: float) -> str:
    """A time for people: 42 s, 3:07 min, 2:05 h."""
    whole = round(seconds)
    if whole < _MINUTE:
        return f"{whole} s"
    unit, sign = (_MINUTE, "min") if whole < _HOUR else (_HOUR, "h")
    return f"{whole // unit}:{whole % unit * 60 // unit:02d} {sign}"


class TransferProgress:
    """Called with how much is done of how much (0: not known); tells on stderr, if that is a terminal."""

    def __init__(self, what: str, *, in_bytes: bool = True, clock: Callable[[], float] = monotonic) -> None:
        self._what = what
        self._in_bytes = in_bytes
        self._clock = clock
        self._began = clock()
        self._first: int | None = None
        self._next = self._began + _PATIENCE
        self._shown = False
        self._wanted = sys.stderr.isatty()

    def __call__(self, done: int, total: int) -> None:
        """Take note of it."""
        now = self._clock()
        if self._first is None:
            self._first = done  # what was there before it began says nothing of the rate
        if self._wanted and now >= self._next:
            self._next = now + _INTERVAL
            self._shown = True
            print(f"{_ERASE}{self.text(done, total)}", end="", file=sys.stderr, flush=True)

    def text(self, done: int, total: int) -> str:
        """The line."""
        parts = [f"{min(100 * done // total, 100)} %"] if total > 0 else []
        rate = self._rate(done)
        if self._in_bytes:
            parts.append(f"{size_text(done)} of {size_text(total)}" if total > 0 else size_text(done))
            parts += [f"{size_text(rate)}/s"] if rate > 0 else []
        if rate > 0 and total > done and (left := (total - done) / rate) < _LONGEST:
            parts.append(f"{duration_text(left)} left")
        return f"{self._what}: {', '.join(parts)}"

    def _rate(self, done: int) -> float:
        elapsed = self._clock() - self._began
        return (done - (self._first or 0)) / elapsed if elapsed > 0 else 0.0

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._shown:
            print(_ERASE, end="", file=sys.stderr, flush=True)
