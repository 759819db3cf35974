"""A link is a configured URL that yields channels, one a live peer.

    async with open_link("udpin://0.0.0.0:14550") as link:      # or: link = await open_link(…)
        async for event in link:
            match event:
                case ChannelOpened(channel): channel.write(b"hello")
                case BytesReceived(channel, data, time): ...
                case ChannelClosed(channel, reason): ...
                case LinkDown(reason, retry_in): ...

Opening raises `LinkError` if the port is busy, the device missing, the peer not there. Iterating ends
after `close`, and by itself where no more can come (the end of a file, a lost peer with reconnect=no).
Links move bytes and know nothing about what is in them.

Every backend takes its options from the URL's query and shares these, in bytes (`64k`, `4M`):
`receive_queue` for what nobody has read yet; for each channel, `send_queue` for what is not sent yet; and
`pace`, what the whole way to the peer carries in a second, for those above who pace transfers (0: not known;
with `half_duplex=yes` both directions share it).
"""

from __future__ import annotations

import asyncio
from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Self

from mavstack.errors import LinkClosedError, LinkError
from mavstack.links.inbox import Inbox

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Callable, Coroutine, Generator, Sequence

    from mavstack.links.channel import Channel, Counters
    from mavstack.links.events import LinkEvent
    from mavstack.links.options import Options
    from mavstack.links.url import LinkURL

RECEIVE_QUEUE = 8 << 20
SEND_QUEUE = 256 << 10


class Link(ABC):
    """A configured link: open it, iterate over its events, close it."""

    def __init__(self, url: LinkURL, options: Options) -> None:
        self.url = url
        self._inbox = Inbox(options.size("receive_queue", RECEIVE_QUEUE))
        self._send_queue = options.size("send_queue", SEND_QUEUE)
        self.pace = options.size("pace", 0)
        self.half_duplex = options.flag("half_duplex", default=False)
        self._tasks: set[asyncio.Task[None]] = set()
        self._opened = False
        self._closed = False

    @property
    def closed(self) -> bool:
        """Whether `close` was called."""
        return self._closed

    @property
    def channels(self) -> Sequence[Channel]:
        """The live peers, oldest first."""
        return self._inbox.channels

    @property
    def counters(self) -> Counters:
        """The sum over all channels, past ones included."""
        return sum((channel.counters for channel in self.channels), self._inbox.past)

    @property
    def address(self) -> tuple[str, int] | None:
        """The host and port that a listening link really has, as when it was opened with port 0."""
        return None

    async def open(self) -> Self:
        """Open the link; raises `LinkError` that names the URL and what to do."""
        if self._closed:
            raise LinkClosedError(f"{self.url} was closed; open a new link")
        if not self._opened:
            self._opened = True
            try:
                await self._open()
            except BaseException:
                await self.close()
                raise
        return self

    async def close(self) -> None:
        """Close all channels, sending what is queued for a moment. Closing twice does nothing."""
        if self._closed:
            return
        self._closed = True
        await self._stop()
        for channel in self.channels:
            channel.close("link closed")
        self._inbox.end()
        await self._finish_tasks(self._patience())
        await self._release()

    async def batches(self) -> AsyncIterator[list[LinkEvent]]:
        """Iterate over lists of all events at hand: cheaper than one by one on a busy link."""
        self._require_open()
        while events := await self._inbox.get_all():
            yield events

    async def read(self, take: Callable[[Sequence[LinkEvent]], None]) -> None:
        """Have a function called with all events at hand, until the link ends: cheaper still than `batches`.

        A link that its event loop wakes up for what comes calls it at once, with no task between.
        """
        self._require_open()
        await self._inbox.hand_over(take)

    @abstractmethod
    async def _open(self) -> None:
        """Open what is underneath, and start the tasks that read it."""

    async def _stop(self) -> None:  # noqa: B027 - not every backend listens
        """Take no more peers and bytes."""

    async def _release(self) -> None:  # noqa: B027 - not every backend holds more than its channels
        """Let go of what is left when channels and tasks are done."""

    def _patience(self) -> float:
        """For how many seconds closing waits for tasks that still send."""
        return 0

    def _spawn(self, work: Coroutine[None, None, None]) -> asyncio.Task[None]:
        task = asyncio.get_running_loop().create_task(work)
        self._tasks.add(task)
        task.add_done_callback(self._task_done)
        return task

    def _task_done(self, task: asyncio.Task[None]) -> None:
        self._tasks.discard(task)
        if not task.cancelled() and (error := task.exception()):
            self._inbox.end(error)  # a defect must not be silent: it comes out of the iteration

    async def _finish_tasks(self, patience: float) -> None:
        if self._tasks:
            await asyncio.sleep(0)  # a task that never began could not let go of what it was given
        if self._tasks and patience:
            await asyncio.wait(self._tasks, timeout=patience)
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)

    def _require_open(self) -> None:
        if not self._opened:
            raise LinkError(f"{self.url} is not open yet: use `async with` or `await` it")

    async def __aenter__(self) -> Self:
        return await self.open()

    async def __aexit__(self, *_: object) -> None:
        await self.close()

    def __await__(self) -> Generator[None, None, Self]:
        return self.open().__await__()

    def __aiter__(self) -> Self:
        self._require_open()
        return self

    async def __anext__(self) -> LinkEvent:
        event = await self._inbox.get()
        if event is None:
            raise StopAsyncIteration
        return event

    def __repr__(self) -> str:
        state = "closed" if self._closed else "open" if self._opened else "not open"
        return f"<{type(self).__name__} {self.url} ({state})>"
