"""A display that fills the terminal while a command runs, and leaves its last state behind.

Rendering runs in a thread of its own, so that the event loop goes on reading the sockets. The snapshot to
render is made before, in the thread of the event loop. Log lines for stderr are held back until the display
ends. The display also ends when its terminal vanishes: SIGHUP may be ignored, and then only a failed write
tells it, or a descriptor that is no longer a terminal, to which rich writes nothing.
"""

from __future__ import annotations

import asyncio
import errno
import os
import signal
import sys
from abc import ABC, abstractmethod
from contextlib import contextmanager, suppress
from threading import Lock
from typing import TYPE_CHECKING, Any, Final, Generic, TypeVar

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
    from collections.abc import Iterator
    from typing import Self

__all__ = ["LiveDisplay", "Text"]

Snapshot = TypeVar("Snapshot")

_REFRESH_INTERVAL = 0.2
#: The exit code of a command whose terminal was closed, the same as after SIGHUP.
EXIT_HANGUP: Final = 129
#: Error numbers of a write to a terminal that was closed.
_GONE: Final = frozenset({errno.EIO, errno.EPIPE, errno.ENXIO, errno.ENODEV, errno.EBADF})


class LiveDisplay(ABC, Generic[Snapshot]):
    """Renders snapshots several times a second inside a `with` block."""

    def __init__(self) -> None:
        self._console = Console()
        self._on_terminal = self._console.is_terminal
        self._live = Live(console=self._console, screen=True, auto_refresh=False)
        self._rendering = Lock()
        self._ended = False
        self._terminated = False
        self._hung_up = False
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
        with self._until_hangup():
            self._live.stop()
        signal.signal(signal.SIGTERM, self._previous_handler)
        with self._until_hangup():
            self._console.print(self._group(self.snapshot(), self._console.height - 2))
            self._held_log.__exit__(None, None, None)
        if self._terminated:
            raise SystemExit(128 + signal.SIGTERM)
        if self._hung_up:
            _discard_output()
            raise SystemExit(EXIT_HANGUP)

    async def run(self) -> None:
        """Render until cancelled, or until the terminal is gone, which cancels the task of the display."""
        while True:
            with self._until_hangup():
                await asyncio.to_thread(self._render, self.snapshot())
            if self._hung_up or (self._on_terminal and not self._console.is_terminal):
                self._hung_up = True
                if self._task is not None:
                    self._task.cancel()
                return
            await asyncio.sleep(_REFRESH_INTERVAL)

    @contextmanager
    def _until_hangup(self) -> Iterator[None]:
        """Remember that a write failed because the terminal is gone."""
        try:
            yield
        except OSError as error:
            if error.errno not in _GONE:
                raise
            self._hung_up = True

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


def _discard_output() -> None:
    """Redirect the standard streams to the null device, since the interpreter flushes them at exit."""
    null = os.open(os.devnull, os.O_WRONLY)
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError, AttributeError):
            os.dup2(null, stream.fileno())
    os.close(null)


def _printable(line: Text) -> Text:
    """Return a line without control characters, which rich would pass on to the terminal."""
    if not line.plain.isprintable():
        line.plain = printable(line.plain)
    return line
