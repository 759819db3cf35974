"""The asyncio driver of a request engine: requests over a link, and the line without frames.

A flight controller that enters its command line interface (CLI), or connects the line with another port of
its own, answers no requests. `exclusive` therefore waits for the requests before, refuses further ones, and
lends the bytes of the line to one caller.
"""

from __future__ import annotations

import asyncio
from contextlib import asynccontextmanager, suppress
from typing import TYPE_CHECKING, Final, Self

from mavstack.bridges.msp.transport import msp_name, transport_url
from mavstack.errors import InvalidStateError, LinkClosedError, LinkError
from mavstack.links import Link, open_link
from mavstack.links.events import BytesReceived, ChannelClosed, ChannelOpened, LinkDown
from mavstack.msp.requests import DEFAULT_REPLY_TIMEOUT, DEFAULT_RETRIES, Priority, Request, RequestEngine

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Callable, Sequence

    from mavstack.links import Channel, LinkEvent, LinkURL
    from mavstack.msp.frame import Frame, FrameVersion

#: Seconds to wait for the channel of a link that opens.
CHANNEL_TIMEOUT: Final = 5.0
#: Maximum number of bytes that a caller of `exclusive` may leave unread.
MAX_UNREAD: Final = 1 << 20


class RawLine:
    """The bytes of a line that carries no frames now; made by `MspConnection.exclusive`."""

    def __init__(self, connection: MspConnection, reply: bytes = b"") -> None:
        self.reply = reply  # the reply to the request before the raw line was handed out
        self._connection = connection
        self._data = bytearray()
        self._wake = asyncio.Event()

    def write(self, data: bytes) -> None:
        """Send bytes.

        Raises:
            LinkClosedError: The link is down.
        """
        self._connection.write(data)

    async def read(self) -> bytes:
        """Wait for bytes and return them.

        Raises:
            LinkClosedError: The link is down.
        """
        while not self._data:
            if not self._connection.connected:
                raise LinkClosedError(self._connection.down_text)
            self._wake.clear()
            await self._wake.wait()
        data = bytes(self._data)
        self._data.clear()
        return data

    def receive(self, data: bytes) -> None:
        """Add received bytes, or wake the reader without any."""
        self._data += data
        del self._data[:-MAX_UNREAD]
        self._wake.set()


