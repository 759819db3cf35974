"""Sinks: the buses to which vehicles are bridged. The bridge offers endpoints, a sink connects them.

All methods run in the event loop of the bridge and return at once. A sink whose own calls may block puts
samples into an `Outbox`; a sink that gets data on threads of its own passes them through a `Handoff`.
"""

from __future__ import annotations

import threading
from collections import deque
from typing import TYPE_CHECKING, Final, Generic, Protocol, TypeVar

if TYPE_CHECKING:
    import asyncio
    from collections.abc import Callable

    from mavstack.bridges.core.endpoints import Inlet, ServiceEndpoint
    from mavstack.bridges.core.topic import Topic

Item = TypeVar("Item")
#: Maximum number of items in a queue between threads.
MAX_ITEMS: Final = 1000


class Sink(Protocol):
    """A bus."""

    async def open(self) -> None:
        """Connect to the bus."""

    async def close(self) -> None:
        """Disconnect. Idempotent."""

    def add_node(self, namespace: str, name: str) -> None:
        """Announce a node of a vehicle; the endpoints that follow are its own."""

    def add_topic(self, topic: Topic) -> None:
        """Announce a topic, and add a receiver to it while it has subscribers."""

    def add_inlet(self, inlet: Inlet) -> None:
        """Subscribe to a topic for the vehicle."""

    def add_service(self, service: ServiceEndpoint) -> None:
        """Serve a service of the vehicle."""


class Handoff(Generic[Item]):
    """A bounded queue from foreign threads to the event loop, in batches; the oldest items are dropped.

    Args:
        loop: The event loop.
        take: Called in the loop with each item.
    """

    def __init__(
        self, loop: asyncio.AbstractEventLoop, take: Callable[[Item], object], limit: int = MAX_ITEMS
    ) -> None:
        #: The number of items that were dropped.
        self.dropped = 0
        self._loop = loop
        self._take = take
        self._items: deque[Item] = deque()
        self._limit = limit
        self._lock = threading.Lock()
        self._scheduled = False

    def put(self, item: Item) -> None:
        """Add an item; callable from any thread."""
        with self._lock:
            if len(self._items) >= self._limit:
                self._items.popleft()
                self.dropped += 1
            self._items.append(item)
            if self._scheduled or self._loop.is_closed():
                return
            self._scheduled = True
        self._loop.call_soon_threadsafe(self._drain)

    def _drain(self) -> None:
        with self._lock:
            items, self._items = self._items, deque()
            self._scheduled = False
        for item in items:
            self._take(item)


class Outbox(Generic[Item]):
    """A bounded queue from the event loop to a thread whose work may block; the oldest items are dropped.

    Args:
        work: Called in the thread with each item; its errors are counted.
    """

    def __init__(self, work: Callable[[Item], object], limit: int = MAX_ITEMS, *, name: str = "sink") -> None:
        #: The number of items that were dropped.
        self.dropped = 0
        #: The number of items whose processing failed.
        self.failed = 0
        self._work = work
        self._limit = limit
        self._items: deque[Item] = deque()
        self._wake = threading.Condition()
        self._closed = False
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)
        self._thread.start()

    def put(self, item: Item) -> None:
        """Add an item without waiting."""
        with self._wake:
            if len(self._items) >= self._limit:
                self._items.popleft()
                self.dropped += 1
            self._items.append(item)
            self._wake.notify()

    def close(self, timeout: float = 1.0) -> None:
        """End the thread after the items that wait, or after `timeout` seconds. Idempotent."""
        with self._wake:
            self._closed = True
            self._wake.notify()
        self._thread.join(timeout)

    def _run(self) -> None:
        while True:
            with self._wake:
                self._wake.wait_for(lambda: self._items or self._closed)
                if not self._items:
                    return
                items, self._items = self._items, deque()
            for item in items:
                try:
                    self._work(item)
                except Exception:  # noqa: BLE001 (the bus may raise anything)
                    self.failed += 1
