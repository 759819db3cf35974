"""A connection whose sending has to be awaited: a bounded queue, and a task that empties it."""

from __future__ import annotations

import asyncio
from abc import abstractmethod
from collections import deque
from typing import TYPE_CHECKING

from mavstack.errors import LinkClosedError
from mavstack.links.connection import Connection

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.links.channel import Channel, Data
    from mavstack.links.inbox import Inbox


class QueuedConnection(Connection):
    """Sends by a task of its own; once closed, it hangs up after the last queued chunk."""

    def __init__(self, name: str, peer: str, gone: Callable[[Channel, str], None], send_queue: int) -> None:
        super().__init__(name, peer, gone)
        self._limit = send_queue
        self._queue: deque[bytes] = deque()
        self._queued = 0
        self._work = asyncio.Event()
        self._room = asyncio.Event()
        self._room.set()

    async def pump(self, inbox: Inbox) -> str:
        """Receive until the end, and send meanwhile."""
        sender = asyncio.create_task(self._send_all())
        try:
            return await self._receive_all(inbox)
        finally:
            sender.cancel()
            await asyncio.gather(sender, return_exceptions=True)

    async def drain(self) -> None:
        """Wait until less than half of the queue is in use."""
        await self._room.wait()
        if self.closed:
            raise LinkClosedError(f"{self.name} is closed")

    async def wait_closed(self) -> None:
        """Return at once: `pump` lasts until everything is sent."""

    @abstractmethod
    async def _receive_all(self, inbox: Inbox) -> str:
        """Move received bytes into the inbox until the end, and return the reason of the end."""

    @abstractmethod
    async def _transmit(self, data: bytes) -> None:
        """Send one chunk."""

    @abstractmethod
    async def _hang_up(self) -> None:
        """End the connection, so that receiving ends as well."""

    async def _send_all(self) -> None:
        try:
            while self._queue or not self.closed:
                while self._queue:
                    await self._send_one(self._queue.popleft())
                self._work.clear()
                if not self.closed:
                    await self._work.wait()
        finally:
            await self._hang_up()

    async def _send_one(self, data: bytes) -> None:
        await self._transmit(data)
        self._queued -= len(data)
        if self._queued * 2 <= self._limit:
            self._room.set()

    def _send(self, data: Data) -> bool:
        if self._queued + len(data) > self._limit:
            return False
        self._queue.append(bytes(data))
        self._queued += len(data)
        if self._queued * 2 > self._limit:
            self._room.clear()
        self._work.set()
        return True

    def _shut(self) -> None:
        self._work.set()
        self._room.set()
