"""Datagrams by a transport of asyncio, for event loops without socket readers (Windows)."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import socket
    from collections.abc import Callable

    from mavstack.links.address import Address
    from mavstack.links.channel import Data
    from mavstack.links.udp_channel import UdpChannel


class TransportOutbox:
    """The transport of a socket, which receives and sends datagrams one by one.

    Args:
        limit: Maximum number of bytes that wait to be sent.
        receive: Called with each received datagram and its sender.
    """

    def __init__(self, limit: int, receive: Callable[[bytes, Address], None]) -> None:
        self._limit = limit
        self._receive = receive
        self._transport: asyncio.DatagramTransport | None = None

    async def open(self, sock: socket.socket) -> None:
        """Take over a socket."""
        loop = asyncio.get_running_loop()
        self._transport, _ = await loop.create_datagram_endpoint(lambda: _Protocol(self._receive), sock=sock)

    def send(self, data: Data, channel: UdpChannel) -> bool:
        """Send a datagram to a channel's peer, or let it wait; return false if it is dropped."""
        transport = self._transport
        if transport is None:
            return False
        if transport.get_write_buffer_size() + len(data) > self._limit:  # type: ignore[attr-defined]
            return False
        transport.sendto(data, channel.address)
        return True

    async def close(self, timeout: float) -> None:  # noqa: ASYNC109 (as `UdpOutbox.close`)
        """Close the transport, which sends what waits."""
        if self._transport is not None:
            self._transport.close()


class _Protocol(asyncio.DatagramProtocol):
    def __init__(self, receive: Callable[[bytes, Address], None]) -> None:
        self._receive = receive

    def datagram_received(self, data: bytes, addr: Address) -> None:
        self._receive(data, addr)
