"""A picture that fills the terminal while something runs, and leaves its last state behind.

Drawing runs in a thread of its own, so that the event loop goes on emptying the sockets; what is drawn is
taken in the loop's own thread before.
"""

from __future__ import annotations

import asyncio
import signal
from abc import ABC, abstractmethod
from threading import Lock
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from mavstack.errors import MissingExtraError

try:
    from rich.console import Console, Group
    from rich.live import Live
    from rich.text import Text
except ImportError as error:
    raise MissingExtraError("the live picture (a summary does without: --once)", "cli") from error

if TYPE_CHECKING:
    from typing import Self

__all__ = ["LivePicture", "Text"]

Taken = TypeVar("Taken")

_REFRESH = 0.2


class LivePicture(ABC, Generic[Taken]):
    """Draws what `take` gives, several times a second, between entering and leaving."""

    def __init__(self) -> None:
        self._console = Console()
        self._live = Live(console=self._console, screen=True, auto_refresh=False)
        self._drawing = Lock()
        self._ended = False
        self._terminated = False
        self._terminate: Any = signal.SIG_DFL

    @abstractmethod
    def take(self) -> Taken:
        """What is to be drawn now."""

    @abstractmethod
    def drawn(self, taken: Taken, width: int, height: int) -> list[Text]:
        """The lines of a picture that fits."""

    def __enter__(self) -> Self:
        self._terminate = signal.signal(signal.SIGTERM, self._leave)
        self._live.start()
        return self

    def __exit__(self, *_: object) -> None:
        with self._drawing:  # its thread may still be at the last one
            self._ended = True
        self._live.stop()
        signal.signal(signal.SIGTERM, self._terminate)
        self._console.print(self._group(self.take(), self._console.height - 2))
        if self._terminated:
            raise SystemExit(128 + signal.SIGTERM)

    async def run(self) -> None:
        """Redraw until cancelled."""
        while True:
            await asyncio.to_thread(self._draw, self.take())
            await asyncio.sleep(_REFRESH)

    def _leave(self, _number: int, _frame: object) -> None:
        """End as Ctrl-C does, which the event loop turns into an orderly end, wherever the signal falls."""
        self._terminated = True
        signal.raise_signal(signal.SIGINT)

    def _draw(self, taken: Taken) -> None:
        with self._drawing:
            if not self._ended:
                self._live.update(self._group(taken, self._console.height), refresh=True)

    def _group(self, taken: Taken, height: int) -> Group:
        return Group(*self.drawn(taken, self._console.width, height))
