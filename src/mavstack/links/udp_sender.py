"""UDP links that send: `udpout://host:port`, one channel to one peer, open from the start (see `udp`)."""

from __future__ import annotations

import asyncio
import socket
from typing import TYPE_CHECKING

from mavstack.links.address import (
    Address,
    format_address,
    is_multicast,
    local_address,
    packed_ip,
    resolve_datagram,
)
from mavstack.links.os_errors import open_error
from mavstack.links.udp import UdpLink
from mavstack.links.udp_channel import UdpChannel

if TYPE_CHECKING:
    from mavstack.links.options import Options
    from mavstack.links.url import LinkURL


class UdpSender(UdpLink):
    """A udpout link: one channel to a fixed peer."""

    def __init__(self, url: LinkURL, options: Options) -> None:
        super().__init__(url, options)
        self._channel: UdpChannel | None = None
        self._accepts_any_sender = False

    async def open_socket(self) -> tuple[socket.socket, Address]:
        """Open the socket alone, for a program that reads it itself; `close` closes it.

        Returns:
            The socket, and the address of the peer.

        Raises:
            LinkError: The socket cannot be opened.
        """
        try:
            family, address = await resolve_datagram(self.url.host, self.url.port)
            sock = self._make_socket(family)
            self._accepts_any_sender = self._is_broadcast_or_multicast(sock, address)
            sock.bind((local_address(address), 0))
        except OSError as error:
            raise open_error(self.url, error) from error
        return sock, address

    async def open_transport(self) -> None:
        """Open the transport of the link."""
        sock, address = await self.open_socket()
        await self._start_reading(sock)
        self._channel = UdpChannel(
            f"udpout {format_address(address)}", address, self.inbox.remove_channel, self
        )
        self.inbox.add_channel(self._channel)

    def sender_of(self, channel: UdpChannel) -> Address | None:
        """Return the address that datagrams of the channel have: that of any port of the peer."""
        return (channel.address[0], 0)

    def _has_plain_peers(self) -> bool:
        return not self._accepts_any_sender

    def _knows(self, address: Address) -> bool:
        return self._channel is not None and address == self._channel.address

    def _is_broadcast_or_multicast(self, sock: socket.socket, address: Address) -> bool:
        """Return whether the address is a multicast group or looks like a broadcast address."""
        target = packed_ip(address)
        if len(target) == 4 and target[3] == 255:
            sock.setsockopt(socket.SOL_SOCKET, socket.SO_BROADCAST, 1)
            return True
        return is_multicast(target)

    def _datagram(self, data: bytes, address: Address, now: float, count: int = 1) -> None:
        channel = self._channel
        if channel is not None and (self._accepts_any_sender or address[0] == channel.address[0]):
            self.inbox.deliver(channel, data, now, count)
        else:
            self.inbox.drop(count=count)

    def remove_channel(self, channel: UdpChannel) -> None:
        """End the link with its only channel."""
        self._channel = None
        asyncio.get_running_loop().call_soon(self.inbox.end)