class MspConnection:
    """A link to a flight controller, and the requests over it.

    Args:
        link: The link, or its URL; the connection opens and closes it.
    """

    def __init__(self, link: str | LinkURL | Link) -> None:
        self._link = link if isinstance(link, Link) else open_link(transport_url(link))
        self.name = msp_name(self._link.url)
        self.engine = RequestEngine(self.name)
        self._channel: Channel | None = None
        self._failure = "it is not open"
        self._changed = asyncio.Event()
        self._reader: asyncio.Task[None] | None = None
        self._timer: asyncio.TimerHandle | None = None
        self._raw: RawLine | None = None
        self._occupied = ""

    @property
    def connected(self) -> bool:
        """True while the link has a channel."""
        return self._channel is not None

    @property
    def down_text(self) -> str:
        """The text of the error of a link that is down."""
        return f"{self.name} is not connected: {self._failure}"

    async def open(self) -> Self:
        """Open the link.

        Returns:
            The connection itself.

        Raises:
            LinkError: The link cannot be opened, or has no peer.
        """
        try:
            await self._link.open()
        except LinkError as error:  # its text has the URL of the link that carries MSP
            raise LinkError(str(error).replace(self._link.url.redacted, self.name)) from None
        self._reader = asyncio.get_running_loop().create_task(self._link.read(self._receive, direct=True))
        try:
            await self.wait_until_connected(CHANNEL_TIMEOUT)
        except BaseException:
            await self.close()
            raise
        return self

    async def close(self) -> None:
        """End all requests, and close the link. Idempotent."""
        self._failure = "it was closed"
        if self._timer is not None:
            self._timer.cancel()
        await self._link.close()
        if self._reader is not None:
            self._reader.cancel()
            await asyncio.gather(self._reader, return_exceptions=True)
        self._end_channel("the connection was closed")

    async def wait_until_connected(self, timeout: float | None) -> None:  # noqa: ASYNC109 (for its error)
        """Wait until the link has a channel.

        Args:
            timeout: Seconds to wait; None: for ever.

        Raises:
            LinkError: The link has no peer in time.
        """
        with suppress(TimeoutError):
            async with asyncio.timeout(timeout):
                while self._channel is None:
                    self._changed.clear()
                    await self._changed.wait()
        if self._channel is None:
            reason = "nothing is connected" if self._failure == "it is not open" else self._failure
            raise LinkError(f"cannot open {self.name}: {reason}")

    async def request(
        self,
        command: int,
        payload: bytes = b"",
        *,
        name: str = "",
        priority: Priority = Priority.NORMAL,
        timeout: float | None = None,  # noqa: ASYNC109 (its typed error names the command)
        reply_timeout: float = DEFAULT_REPLY_TIMEOUT,
        retries: int = DEFAULT_RETRIES,
        version: FrameVersion | None = None,
        flags: int = 0,
    ) -> bytes:
        """Send a request, and wait for its reply.

        Args:
            command: Number of the command.
            payload: The bytes of the message.
            name: Official name of the command in error texts; empty: the number.
            priority: Its place among the waiting requests.
            timeout: Seconds for the whole call; None: until all attempts have failed.
            reply_timeout: Seconds for the reply to each attempt.
            retries: Further attempts after the first one.
            version: The encoding; None: v1, or v2 if v1 cannot carry the request.
            flags: Flags of v2.

        Returns:
            The payload of the reply.

        Raises:
            MspTimeout: No reply came in time.
            MspDenied: The firmware refused the request.
            LinkClosedError: The link is down.
            RemoteCancelled: The link went down meanwhile.
            InvalidStateError: The line carries no requests now.
        """
        if self._occupied:
            raise InvalidStateError(f"{name or command} cannot be sent: {self._occupied}")
        deadline = None if timeout is None else asyncio.get_running_loop().time() + timeout
        request = self.engine.request(
            command,
            payload,
            name=name,
            priority=priority,
            timeout=reply_timeout,
            retries=retries,
            version=version,
            flags=flags,
            deadline=deadline,
        )
        return await self._finish(request)

    async def _finish(self, request: Request) -> bytes:
        """Wait for the end of a request."""
        ended: asyncio.Future[None] = asyncio.get_running_loop().create_future()

        def end(_: Request) -> None:
            if not ended.done():
                ended.set_result(None)

        request.callback = end
        if self._channel is None:
            self.engine.cancel(request)
            raise LinkClosedError(self.down_text)
        self._step()
        try:
            await ended
        finally:
            if not request.done:
                self.engine.cancel(request)
                self._step()
        return request.result()

    def on_unsolicited(self, callback: Callable[[Frame], None] | None) -> None:
        """Call a function with each frame that answers no request; None: none."""
        self.engine.unsolicited = callback

    @asynccontextmanager
    async def exclusive(
        self, purpose: str, request: Callable[[], Request] | None = None
    ) -> AsyncIterator[RawLine]:
        """Lend the bytes of the line, after the requests that wait have ended.

        Args:
            purpose: The reason for which further requests are refused.
            request: Makes the last request, after whose reply the line carries no frames; None: none.

        Raises:
            InvalidStateError: The line is lent already.
            LinkClosedError: The link is down.
            MspError: The last request failed.
        """
        if self._occupied:
            raise InvalidStateError(f"{self.name}: {self._occupied}")
        if self._channel is None:
            raise LinkClosedError(self.down_text)
        self._occupied = purpose
        try:
            while not self.engine.idle:
                self._changed.clear()
                await self._changed.wait()
            self._raw = RawLine(self, b"" if request is None else await self._finish(request()))
            self.engine.parser.resynchronize()
            self.engine.parser.take_text()
            self.engine.parser.enter_cli()
            yield self._raw
        finally:
            self._raw, self._occupied = None, ""
            self.engine.parser.leave_cli()
            self.engine.parser.take_text()

    def write(self, data: bytes) -> None:
        """Send bytes as they are.

        Raises:
            LinkClosedError: The link is down.
        """
        if self._channel is None:
            raise LinkClosedError(self.down_text)
        self._channel.write(data)

    def _step(self, data: bytes = b"") -> None:
        """Drive the engine, and set the timer of its next step."""
        loop, engine = asyncio.get_running_loop(), self.engine
        if data:
            engine.receive(data, loop.time())
        else:
            engine.step(loop.time())
        output = engine.data_to_send()
        if output and self._channel is not None:
            self._channel.write(output)
        if self._occupied and engine.idle:
            self._changed.set()
        due = engine.next_due()
        if due is not None and (self._timer is None or due < self._timer.when()):
            self._set_timer(due)

    def _set_timer(self, due: float) -> None:
        if self._timer is not None:
            self._timer.cancel()
        self._timer = asyncio.get_running_loop().call_at(due, self._expire)

    def _expire(self) -> None:
        """Drive the engine at the time of the timer, which may be earlier than what is due."""
        self._timer = None
        self._step()

    def _receive(self, events: Sequence[LinkEvent]) -> None:
        for event in events:
            match event:
                case BytesReceived(channel, data, _) if channel is self._channel:
                    self._receive_data(data)
                case ChannelOpened(channel) if self._channel is None:
                    self._channel = channel
                    self._changed.set()
                case ChannelClosed(channel, reason) if channel is self._channel:
                    self._end_channel(reason)
                case LinkDown(reason, _) if self._channel is None:
                    self._failure = reason

    def _receive_data(self, data: bytes) -> None:
        if self._raw is None:
            self._step(data)
            self.engine.parser.take_text()
        else:
            self.engine.parser.feed(data)
            self._raw.receive(self.engine.parser.take_text())

    def _end_channel(self, reason: str) -> None:
        self._channel, self._failure = None, reason
        self.engine.cancel_all(f"the link was lost: {reason}")
        self._changed.set()
        if self._raw is not None:
            self._raw.receive(b"")
