"""The link that a recording is replayed onto: `mav watch FILE --to URL`.

Packets are written as they were recorded, byte for byte, at the times at which the replay yields them. A
SETUP_SIGNING is left out: it carries a signing key in the clear. What peers send back is discarded.
"""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

from mavstack.errors import LinkClosedError, LinkURLError
from mavstack.links import open_link
from mavstack.security import carries_signing_key

if TYPE_CHECKING:
    from collections.abc import Sequence
    from types import TracebackType
    from typing import Self

    from mavstack.links import Channel, LinkEvent
    from mavstack.wire import Packet


class Relay:
    """An output of packets; an async context manager that opens and closes its link.

    Raises:
        LinkURLError: The URL is invalid, or has options that would change packets.
    """

    def __init__(self, url: str) -> None:
        self.link = open_link(url)
        if given := self.link.settings.given:
            shown = self.link.url.redacted
            raise LinkURLError(f"{shown}: packets are replayed unchanged; remove the option {given[0]}")
        #: Packets sent to all peers, and packets dropped for at least one peer, whose queue was full.
        self.sent = 0
        self.dropped = 0
        self._has_peer = asyncio.Event()
        self._reader: asyncio.Task[None] | None = None

    async def has_peer(self) -> bool:
        """Return whether the link has a peer; a channel that is open from the start is reported first."""
        await asyncio.sleep(0)
        return bool(self.link.channels)

    async def wait_for_peer(self) -> None:
        """Wait until the link has a peer."""
        await self._has_peer.wait()

    def send(self, packets: Sequence[Packet]) -> None:
        """Write packets to all peers."""
        for packet in packets:
            if not carries_signing_key(packet):
                accepted = [_write(channel, packet.raw) for channel in tuple(self.link.channels)]
                self.sent += all(accepted)
                self.dropped += not all(accepted)

    async def drain(self) -> None:
        """Wait until all peers have room for more."""
        for channel in self.link.channels:
            try:
                await channel.drain()
            except LinkClosedError:
                continue

    def _handle(self, _events: Sequence[LinkEvent]) -> None:
        if self.link.channels:
            self._has_peer.set()

    async def __aenter__(self) -> Self:
        await self.link.open()
        self._reader = asyncio.get_running_loop().create_task(self.link.read(self._handle))
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await self.link.close()
        if self._reader is not None:
            self._reader.cancel()
            await asyncio.gather(self._reader, return_exceptions=True)


def _write(channel: Channel, data: bytes) -> bool:
    try:
        return channel.write(data)
    except LinkClosedError:
        return False
