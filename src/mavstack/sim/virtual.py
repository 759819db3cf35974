"""An event loop with virtual time: its clock jumps to the next timer instead of waiting.

    result = run_virtually(my_test())

A minute of flight takes as long as its computation. It suits programs within one process, over memory links;
the clock does not wait for data from real sockets.
"""

from __future__ import annotations

import asyncio
import selectors
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from collections.abc import Coroutine

T = TypeVar("T")

#: Maximum seconds of real time to wait for sockets while there is no timer.
_SOCKET_TIMEOUT = 10.0


class _JumpingSelector(selectors.DefaultSelector):
    now = 0.0

    def select(self, timeout: float | None = None) -> list[tuple[selectors.SelectorKey, int]]:
        ready = super().select(0)
        if not ready and timeout is None:
            return super().select(_SOCKET_TIMEOUT)
        if not ready:
            self.now += max(timeout or 0, 0)
        return ready


class VirtualLoop(asyncio.SelectorEventLoop):
    """An event loop with virtual time, which begins at 0."""

    def __init__(self) -> None:
        self._jumping = _JumpingSelector()
        super().__init__(self._jumping)

    def time(self) -> float:
        """Return virtual seconds."""
        return self._jumping.now

    async def shutdown_default_executor(self, timeout: float | None = None) -> None:  # noqa: ASYNC109
        """Wait until the threads of the executor end, as long as they work.

        Args:
            timeout: Ignored: `asyncio.Runner` of Python 3.12 and later passes a limit in seconds, which
                virtual time would reach at once.
        """
        await super().shutdown_default_executor()


def run_virtually(work: Coroutine[Any, Any, T]) -> T:
    """Run a coroutine to its end in virtual time.

    Args:
        work: The coroutine.

    Returns:
        The result of the coroutine.
    """
    with asyncio.Runner(loop_factory=VirtualLoop) as runner:
        return runner.run(work)
