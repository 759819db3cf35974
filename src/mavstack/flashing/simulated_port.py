"""The asyncio driver of a simulated board: a pseudo terminal, or any other link for uploaders."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Protocol, Self

from mavstack.links import Link, open_link
from mavstack.links.events import BytesReceived, ChannelClosed, ChannelOpened

if TYPE_CHECKING:
    from collections.abc import Sequence
    from types import TracebackType

    from mavstack.links import Channel, LinkEvent


class SimulatedDevice(Protocol):
    """A device without input and output: a simulated board, bootloader or radio."""

    def receive(self, data: bytes, now: float) -> None:
        """Process bytes of a host."""

    def output(self) -> bytes:
        """Return the bytes for the host, once."""

    def next_timeout(self) -> float | None:
        """Return the time of the next `handle_timeout`, or None."""

    def handle_timeout(self, now: float) -> None:
        """Advance to the time `now`."""


class SimulatedPort:
    """A device at a link; an async context manager.

    Args:
        device: The device.
        link: The link, or its URL such as pty:///tmp/ttyBL.
    """

    def __init__(self, device: SimulatedDevice, link: str | Link) -> None:
        self.link = link if isinstance(link, Link) else open_link(link)
        self._device = device
        self._loop = asyncio.get_running_loop()
        self._channel: Channel | None = None
        self._timer: asyncio.TimerHandle | None = None
        self._reader: asyncio.Task[None] | None = None

    async def __aenter__(self) -> Self:
        await self.link.open()
        self._reader = self._loop.create_task(self.link.read(self._receive, direct=True))
        self._advance()
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        if self._timer is not None:
            self._timer.cancel()
        await self.link.close()
        if self._reader is not None:
            self._reader.cancel()
            await asyncio.gather(self._reader, return_exceptions=True)

    def _receive(self, events: Sequence[LinkEvent]) -> None:
        for event in events:
            match event:
                case ChannelOpened(channel):
                    self._channel = channel
                case ChannelClosed(channel) if channel is self._channel:
                    self._channel = None
                case BytesReceived(channel, data, _):
                    self._channel = channel
                    self._device.receive(data, self._loop.time())
        self._flush()

    def _advance(self) -> None:
        self._device.handle_timeout(self._loop.time())
        self._flush()

    def _flush(self) -> None:
        data = self._device.output()
        if data and self._channel is not None:
            self._channel.write(data)
        due = self._device.next_timeout()
        if self._timer is not None and self._timer.when() != due:
            self._timer.cancel()
            self._timer = None
        if self._timer is None and due is not None:
            self._timer = self._loop.call_at(due, self._fire)

    def _fire(self) -> None:
        self._timer = None
        self._advance()
