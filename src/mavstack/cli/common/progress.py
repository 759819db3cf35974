"""How far long work has come: one line on a terminal after half a second, nothing in a pipe."""

from __future__ import annotations

import sys
from time import monotonic
from typing import TYPE_CHECKING, Self

if TYPE_CHECKING:
    from types import TracebackType

_PATIENCE = 0.5
_INTERVAL = 0.1
_ERASE = "\r\x1b[K"


class Progress:
    """Counts towards a total, and tells on stderr."""

    def __init__(self, what: str, total: int) -> None:
        self._what = what
        self._total = total
        self._done = 0
        self._next = monotonic() + _PATIENCE
        self._shown = False
        self._wanted = total > 0 and sys.stderr.isatty()

    def add(self, amount: int) -> None:
        """Come further."""
        self._done += amount
        if self._wanted and (now := monotonic()) >= self._next:
            self._next = now + _INTERVAL
            self._shown = True
            percent = min(100 * self._done // self._total, 100)
            print(f"{_ERASE}{self._what}: {percent} %", end="", file=sys.stderr, flush=True)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._shown:
            print(_ERASE, end="", file=sys.stderr, flush=True)
