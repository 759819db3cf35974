"""A display that fills the terminal while a command runs, and leaves its last state behind.

Rendering runs in a thread of its own, so that the event loop goes on reading the sockets. The snapshot to
render is made before, in the thread of the event loop. Log lines for stderr are held back until the display
ends.
"""

from __future__ import annotations

import asyncio
import signal
from abc import ABC, abstractmethod
from contextlib import suppress
from threading import Lock
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from mavstack.cli.common.log_output import stderr_log_held
from mavstack.cli.common.text import printable
from mavstack.errors import MissingExtraError

try:
    from rich.console import Console, Group
    from rich.live import Live
    from rich.text import Text
except ImportError as error:
    raise MissingExtraError("the live display (a summary does without: --once)", "cli") from error

if TYPE_CHECKING:
    from typing import Self

__all__ = ["LiveDisplay", "Text"]

Snapshot = TypeVar("Snapshot")

_REFRESH_INTERVAL = 0.2


class LiveDisplay(ABC, Generic[Snapshot]):
    """Renders snapshots several times a second inside a `with` block."""

    def __init__(self) -> None:
        self._console = Console()
        self._live = Live(console=self._console, screen=True, auto_refresh=False)
        self._rendering = Lock()
        self._ended = False
        self._terminated = False
        self._previous_handler: Any = signal.SIG_DFL
        self._task: asyncio.Task[Any] | None = None
        self._held_log = stderr_log_held()

    @abstractmethod
    def snapshot(self) -> Snapshot:
        """Return the state to render now."""

    @abstractmethod
    def lines(self, snapshot: Snapshot, width: int, height: int) -> list[Text]:
        """Return the lines that show a snapshot on `width` columns and at most `height` lines."""

    def __enter__(self) -> Self:
        self._held_log.__enter__()
        with suppress(RuntimeError):  # no event loop runs
            self._task = asyncio.current_task()
        self._previous_handler = signal.signal(signal.SIGTERM, self._terminate)
        self._live.start()
        return self

    def __exit__(self, *_: object) -> None:
        with self._rendering:  # the thread may still render the last snapshot
            self._ended = True
        self._live.stop()
        signal.signal(signal.SIGTERM, self._previous_handler)
        self._console.print(self._group(self.snapshot(), self._console.height - 2))
        self._held_log.__exit__(None, None, None)
        if self._terminated:
            raise SystemExit(128 + signal.SIGTERM)

    async def run(self) -> None:
        """Render until cancelled."""
        while True:
            await asyncio.to_thread(self._render, self.snapshot())
            await asyncio.sleep(_REFRESH_INTERVAL)

    def _terminate(self, _number: int, _frame: object) -> None:
        """End as Ctrl-C does: the event loop turns SIGINT into an orderly end wherever the signal arrives.

        In a background job of a shell SIGINT is ignored; then the task of the display is cancelled instead.
        """
        self._terminated = True
        if signal.getsignal(signal.SIGINT) is signal.SIG_IGN and self._task is not None:
            self._task.get_loop().call_soon_threadsafe(self._task.cancel)
        else:
            signal.raise_signal(signal.SIGINT)

    def _render(self, snapshot: Snapshot) -> None:
        with self._rendering:
            if not self._ended:
                self._live.update(self._group(snapshot, self._console.height), refresh=True)

    def _group(self, snapshot: Snapshot, height: int) -> Group:
        return Group(*map(_printable, self.lines(snapshot, self._console.width, height)))


def _printable(line: Text) -> Text:
    """Return a line without control characters, which rich would pass on to the terminal."""
    if not line.plain.isprintable():
        line.plain = printable(line.plain)
    return line
