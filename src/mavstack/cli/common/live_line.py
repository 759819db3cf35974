"""A line on a terminal that tells how long work gets on, and nothing in a pipe."""

from __future__ import annotations

import asyncio
import sys
from typing import TYPE_CHECKING, Final

from mavstack.cli.common.output import echo_progress

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import TracebackType
    from typing import Self

#: Seconds before the line appears, so that short work leaves no trace, and between two texts of it.
SHOW_DELAY: Final = 0.5
SHOW_INTERVAL: Final = 0.25


class LiveLine:
    """Shows a text on stderr while a block runs, if stderr is a terminal.

    Args:
        text: Returns the present text.
    """

    def __init__(self, text: Callable[[], str]) -> None:
        self._text = text
        self._shown = False
        self._task: asyncio.Task[None] | None = None

    async def _show(self) -> None:
        await asyncio.sleep(SHOW_DELAY)
        while True:
            self._shown = True
            echo_progress(self._text())
            await asyncio.sleep(SHOW_INTERVAL)

    async def __aenter__(self) -> Self:
        if sys.stderr.isatty():
            self._task = asyncio.get_running_loop().create_task(self._show())
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._task is not None:
            self._task.cancel()
            await asyncio.gather(self._task, return_exceptions=True)
        if self._shown:
            echo_progress("")
