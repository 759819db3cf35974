"""The bounded queue between the backend of a link and the task that iterates over the link.

The bound is in bytes, and each event counts a fixed overhead beside its data, so that neither a few large
chunks nor many small datagrams can fill the memory. Backends of datagrams call `offer`, which drops and
counts the chunk if the queue is full. Backends of streams and files call `put` and then await
`wait_for_room`, so that the kernel's flow control slows down the peer.

A backend may pass received bytes directly to the callback of `run_reader` by calling `deliver` from a
callback of the event loop: they bypass the queue and the waiting task. Links within one process never do
this, because the two ends would call each other recursively.
"""

from __future__ import annotations

import asyncio
from collections import deque
from typing import TYPE_CHECKING

from mavstack.errors import InvalidStateError
from mavstack.links.channel import Channel, Counters
from mavstack.links.events import BytesReceived, ChannelClosed, ChannelOpened, LinkDown, LinkEvent

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from mavstack.links.link_log import LinkLog

EVENT_OVERHEAD = 256


class Inbox:
    """The unread events of one link, and its open channels; `limit` is in bytes."""

    def __init__(self, limit: int, log: LinkLog | None = None) -> None:
        self._log = log
        self.closed_counters = Counters()
        self._limit = limit
        self._used = 0
        self._events: deque[LinkEvent] = deque()
        self._channels: dict[Channel, None] = {}
        self._reader: asyncio.Future[None] | None = None
        self._callback: Callable[[Sequence[LinkEvent]], None] | None = None
        self._is_direct = False
        self._has_room = asyncio.Event()
        self._has_room.set()
        self._ended = False
        self._error: BaseException | None = None

    @property
    def channels(self) -> Sequence[Channel]:
        """The open channels, oldest first."""
        return tuple(self._channels)

    @property
    def full(self) -> bool:
        """True if the queue has no room."""
        return self._used >= self._limit

    @property
    def is_direct(self) -> bool:
        """True if `receive` passes bytes directly now."""
        return self._is_direct and not self._events and not self._ended

    @property
    def is_read(self) -> bool:
        """True if a reader has read every event."""
        return self._callback is not None and not self._events and not self._ended

    def add_channel(self, channel: Channel) -> None:
        """Add a channel."""
        self._channels[channel] = None
        if self._log:
            self._log.channel_opened(channel)
        self._push(ChannelOpened(channel), 0)

    def remove_channel(self, channel: Channel, reason: str) -> None:
        """Remove a closed channel; an unknown channel is ignored."""
        if channel in self._channels:
            del self._channels[channel]
            self.closed_counters += channel.counters
            if self._log:
                self._log.channel_closed(channel, reason)
            self._push(ChannelClosed(channel, reason), 0)

    def report_down(self, reason: str, retry_in: float) -> None:
        """Report a lost connection, and the delay before the next attempt in seconds."""
        if self._log:
            self._log.link_down(reason, retry_in)
        self._push(LinkDown(reason, retry_in), 0)

    def offer(self, channel: Channel, data: bytes, time: float, count: int = 1) -> bool:
        """Queue received bytes, or drop and count them if the queue is full; they are `count` chunks."""
        if self._used >= self._limit:
            self.drop(channel.counters, count)
            return False
        self.put(channel, data, time, count)
        return True

    def drop(self, counters: Counters | None = None, count: int = 1) -> None:
        """Count and log dropped chunks, of a channel or of no channel."""
        counters = self.closed_counters if counters is None else counters
        counters.dropped_in += count
        if self._log:
            self._log.dropped(count)

    def deliver(self, channel: Channel, data: bytes, time: float, count: int = 1) -> None:
        """Pass received bytes directly to the callback of `run_reader`, or else offer them.

        Must be called from a callback of the event loop.
        """
        callback = self._callback
        if callback is None or self._events or self._ended:
            self.offer(channel, data, time, count)
            return
        counters = channel.counters
        counters.bytes_in += len(data)
        counters.chunks_in += count
        callback((BytesReceived(channel, data, time),))

    def put(self, channel: Channel, data: bytes, time: float, count: int = 1) -> None:
        """Queue received bytes even if the queue is full; the caller then awaits `wait_for_room`."""
        counters = channel.counters
        counters.bytes_in += len(data)
        counters.chunks_in += count
        self._push(BytesReceived(channel, data, time), len(data))

    def receive(self, channel: Channel, data: bytes, time: float) -> None:
        """Pass received bytes of a stream to a direct callback of `run_reader`, or queue them."""
        if self._is_direct:
            self.deliver(channel, data, time)
        else:
            self.put(channel, data, time)

    async def wait_for_room(self) -> None:
        """Wait until the reader has made room."""
        await self._has_room.wait()

    def end(self, error: BaseException | None = None) -> None:
        """End the iteration after the queued events, or let it raise `error`."""
        if not self._ended:
            self._ended = True
            self._error = error
            self._has_room.set()
            self._wake()

    async def get(self) -> LinkEvent | None:
        """Return the next event, or None after the last."""
        if not self._events:
            await self._wait()
        if not self._events:
            return None
        event = self._events.popleft()
        self._release(EVENT_OVERHEAD + (len(event.data) if type(event) is BytesReceived else 0))
        return event

    async def get_all(self) -> list[LinkEvent]:
        """Return all queued events, waiting for the first; an empty list after the last."""
        if not self._events:
            await self._wait()
        events = list(self._events)
        self._events.clear()
        self._release(self._used)
        return events

    async def run_reader(
        self, callback: Callable[[Sequence[LinkEvent]], None], *, direct: bool = False
    ) -> None:
        """Call `callback` with all events until the last; `direct`: by the tasks of streams too."""
        self._callback, self._is_direct = callback, direct
        try:
            while events := await self.get_all():
                callback(events)
        finally:
            self._callback, self._is_direct = None, False

    def _push(self, event: LinkEvent, size: int) -> None:
        if self._ended:
            return
        self._events.append(event)
        self._used += EVENT_OVERHEAD + size
        if self._used >= self._limit:
            self._has_room.clear()
        if self._reader is not None:
            self._wake()

    def _release(self, size: int) -> None:
        self._used -= size
        if self._used * 2 <= self._limit:
            self._has_room.set()

    def _wake(self) -> None:
        reader, self._reader = self._reader, None
        if reader is not None and not reader.done():
            reader.set_result(None)

    async def _wait(self) -> None:
        """Wait until there is an event or the link has ended."""
        if self._reader is not None and not self._reader.done():
            raise InvalidStateError(
                "two tasks iterate over one link: pass its events to the others from one task"
            )
        if not self._ended:
            self._reader = asyncio.get_running_loop().create_future()
            try:
                await self._reader
            finally:
                self._reader = None
        if self._error is not None and not self._events:
            raise self._error
