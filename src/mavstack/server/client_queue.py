"""The bounded queue of one client of a WebSocket.

A client that reads too slowly loses the oldest data of its own queue, counted in packets; it delays no other.
Data for a client that keeps up does not wait for the task that sends: it goes out at once if its server can.
"""

from __future__ import annotations

import asyncio
import json
from collections import deque
from typing import TYPE_CHECKING, Generic, TypeVar

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Sequence

    from mavstack.http.immediate_writes import WriteNow

Data = TypeVar("Data", str, bytes)


class ClientQueue(Generic[Data]):
    """A queue of data to send.

    Args:
        max_size: Characters or bytes that wait at most.
        write_now: Writes to the client at once; None: the task that reads the queue sends all data.
    """

    def __init__(self, max_size: int, write_now: WriteNow | None = None) -> None:
        self._max_size = max_size
        self._write_now = write_now
        self._reader_waits = False  # all data is sent, and the reader waits for more
        self._size = 0
        self._items: deque[tuple[Data, int]] = deque()
        self._wakeup = asyncio.Event()
        #: Packets that were dropped because the queue was full.
        self.dropped = 0

    def put(self, data: Data, packets: int = 1) -> None:
        """Send data that holds a number of packets, or queue it and drop the oldest data if it is full."""
        if not self._sends((data,)):
            self._append(data, packets)

    def put_all(self, items: Sequence[Data]) -> None:
        """Send items that hold one packet each, or queue them likewise."""
        if items and not self._sends(items):
            for item in items:
                self._append(item, 1)

    def _sends(self, items: Sequence[Data]) -> bool:
        """Send items at once if nothing is before them; return whether that was done."""
        return self._reader_waits and self._write_now is not None and self._write_now(items)

    def _append(self, data: Data, packets: int) -> None:
        self._reader_waits = False
        self._items.append((data, packets))
        self._size += len(data)
        while self._size > self._max_size and len(self._items) > 1:
            oldest, count = self._items.popleft()
            self._size -= len(oldest)
            self.dropped += count
        self._wakeup.set()

    async def get(self) -> Data:
        """Return the oldest data; wait until there is some."""
        while not self._items:
            self._wakeup.clear()
            self._reader_waits = True
            await self._wakeup.wait()
        data, _ = self._items.popleft()
        self._size -= len(data)
        return data

    async def stream(self) -> AsyncIterator[Data]:
        """Yield the data as it comes, without end; other tasks have a turn after each item.

        A send that need not wait gives no other task a turn, so that a lost connection would not be noticed.
        """
        while True:
            yield await self.get()
            await asyncio.sleep(0)


async def stream_texts(queue: ClientQueue[str]) -> AsyncIterator[str]:
    """Yield the texts of a queue, and after drops first `{"dropped": N}`, the number of all drops so far."""
    reported = 0
    async for text in queue.stream():
        if queue.dropped != reported:
            reported = queue.dropped
            yield json.dumps({"dropped": reported})
        yield text
