"""Reads of vehicles: one transfer serves all clients that ask for its result, and gives way to a pilot's.

A vehicle carries out one transfer at a time (a plan, its parameters, a log). Clients that ask for a result
while it is being read wait for the read that runs. Clients that observe also get the last result while it is
fresh, and only few of their reads begin per second. A pilot's write does not wait for reads: those that run
are cancelled, and begin again after it.
"""

from __future__ import annotations

import asyncio
from collections import OrderedDict
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final, NamedTuple, TypeVar, cast

from mavstack.http.bodies import RefusedError

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable, Iterator

#: Seconds for which observing clients get the last result without a new read.
FRESH: Final = 5.0
#: Maximum number of reads for all observing clients per second, and at once after a pause.
MAX_RATE: Final = 1.0
MAX_BURST: Final = 8.0
#: Maximum number of results that are kept.
MAX_RESULTS: Final = 64

T = TypeVar("T")


class Key(NamedTuple):
    """A subject of reads: the system id of the vehicle, and what is read."""

    system: int
    subject: str


class _Result(NamedTuple):
    value: Any
    time: float


@dataclass(slots=True, eq=False)
class _Read:
    task: asyncio.Task[Any]
    waiting: int = 0


@dataclass(slots=True)
class _Writes:
    count: int = 0
    ended: asyncio.Event = field(default_factory=asyncio.Event)


class SharedReads:
    """The reads of all vehicles of a station.

    Args:
        now: Returns the time in seconds.
    """

    def __init__(self, now: Callable[[], float]) -> None:
        self._now = now
        self._running: dict[Key, _Read] = {}
        self._results: OrderedDict[Key, _Result] = OrderedDict()
        self._writes: dict[int, _Writes] = {}
        self._allowance = MAX_BURST
        self._updated = 0.0

    async def read(self, key: Key, work: Callable[[], Awaitable[T]], *, observes: bool = False) -> T:
        """Return the result of a read, which may be the one of another client.

        Args:
            key: The subject.
            work: Reads it from the vehicle.
            observes: The client observes: a fresh result is enough for it.

        Returns:
            The result.

        Raises:
            RefusedError: Clients that observe read too much.
        """
        known = self._results.get(key)
        if observes and known is not None and self._now() - known.time < FRESH:
            return cast("T", known.value)
        while True:
            await self._wait_for_writes(key.system)
            read = self._running.get(key)
            if read is None:
                if observes:
                    self._count_read()
                read = self._begin(key, work)
            try:
                return cast("T", await self._result_of(key, read))
            except asyncio.CancelledError:
                if not read.task.cancelled() or _is_cancelling():
                    raise

    @contextmanager
    def writing(self, system: int) -> Iterator[None]:
        """Cancel the reads of a vehicle, and let none begin while the context is open; they follow it."""
        writes = self._writes.setdefault(system, _Writes())
        writes.count += 1
        self.forget(system)
        for key in [each for each in self._running if each.system == system]:
            self._running.pop(key).task.cancel()
        try:
            yield
        finally:
            writes.count -= 1
            if not writes.count:
                del self._writes[system]
                writes.ended.set()

    def forget(self, system: int) -> None:
        """Drop the results of a vehicle, which has changed."""
        for key in [each for each in self._results if each.system == system]:
            del self._results[key]

    def _begin(self, key: Key, work: Callable[[], Awaitable[T]]) -> _Read:
        async def run() -> T:
            return await work()

        read = self._running[key] = _Read(asyncio.get_running_loop().create_task(run()))
        read.task.add_done_callback(lambda _: self._ended(key, read))
        return read

    def _ended(self, key: Key, read: _Read) -> None:
        if self._running.get(key) is read:
            del self._running[key]
            if not read.task.cancelled() and read.task.exception() is None:
                self.keep(key, read.task.result())

    def keep(self, key: Key, value: object) -> None:
        """Keep a result that was read or written; not the bytes of a file, which may be large."""
        if isinstance(value, bytes | bytearray):
            return
        self._results[key] = _Result(value, self._now())
        self._results.move_to_end(key)
        while len(self._results) > MAX_RESULTS:
            self._results.popitem(last=False)

    async def _result_of(self, key: Key, read: _Read) -> Any:  # noqa: ANN401 (of any read)
        """Wait for a read; it is cancelled when no client waits for it any more."""
        read.waiting += 1
        try:
            return await asyncio.shield(read.task)
        finally:
            read.waiting -= 1
            if not read.waiting and not read.task.done():
                if self._running.get(key) is read:
                    del self._running[key]
                read.task.cancel()

    async def _wait_for_writes(self, system: int) -> None:
        while (writes := self._writes.get(system)) is not None:
            await writes.ended.wait()

    def _count_read(self) -> None:
        now = self._now()
        elapsed, self._updated = max(0.0, now - self._updated), now
        self._allowance = min(MAX_BURST, self._allowance + elapsed * MAX_RATE)
        if self._allowance < 1:
            raise RefusedError(429, "clients that observe read too much from the vehicles: try again later")
        self._allowance -= 1


def _is_cancelling() -> bool:
    """Return whether the task that waits is cancelled itself."""
    task = asyncio.current_task()
    return task is not None and task.cancelling() > 0
