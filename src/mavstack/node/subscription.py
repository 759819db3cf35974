"""A subscription: an async iterator over messages, packets or events, with a bounded queue of its own.

A slow subscriber never blocks the link or another subscriber: when its queue is full, the oldest item is
dropped, since a vehicle's newest state matters most; `dropped` counts the dropped items. With `keep_all=True`
the queue is unbounded, and nothing is lost.
"""

from __future__ import annotations

import asyncio
from collections import deque
from typing import TYPE_CHECKING, Generic, TypeVar

from mavstack.node.api_object import ReadOnly

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import TracebackType
    from typing import Self

Item = TypeVar("Item")

#: Maximum number of items in the queue of a subscription.
DEFAULT_QUEUE = 1000


class Subscription(ReadOnly, Generic[Item]):
    """An async iterator over received items; it ends after `close`, or when the node closes.

    Close it by `async with` or `close()`. Several tasks may iterate over one subscription; each item is
    delivered to one of them.
    """

    def __init__(
        self,
        close: Callable[[Subscription[Item]], None],
        *,
        queue: int = DEFAULT_QUEUE,
        keep_all: bool = False,
    ) -> None:
        self._dropped = 0
        self._closed = False
        self._close = close
        self._max_items = None if keep_all else queue
        self._items: deque[Item] = deque()
        self._wakeup = asyncio.Event()  # an Event, since several tasks may wait for items

    @property
    def dropped(self) -> int:
        """The number of items dropped because the queue was full."""
        return self._dropped

    @property
    def closed(self) -> bool:
        """True after `close`, or after the node was closed."""
        return self._closed

    def put(self, item: Item) -> None:
        """Add an item without waiting; drop the oldest if the queue is full."""
        if self._max_items is not None and len(self._items) >= self._max_items:
            self._items.popleft()
            self._dropped += 1
        self._items.append(item)
        self._wakeup.set()

    def end(self) -> None:
        """End the iteration once the queued items have been read."""
        self._closed = True
        self._wakeup.set()

    def close(self) -> None:
        """Unsubscribe. Idempotent."""
        if not self.closed:
            self._close(self)
            self.end()

    def drain(self) -> list[Item]:
        """Return all queued items and empty the queue, without waiting.

        Returns:
            The items, oldest first; empty if there are none.
        """
        items = list(self._items)
        self._items.clear()
        return items

    async def wait(self) -> bool:
        """Wait until an item is queued or the subscription ends.

        Returns:
            True if an item is queued, False if the subscription has ended.
        """
        while not self._items and not self.closed:
            self._wakeup.clear()
            await self._wakeup.wait()
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
