"""The base class of links. A link is a configured URL that yields channels, one for each live peer.

    async with open_link("udpin://0.0.0.0:14550") as link:      # or: link = await open_link(…)
        async for event in link:
            match event:
                case ChannelOpened(channel): channel.write(b"hello")
                case BytesReceived(channel, data, time): ...
                case ChannelClosed(channel, reason): ...
                case LinkDown(reason, retry_in): ...

Opening raises `LinkError` if the port is in use, the device is missing or the peer is not reachable. The
iteration ends after `close`, at the end of a file, and after a lost connection with `reconnect=no`. Links
transport bytes without interpreting them.

Every backend reads its options from the query of the URL. These options are common to all, in bytes (`64k`,
`4M`): `receive_queue` bounds the received bytes that are not read yet; `send_queue` bounds the unsent bytes
of each channel; `pace` is the bandwidth to the peer in bytes per second, by which the node paces its
transfers (0: unknown; with `half_duplex=yes` both directions share it). The options for the node (signing
key, ids, MAVLink version, heartbeats) are in `settings`.
"""

from __future__ import annotations

import asyncio
from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Self

from mavstack.errors import InvalidStateError, LinkClosedError
from mavstack.links.inbox import Inbox
from mavstack.links.link_log import LinkLog
from mavstack.links.settings import LinkSettings

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Callable, Coroutine, Generator, Sequence

    from mavstack._core import Intake
    from mavstack.links.channel import Channel, Counters
    from mavstack.links.events import LinkEvent
    from mavstack.links.native_reading import NativeReading
    from mavstack.links.options import Options
    from mavstack.links.url import LinkURL

DEFAULT_RECEIVE_QUEUE = 8 << 20
DEFAULT_SEND_QUEUE = 256 << 10


