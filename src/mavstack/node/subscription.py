"""What a program listens to: an async iterator with a bounded queue of its own.

A slow subscriber never blocks the link or another subscriber: when its queue is full the oldest item goes,
since the newest is what a vehicle's state is about, and `dropped` counts. `keep_all=True` is for who would
rather have memory grow than lose anything.
"""

from __future__ import annotations

import asyncio
from collections import deque
from typing import TYPE_CHECKING, Generic, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import TracebackType
    from typing import Self

Item = TypeVar("Item")

QUEUE = 1000


class Subscription(Generic[Item]):
    """Iterate over it; it ends after `close`, or when the node closes."""

    def __init__(
        self, close: Callable[[Subscription[Item]], None], *, queue: int = QUEUE, keep_all: bool = False
    ) -> None:
        self.dropped = 0
        self.closed = False
        self._close = close
        self._most = None if keep_all else queue
        self._items: deque[Item] = deque()
        self._news = asyncio.Event()  # several tasks may wait for it

    def put(self, item: Item) -> None:
        """Hand an item over; never waits."""
        if self._most is not None and len(self._items) >= self._most:
            self._items.popleft()
            self.dropped += 1
        self._items.append(item)
        self._news.set()

    def end(self) -> None:
        """No more will come; what is queued can still be read."""
        self.closed = True
        self._news.set()

    def close(self) -> None:
        """Listen no more."""
        if not self.closed:
            self._close(self)
            self.end()

    def drain(self) -> list[Item]:
        """All that has come and was not read, without waiting."""
        items = list(self._items)
        self._items.clear()
        return items

    async def wait(self) -> bool:
        """Wait until there is something to read; False if nothing will come any more."""
        while not self._items and not self.closed:
            self._news.clear()
            await self._news.wait()
        return bool(self._items)

    def __aiter__(self) -> Self:
        return self

    async def __anext__(self) -> Item:
        while not self._items:
            if not await self.wait():
                raise StopAsyncIteration
        return self._items.popleft()

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
