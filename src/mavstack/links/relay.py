"""Links through a relay: `relayin://relay.example` takes a room, `relay://relay.example` visits its host.

Both ends dial out by WebSocket, so that neither needs an address that others reach. The host of a room is a
vehicle or an agent, and has a channel for each guest; a guest, such as a ground station, has a channel to the
host. `ticket=` opens the room (see `mavstack.security.room_tickets`). Each channel is sealed from end to end
(see `mavstack.links.sealed`): the relay sees neither packets nor keys. The relay may drop datagrams, and
nothing else that it does reaches a vehicle. A lost connection is opened again as that of any client.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from mavstack.errors import LinkClosedError, LinkURLError
from mavstack.links.base import Link
from mavstack.links.channel import Channel
from mavstack.links.events import BytesReceived, ChannelClosed, ChannelOpened, LinkDown
from mavstack.links.relay_frames import (
    MAX_DATAGRAM,
    RELAY_PROTOCOL,
    Change,
    GuestDatagram,
    Notice,
    decode,
    encode_datagram,
)
from mavstack.links.sealed import SealedLink
from mavstack.links.ws import WsClient

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from websockets.typing import Subprotocol

    from mavstack.links.channel import Data
    from mavstack.links.events import LinkEvent
    from mavstack.links.options import Options
    from mavstack.links.url import LinkURL

#: Maximum number of guests of a host: a relay that invents guests must not fill the memory.
MAX_GUESTS = 64


def relay_guest(url: LinkURL, options: Options) -> Link:
    """Create the link of a guest: sealed, with one channel to the host of the room."""
    return SealedLink(url, options, _RelayClient(url, options), answers=False)


def relay_host(url: LinkURL, options: Options) -> Link:
    """Create the link of a host: sealed, with a channel for each guest of the room."""
    return SealedLink(url, options, _RelayHost(url, options), answers=True)


class _RelayClient(WsClient):
    """The WebSocket to a relay, which the ticket opens."""

    def __init__(self, url: LinkURL, options: Options) -> None:
        super().__init__(url, options, "wss" if options.flag("tls", default=True) else "ws")
        self._ticket = options.text("ticket")
        if not self._ticket:
            raise LinkURLError(f"{url.redacted} has no ticket: add ?ticket=… as `mav relay invite` prints it")

    def offer(self) -> list[Subprotocol]:
        """Return the subprotocols of one attempt: that of relays, and the ticket."""
        return cast("list[Subprotocol]", [RELAY_PROTOCOL, self._ticket])


class _GuestChannel(Channel):
    """One guest of the room, over the WebSocket of the host."""

    def __init__(self, guest: int, socket: Channel, on_closed: Callable[[Channel, str], None]) -> None:
        peer = f"guest-{guest}@{socket.peer}"
        super().__init__(f"relayin {peer}", peer, on_closed)
        self.guest = guest
        self._socket = socket

    def send_bytes(self, data: Data) -> bool:
        """Send or queue a datagram for the guest."""
        return (
            len(data) <= MAX_DATAGRAM
            and not self._socket.closed
            and self._socket.write(encode_datagram(self.guest, bytes(data)))
        )

    async def drain(self) -> None:
        """Wait until the WebSocket has room."""
        await self._socket.drain()
        if self.closed:
            raise LinkClosedError(f"{self.name} is closed")

    def close_transport(self) -> None:
        """Leave the WebSocket to the other guests."""


class _RelayHost(Link):
    """The guests of a room as channels of one WebSocket; `SealedLink` seals each of them."""

    logged = False

    def __init__(self, url: LinkURL, options: Options) -> None:
        super().__init__(url, options)
        self._client = _RelayClient(url, options)
        self._guests: dict[int, _GuestChannel] = {}

    async def open_transport(self) -> None:
        """Open the WebSocket."""
        await self._client.open()
        self.spawn(self._follow())

    async def _follow(self) -> None:
        await self._client.read(self._handle)
        self.inbox.end()

    def _handle(self, events: Sequence[LinkEvent]) -> None:
        for event in events:
            match event:
                case BytesReceived(socket, data, time):
                    self._receive(socket, data, time)
                case ChannelOpened():
                    pass
                case ChannelClosed(_, reason):
                    self._end_guests(reason)
                case LinkDown(reason, retry_in):
                    self.inbox.report_down(reason, retry_in)

    def _receive(self, socket: Channel, message: bytes, time: float) -> None:
        match decode(message):
            case Notice(Change.CAME, guest):
                self._add(guest, socket)
            case Notice(Change.LEFT, guest) if guest in self._guests:
                self._guests[guest].close("the guest left")
            case GuestDatagram(guest, data):
                # adds an unknown guest: the notice of its arrival may have been dropped
                channel = self._add(guest, socket)
                channel.last_received = time
                self.inbox.deliver(channel, data, time)
            case _:
                self.inbox.drop()

    def _add(self, guest: int, socket: Channel) -> _GuestChannel:
        """Return the channel of a guest; the idlest one makes room for a new one."""
        if guest in self._guests:
            return self._guests[guest]
        if len(self._guests) >= MAX_GUESTS:
            min(self._guests.values(), key=lambda each: each.last_received).close("too many guests")
        self._guests[guest] = channel = _GuestChannel(guest, socket, self._guest_closed)
        self.inbox.add_channel(channel)
        return channel

    def _guest_closed(self, channel: Channel, reason: str) -> None:
        self._guests.pop(cast("_GuestChannel", channel).guest, None)
        self.inbox.remove_channel(channel, reason)

    def _end_guests(self, reason: str) -> None:
        for channel in tuple(self._guests.values()):
            channel.close(reason)

    async def stop_transport(self) -> None:
        """Close the WebSocket."""
        await self._client.close()
