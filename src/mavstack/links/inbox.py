"""The bounded queue between a link's backend and the task that iterates over the link.

The bound is in bytes, each event counting a fixed overhead beside its data, so that neither a few large
chunks nor a flood of tiny datagrams can fill the memory. A backend either offers (`offer`: refused and
counted when the queue is full, for datagrams) or puts and then waits for room (`put`, `room`: the kernel's
own flow control then slows the peer, for streams and files).

Who reads by `hand_over` may be called by the backend itself (`deliver`): what the event loop has just told it
of goes to the reader in the same turn of the loop, past the queue and past the task that waits for it. What
one end of a link in this process writes to the other is never delivered so, or the two would call each other.
"""

from __future__ import annotations

import asyncio
from collections import deque
from typing import TYPE_CHECKING

from mavstack.errors import LinkError
from mavstack.links.channel import Channel, Counters
from mavstack.links.events import BytesReceived, ChannelClosed, ChannelOpened, LinkDown, LinkEvent

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

EVENT_OVERHEAD = 256


class Inbox:
    """The events of one link that were not read yet, and its live channels."""

    def __init__(self, limit: int) -> None:
        self.past = Counters()
        self._limit = limit
        self._used = 0
        self._events: deque[LinkEvent] = deque()
        self._channels: dict[Channel, None] = {}
        self._reader: asyncio.Future[None] | None = None
        self._take: Callable[[Sequence[LinkEvent]], None] | None = None
        self._room = asyncio.Event()
        self._room.set()
        self._ended = False
        self._error: BaseException | None = None

    @property
    def channels(self) -> Sequence[Channel]:
        """The live channels, oldest first."""
        return tuple(self._channels)

    @property
    def full(self) -> bool:
        """Whether an offer would be refused now."""
        return self._used >= self._limit

    def opened(self, channel: Channel) -> None:
        """Tell of a new peer."""
        self._channels[channel] = None
        self._push(ChannelOpened(channel), 0)

    def closed(self, channel: Channel, reason: str) -> None:
        """Tell of a peer that is gone; a channel that was never told of is ignored."""
        if channel in self._channels:
            del self._channels[channel]
            self.past += channel.counters
            self._push(ChannelClosed(channel, reason), 0)

    def down(self, reason: str, retry_in: float) -> None:
        """Tell that there is no connection, and when the next attempt is due."""
        self._push(LinkDown(reason, retry_in), 0)

    def offer(self, channel: Channel, data: bytes, time: float) -> bool:
        """Queue received bytes, or drop and count them if the queue is full."""
        if self._used >= self._limit:
            channel.counters.dropped_in += 1
            return False
        self.put(channel, data, time)
        return True

    def deliver(self, channel: Channel, data: bytes, time: float) -> None:
        """Give received bytes to the reader at once if it takes them so, else offer them.

        To be called from a callback of the event loop.
        """
        take = self._take
        if take is None or self._events or self._ended:
            self.offer(channel, data, time)
            return
        counters = channel.counters
        counters.bytes_in += len(data)
        counters.chunks_in += 1
        take((BytesReceived(channel, data, time),))

    def put(self, channel: Channel, data: bytes, time: float) -> None:
        """Queue received bytes, even over the bound: the caller waits for `room` before it reads more."""
        counters = channel.counters
        counters.bytes_in += len(data)
        counters.chunks_in += 1
        self._push(BytesReceived(channel, data, time), len(data))

    async def room(self) -> None:
        """Wait until the reader has made room."""
        await self._room.wait()

    def end(self, error: BaseException | None = None) -> None:
        """Let the iteration stop, or raise `error`, after what is queued."""
        if not self._ended:
            self._ended = True
            self._error = error
            self._room.set()
            self._wake()

    async def get(self) -> LinkEvent | None:
        """The next event; None after the last."""
        if not self._events:
            await self._wait()
        if not self._events:
            return None
        event = self._events.popleft()
        self._release(EVENT_OVERHEAD + (len(event.data) if type(event) is BytesReceived else 0))
        return event

    async def get_all(self) -> list[LinkEvent]:
        """All that is queued, at least one event; empty after the last."""
        if not self._events:
            await self._wait()
        events = list(self._events)
        self._events.clear()
        self._release(self._used)
        return events

    async def hand_over(self, take: Callable[[Sequence[LinkEvent]], None]) -> None:
        """Call a function with all that comes, until the end."""
        self._take = take
        try:
            while events := await self.get_all():
                take(events)
        finally:
            self._take = None

    def _push(self, event: LinkEvent, size: int) -> None:
        if self._ended:
            return
        self._events.append(event)
        self._used += EVENT_OVERHEAD + size
        if self._used >= self._limit:
            self._room.clear()
        if self._reader is not None:
            self._wake()

    def _release(self, size: int) -> None:
        self._used -= size
        if self._used * 2 <= self._limit:
            self._room.set()

    def _wake(self) -> None:
        reader, self._reader = self._reader, None
        if reader is not None and not reader.done():
            reader.set_result(None)

    async def _wait(self) -> None:
        """Return when there is an event or the link has ended."""
        if self._reader is not None and not self._reader.done():
            raise LinkError("two tasks iterate over one link; share its events through one of them")
        if not self._ended:
            self._reader = asyncio.get_running_loop().create_future()
            try:
                await self._reader
            finally:
                self._reader = None
        if self._error is not None and not self._events:
            raise self._error
