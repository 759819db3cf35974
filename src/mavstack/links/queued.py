"""Channels whose transport sends asynchronously: a bounded send queue, and a task that empties it."""

from __future__ import annotations

import asyncio
from abc import abstractmethod
from collections import deque
from typing import TYPE_CHECKING

from mavstack.errors import LinkClosedError
from mavstack.links.connection import ConnectionChannel

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.links.channel import Channel, Data
    from mavstack.links.inbox import Inbox


class QueuedChannel(ConnectionChannel):
    """A channel that sends by a task; after `close` it disconnects when all queued chunks are sent."""

    def __init__(
        self, name: str, peer: str, on_closed: Callable[[Channel, str], None], send_queue: int
    ) -> None:
        super().__init__(name, peer, on_closed)
        self._limit = send_queue
        self._queue: deque[bytes] = deque()
        self._queued = 0
        self._has_work = asyncio.Event()
        self._has_room = asyncio.Event()
        self._has_room.set()

    async def receive_all(self, inbox: Inbox) -> str:
        """Receive until the connection ends, and send at the same time."""
        sender = asyncio.create_task(self._send_all())
        try:
            return await self._receive_loop(inbox)
        finally:
            sender.cancel()
            await asyncio.gather(sender, return_exceptions=True)

    async def drain(self) -> None:
        """Wait until less than half of the send queue is in use."""
        await self._has_room.wait()
        if self.closed:
            raise LinkClosedError(f"{self.name} is closed")

    async def wait_closed(self) -> None:
        """Return immediately, because `receive_all` ends after all chunks are sent."""

    @abstractmethod
    async def _receive_loop(self, inbox: Inbox) -> str:
        """Put received bytes into the inbox until the connection ends; return the reason why it ended."""

    @abstractmethod
    async def _transmit(self, data: bytes) -> None:
        """Send one chunk."""

    @abstractmethod
    async def _disconnect(self) -> None:
        """Close the connection, which also ends receiving."""

    async def _send_all(self) -> None:
        try:
            while self._queue or not self.closed:
                while self._queue:
                    await self._send_one(self._queue.popleft())
                self._has_work.clear()
                if not self.closed:
                    await self._has_work.wait()
        finally:
            await self._disconnect()

    async def _send_one(self, data: bytes) -> None:
        await self._transmit(data)
        self._queued -= len(data)
        if self._queued * 2 <= self._limit:
            self._has_room.set()

    def send_bytes(self, data: Data) -> bool:
        """Send or queue a chunk."""
        if self._queued + len(data) > self._limit:
            return False
        self._queue.append(bytes(data))
        self._queued += len(data)
        if self._queued * 2 > self._limit:
            self._has_room.clear()
        self._has_work.set()
        return True

    def close_transport(self) -> None:
        """Start closing the transport."""
        self._has_work.set()
        self._has_room.set()
