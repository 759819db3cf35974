"""The event loop of a blocking program: in a thread of its own, reached by calls that wait.

Everything of a node happens in that thread, callbacks and handlers too. A wait that Ctrl-C interrupts
cancels what it waited for, lets it leave the other end clean, and then raises KeyboardInterrupt.
"""

from __future__ import annotations

import asyncio
from concurrent.futures import CancelledError
from contextlib import suppress
from threading import Thread, get_ident
from typing import TYPE_CHECKING, Any, TypeVar

from mavstack.errors import MavstackError

if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine
    from concurrent.futures import Future

Result = TypeVar("Result")

#: How long an interrupted call may take to leave the other end clean.
CLEANING_UP = 2.0


class Portal:
    """A thread that runs an event loop until `close`."""

    def __init__(self) -> None:
        self._loop = asyncio.new_event_loop()
        self._thread = Thread(target=self._loop.run_forever, name="mavstack", daemon=True)
        self._thread.start()

    @property
    def closed(self) -> bool:
        """Whether `close` was called."""
        return self._loop.is_closed()

    def wait(self, work: Coroutine[Any, Any, Result]) -> Result:
        """Run a coroutine in the loop's thread and wait for its result."""
        if self.closed or get_ident() == self._thread.ident:
            work.close()
            reason = "the node is closed" if self.closed else "a handler of the node would wait for itself"
            raise MavstackError(f"a blocking call is not possible here: {reason}")
        future = asyncio.run_coroutine_threadsafe(work, self._loop)
        try:
            return future.result()
        except CancelledError:
            raise
        except BaseException:
            self._abandon(future)
            raise

    def call(self, function: Callable[[], Result]) -> Result:
        """Call a plain function in the loop's thread."""

        async def calling() -> Result:
            return function()

        if get_ident() == self._thread.ident:
            return function()
        return self.wait(calling())

    def close(self) -> None:
        """Stop the loop and its thread. Closing twice does nothing."""
        if not self.closed:
            self._loop.call_soon_threadsafe(self._loop.stop)
            self._thread.join()
            self._loop.run_until_complete(self._loop.shutdown_asyncgens())
            self._loop.close()

    def _abandon(self, future: Future[Any]) -> None:
        if not future.done():
            future.cancel()

            async def cleaned_up() -> None:
                await asyncio.sleep(0)

            with suppress(Exception):
                asyncio.run_coroutine_threadsafe(cleaned_up(), self._loop).result(CLEANING_UP)
