"""The asyncio driver of conversations with a bootloader: a serial port, or any other link."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final, Self, TypeVar, cast

from mavstack.errors import LinkError
from mavstack.flashing.conversation import Conversation
from mavstack.links import Link, open_link, parse_url
from mavstack.links.events import BytesReceived, ChannelClosed, ChannelOpened, LinkDown

if TYPE_CHECKING:
    from collections.abc import Sequence
    from types import TracebackType

    from mavstack.flashing.conversation import Steps
    from mavstack.links import Channel, LinkEvent

#: The rate of bootloaders on a real serial line; USB ignores it.
BOOTLOADER_BAUD: Final = 115_200
#: Seconds in which a link opens its channel.
CHANNEL_TIMEOUT: Final = 5.0

T = TypeVar("T")


def port_url(text: str, baud: int | None = None) -> str:
    """Return the URL of a port.

    Args:
        text: A URL, or the path of a serial device.
        baud: The rate of a serial device if the URL names none.

    Returns:
        The URL.

    Raises:
        LinkURLError: The URL is malformed.
    """
    url = parse_url(text)
    if url.scheme == "file":  # the path of a device, such as a symbolic link
        url = replace(url, scheme="serial")
    if baud is not None and url.scheme == "serial" and "baud" not in url.options:
        url = replace(url, options={**url.options, "baud": str(baud)})
    return str(url)


class BootloaderPort:
    """A link to a bootloader; an async context manager.

    Args:
        link: The link, or its URL; it is closed at the end.
    """

    def __init__(self, link: str | Link) -> None:
        self._link = link if isinstance(link, Link) else open_link(link)
        self._loop = asyncio.get_running_loop()
        self._channel: Channel | None = None
        self._failure: str | None = None
        self._conversation: Conversation[Any] | None = None
        self._wake = asyncio.Event()
        #: The time at which `run` wakes at the latest.
        self._awaited: float | None = None
        self._reader: asyncio.Task[None] | None = None

    @property
    def name(self) -> str:
        """The URL of the port without secrets."""
        return self._link.url.redacted

    async def __aenter__(self) -> Self:
        await self._link.open()
        self._reader = self._loop.create_task(self._link.read(self._receive, direct=True))
        try:
            async with asyncio.timeout(CHANNEL_TIMEOUT):
                while self._channel is None and self._failure is None:
                    await self._wait()
        except TimeoutError:
            self._failure = "nothing is connected"
        if self._channel is None:
            await self._close()
            raise LinkError(f"cannot open {self.name}: {self._failure}")
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        await self._close()

    async def run(self, steps: Steps[T]) -> T:
        """Carry out a conversation.

        Args:
            steps: The requests, such as `identify()`.

        Returns:
            The result of the steps.

        Raises:
            BootloaderError: The bootloader refuses, or does not answer.
            LinkError: The port was lost.
        """
        conversation = self._conversation = Conversation(steps, self._loop.time())
        try:
            self._flush(conversation)
            while not conversation.done:
                await self._wait_until(conversation.next_timeout())
                if self._failure is not None:
                    raise LinkError(f"{self.name} was lost: {self._failure}")
                conversation.handle_timeout(self._loop.time())
                self._flush(conversation)
        finally:
            self._conversation = None
        return cast("T", conversation.result())

    def write(self, data: bytes) -> None:
        """Send bytes outside of a conversation."""
        if self._channel is not None and self._failure is None:
            self._channel.write(data)

    async def _close(self) -> None:
        await self._link.close()
        if self._reader is not None:
            self._reader.cancel()
            await asyncio.gather(self._reader, return_exceptions=True)

    async def _wait(self) -> None:
        await self._wake.wait()
        self._wake.clear()

    async def _wait_until(self, deadline: float | None) -> None:
        """Wait until the conversation ends, the port is lost, or the present deadline."""
        self._awaited = deadline
        with suppress(TimeoutError):
            async with asyncio.timeout_at(deadline):
                await self._wait()

    def _flush(self, conversation: Conversation[Any]) -> None:
        if data := conversation.data_to_send():
            self.write(data)

    def _receive(self, events: Sequence[LinkEvent]) -> None:
        for event in events:
            match event:
                case BytesReceived(channel, data, _) if channel is self._channel:
                    self._feed(data)
                case ChannelOpened(channel) if self._channel is None:
                    self._channel, self._failure = channel, None
                    self._wake.set()
                case ChannelClosed(channel, reason) if channel is self._channel:
                    self._failure = reason
                    self._wake.set()
                case LinkDown(reason, _) if self._channel is None:
                    self._failure = reason
                    self._wake.set()

    def _feed(self, data: bytes) -> None:
        """Pass bytes on, and send the next request at once, without waking `run` for each block."""
        conversation = self._conversation
        if conversation is None:
            return
        conversation.receive(data, self._loop.time())
        self._flush(conversation)
        deadline = conversation.next_timeout()
        if deadline is None or (self._awaited is not None and deadline < self._awaited):
            self._wake.set()