class Link(ABC):
    """A configured link: an async context manager, and an async iterator over its events.

    `async with link:` or `await link` opens it. Only one task may iterate over the events.

    A backend implements `open_transport`, adds its channels and their bytes to `inbox`, and starts its tasks
    by `spawn`; `stop_transport`, `release_transport` and `close_timeout` take part in closing. Its channels
    implement `send_bytes` and `close_transport` (see `Channel`).

    Attributes:
        url: The URL of the link.
        inbox: The channels, and the events that are not read yet.
        pace: Bandwidth of the link in bytes per second; 0: unknown.
        half_duplex: Both directions share the bandwidth.
        settings: The options of the URL for the node.
    """

    logged = True  # False for a link that wraps another one, which writes the log
    #: True if the reader parses the bytes of a channel as a stream. Waiting datagrams of one sender may then
    #: become one event, which costs much less than several.
    joins_datagrams = False
    #: Returns whether the first bytes of a new peer are validly signed: a full link prefers such a peer.
    #: None: signatures cannot be checked.
    authenticates: Callable[[bytes], bool] | None = None
    #: Updates the proofs of the peers before a full link chooses which peers it keeps; None: no update.
    before_choice: Callable[[], None] | None = None

    def __init__(self, url: LinkURL, options: Options) -> None:
        self.url = url
        self._log = LinkLog(url) if self.logged else None
        self.inbox = Inbox(options.size("receive_queue", DEFAULT_RECEIVE_QUEUE), self._log)
        self._send_queue = options.size("send_queue", DEFAULT_SEND_QUEUE)
        self.pace = options.size("pace", 0)
        self.half_duplex = options.flag("half_duplex", default=False)
        #: The options of the URL that concern MAVLink, which the node of the link applies.
        self.settings = LinkSettings.from_options(options)
        self._tasks: set[asyncio.Task[None]] = set()
        self._opened = False
        self._closed = False

    def trust_senders(self) -> None:  # noqa: B027 - only some links have senders that are not known
        """Send everything to new peers at once; call it before `open`."""

    @property
    def closed(self) -> bool:
        """True after `close`."""
        return self._closed

    @property
    def send_queue(self) -> int:
        """Maximum number of unsent bytes of a channel."""
        return self._send_queue

    @property
    def channels(self) -> Sequence[Channel]:
        """The open channels, oldest first."""
        return self.inbox.channels

    @property
    def counters(self) -> Counters:
        """Total counters of all channels, including closed ones."""
        return sum((channel.counters for channel in self.channels), self.inbox.closed_counters)

    @property
    def address(self) -> tuple[str, int] | None:
        """Host and port on which the link listens, or None; differs from the URL if that has port 0."""
        return None

    async def open(self) -> Self:
        """Open the link; has no effect on an open link.

        Returns:
            The link itself.

        Raises:
            LinkError: The link cannot be opened; the text names the URL and what to do.
            LinkClosedError: The link was closed before.
        """
        if self._closed:
            raise LinkClosedError(f"cannot open {self.url.redacted}: it was closed; open a new link")
        if not self._opened:
            self._opened = True
            try:
                await self.open_transport()
            except BaseException:
                await self.close()
                raise
            if self._log:
                self._log.link_opened()
        return self

    async def close(self) -> None:
        """Close the link and all its channels, sending queued bytes for up to `CLOSE_TIMEOUT`. Idempotent."""
        if self._closed:
            return
        self._closed = True
        await self.stop_transport()
        for channel in self.channels:
            channel.close("link closed")
        if self._log and self._opened:
            self._log.link_closed()
        self.inbox.end()
        await self._finish_tasks(self.close_timeout())
        await self.release_transport()

    async def batches(self) -> AsyncIterator[list[LinkEvent]]:
        """Iterate over lists of all queued events, which on a busy link is cheaper than one by one.

        Yields:
            Lists of at least one event, until the link ends.

        Raises:
            InvalidStateError: The link is not open, or another task iterates over it.
        """
        self._require_open()
        while events := await self.inbox.get_all():
            yield events

    async def read(self, callback: Callable[[Sequence[LinkEvent]], None], *, direct: bool = False) -> None:
        """Pass all events to a callback until the link ends, which is cheaper than `batches`.

        Links whose sockets are read by the event loop call it directly, without waking this task.

        Args:
            callback: Called with a sequence of events; it must not block.
            direct: Let streams call it directly too: for callers that keep up with the link, and whose
                requests wait for the reply before.

        Raises:
            InvalidStateError: The link is not open, or another task iterates over it.
        """
        self._require_open()
        await self.inbox.run_reader(callback, direct=direct)

    def read_natively(self, intake: Intake, number: int) -> NativeReading | None:
        """Let a thread of the core read the link, which then passes it to `read` only in part.

        Args:
            intake: The intake of the node.
            number: The number of the link in the intake.

        Returns:
            The reading; None if the link is read by the event loop.
        """
        return None

    def hold(self) -> None:  # noqa: B027 - only some links send several chunks together
        """Let chunks that are written wait until `release`, if the link can send them together."""

    def release(self) -> None:  # noqa: B027 - as above
        """Send the chunks that were written since `hold`."""

    @abstractmethod
    async def open_transport(self) -> None:
        """Open the transport, and start the tasks that read from it.

        Raises:
            LinkError: The transport cannot be opened; the text names the URL and what to do.
        """

    async def stop_transport(self) -> None:  # noqa: B027 - not every backend listens
        """Stop accepting peers and bytes."""

    async def release_transport(self) -> None:  # noqa: B027 - not every backend holds more than its channels
        """Release the remaining resources after all channels and tasks have ended."""

    def close_timeout(self) -> float:
        """Return for how many seconds `close` waits for tasks that still send."""
        return 0

    def spawn(self, work: Coroutine[None, None, None]) -> asyncio.Task[None]:
        """Start a task that ends with the link; an exception of it ends the iteration over the events.

        Args:
            work: The coroutine.

        Returns:
            The task.
        """
        task = asyncio.get_running_loop().create_task(work)
        self._tasks.add(task)
        task.add_done_callback(self._task_done)
        return task

    def _task_done(self, task: asyncio.Task[None]) -> None:
        self._tasks.discard(task)
        if not task.cancelled() and (error := task.exception()):
            # the iteration over the inbox raises the error, so that a defect is noticed
            self.inbox.end(error)

    async def _finish_tasks(self, timeout: float) -> None:  # noqa: ASYNC109 (how long tasks may still send)
        if self._tasks:
            # let new tasks start: a task that never started cannot release its resources
            await asyncio.sleep(0)
        if self._tasks and timeout:
            await asyncio.wait(self._tasks, timeout=timeout)
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)

    def _require_open(self) -> None:
        if not self._opened:
            raise InvalidStateError(f"{self.url.redacted} is not open: use `async with` or `await` it")

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
        event = await self.inbox.get()
        if event is None:
            raise StopAsyncIteration
        return event

    def __repr__(self) -> str:
        state = "closed" if self._closed else "open" if self._opened else "not open"
        return f"<{type(self).__name__} {self.url.redacted} ({state})>"
