"""An event loop in a thread of its own, which blocking programs call into.

Everything of a node runs in that thread, callbacks and handlers included. Ctrl-C during a blocking call
cancels the call's operation, lets it clean up on the remote side, and raises KeyboardInterrupt. Any number of
threads may wait at once; `close` ends their waits with an error.
"""

from __future__ import annotations

import asyncio
from concurrent.futures import CancelledError
from contextlib import suppress
from dataclasses import dataclass
from threading import Lock, Thread, get_ident
from typing import TYPE_CHECKING, Any, TypeVar

from mavstack.errors import InvalidStateError

if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine
    from concurrent.futures import Future

Result = TypeVar("Result")

#: Seconds that an interrupted call may take to end its operation at the vehicle.
CLEANUP_TIMEOUT = 2.0


@dataclass(frozen=True, slots=True)
class Worker:
    """A function that runs in a thread of its own, and may make blocking calls."""

    #: The result of the function: a future of the event loop.
    result: asyncio.Future[Any]
    #: Cancels the blocking call that the function waits for now, and all its later calls.
    cancel: Callable[[], None]


class BlockingPortal:
    """A thread that runs an event loop until `close`."""

    def __init__(self) -> None:
        self._loop = asyncio.new_event_loop()
        self._tasks: dict[asyncio.Task[Any], int] = {}  # value: the thread that waits for the task
        self._lock = Lock()
        self._closed = False
        self._calls: dict[int, Future[Any]] = {}  # the call that each thread waits for
        self._cancelled: set[int] = set()  # threads of workers whose calls are cancelled
        self._thread = Thread(target=self._loop.run_forever, name="mavstack", daemon=True)
        self._thread.start()

    @property
    def closed(self) -> bool:
        """True after `close`."""
        return self._closed

    def wait(self, work: Coroutine[Any, Any, Result]) -> Result:
        """Run a coroutine in the loop's thread and wait for its result.

        Raises:
            InvalidStateError: The portal is closed, or the caller is in the loop's thread.
        """
        try:
            return self._submit(work).result()
        except CancelledError:
            if self.closed:
                raise InvalidStateError("the node was closed while this call waited") from None
            raise
        except Exception:
            raise
        except BaseException:  # also Ctrl-C, even before `_submit` has returned the future
            self._abandon(get_ident())
            raise
        finally:
            self._calls.pop(get_ident(), None)

    def call(self, function: Callable[[], Result]) -> Result:
        """Call a plain function in the loop's thread and return its result."""

        async def calling() -> Result:
            return function()

        if get_ident() == self._thread.ident:
            return function()
        return self.wait(calling())

    def worker(self, function: Callable[[], object]) -> Worker:
        """Start a function in a thread of its own; to be called in the loop's thread."""
        result: asyncio.Future[Any] = self._loop.create_future()
        started: list[int] = []

        def finish(outcome: object, error: BaseException | None) -> None:
            self._cancelled.difference_update(started)
            if error is None:
                result.set_result(outcome)
            else:
                result.set_exception(error)

        def run() -> None:
            started.append(get_ident())
            outcome: object = None
            failure: BaseException | None = None
            try:
                outcome = function()
            except BaseException as error:  # noqa: BLE001 (it belongs to the caller)
                failure = error
            with suppress(RuntimeError):  # the event loop was closed in the meantime
                self._loop.call_soon_threadsafe(finish, outcome, failure)

        def cancel() -> None:
            with self._lock:
                self._cancelled.update(started)
                calls = [self._calls[thread] for thread in started if thread in self._calls]
            for call in calls:
                call.cancel()

        Thread(target=run, name="mavstack worker", daemon=True).start()
        return Worker(result, cancel)

    def close(self) -> None:
        """Cancel all tasks, and stop the loop and its thread. Idempotent."""
        with self._lock:
            if self._closed:
                return
            self._closed = True
            ending = asyncio.run_coroutine_threadsafe(self._end_tasks(), self._loop)
        with suppress(TimeoutError):
            ending.result(CLEANUP_TIMEOUT)
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join()
        self._loop.close()

    def _submit(self, work: Coroutine[Any, Any, Result]) -> Future[Result]:
        with self._lock:  # with the lock, a submitted coroutine is either completed or cancelled by `close`
            if self._closed or get_ident() == self._thread.ident:
                work.close()
                reason = "the node is closed" if self._closed else "a callback would wait for its own thread"
                raise InvalidStateError(f"a blocking call is not possible here: {reason}")
            if get_ident() in self._cancelled:
                work.close()
                raise CancelledError
            future = asyncio.run_coroutine_threadsafe(self._tracked(work, get_ident()), self._loop)
            self._calls[get_ident()] = future
            return future

    async def _tracked(self, work: Coroutine[Any, Any, Result], thread: int) -> Result:
        task = asyncio.current_task()
        assert task is not None  # noqa: S101 (run_coroutine_threadsafe makes one)
        self._tasks[task] = thread
        try:
            return await work
        finally:
            del self._tasks[task]

    async def _end_tasks(self) -> None:
        tasks = asyncio.all_tasks() - {asyncio.current_task()}
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        # Close the generators before the loop ends: `close` may be called from another event loop.
        await self._loop.shutdown_asyncgens()

    def _abandon(self, thread: int) -> None:
        """Cancel the call of a thread, and wait until it has cleaned up."""
        with self._lock:
            if self._closed:
                return
            ending = asyncio.run_coroutine_threadsafe(self._end_calls(thread), self._loop)
        with suppress(Exception):
            ending.result(CLEANUP_TIMEOUT)

    async def _end_calls(self, thread: int) -> None:
        # The loop runs callbacks in order, so a call that was submitted before this one is a task already.
        tasks = [task for task, waiting in self._tasks.items() if waiting == thread]
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
