"""UDP: `udpin://host:port` listens, `udpout://host:port` sends to one peer.

On udpin each remote address is a channel, up to `max_peers`, and one that is silent for `idle` seconds is
closed. On udpout there is one channel, open from the start; what comes back from any port of the peer
belongs to it, and after a broadcast or to a multicast group what comes from anyone. A multicast group as
host of udpin is joined.

Datagrams are read many at each wake-up of the event loop and become one event each, handed over before the
next is read, since more come meanwhile; if nobody reads the events they are dropped and counted, newest
first. What the kernel dropped before that is in `kernel_drops`, where the system tells (Linux): a larger
`socket_buffer` helps up to the system's limit, the sysctl net.core.rmem_max. Sending never waits and never
fails: an unreachable peer today may be there tomorrow, so errors only count as drops.
"""

from __future__ import annotations

import asyncio
import ipaddress
import socket
import struct
import sys
from abc import abstractmethod
from contextlib import suppress
from time import time
from typing import TYPE_CHECKING

from mavstack.links.address import Address, format_address, resolve
from mavstack.links.base import Link
from mavstack.links.channel import Channel, Data
from mavstack.links.explain import explain

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.links.options import Options
    from mavstack.links.url import LinkURL

SOCKET_BUFFER = 4 << 20
_BATCH = 256  # datagrams read before the event loop gets its turn again
_LARGEST = 1 << 16
_SO_MEMINFO = 55  # Linux; the ninth number it gives counts what the socket's buffer had no room for


class UdpChannel(Channel):
    """One remote address."""

    def __init__(
        self, name: str, address: Address, gone: Callable[[Channel, str], None], link: UdpLink
    ) -> None:
        super().__init__(name, format_address(address), gone)
        self.address = address
        self.heard = time()
        self._link = link

    def _send(self, data: Data) -> bool:
        return self._link.send_to(data, self.address)

    def _shut(self) -> None:
        self._link.forget(self)


class UdpLink(Link):
    """What both directions share: one socket, read in batches."""

    def __init__(self, url: LinkURL, options: Options) -> None:
        super().__init__(url, options)
        self._buffer = options.size("socket_buffer", SOCKET_BUFFER)
        self._socket: socket.socket | None = None
        self._transport: asyncio.DatagramTransport | None = None

    @property
    def address(self) -> tuple[str, int] | None:
        """The host and port that the socket is bound to."""
        return self._socket.getsockname()[:2] if self._socket else None

    @property
    def kernel_drops(self) -> int | None:
        """The datagrams that came while the socket's buffer was full; None if the system does not tell."""
        if self._socket is None or sys.platform != "linux":
            return None
        try:
            return int(
                struct.unpack_from("9I", self._socket.getsockopt(socket.SOL_SOCKET, _SO_MEMINFO, 64))[8]
            )
        except (OSError, struct.error):
            return None

    def send_to(self, data: Data, address: Address) -> bool:
        """Send one datagram now; False if the kernel or the network does not take it."""
        if self._transport is not None:
            queued = self._transport.get_write_buffer_size()  # type: ignore[attr-defined]
            if queued + len(data) > self._send_queue:
                return False
            self._transport.sendto(data, address)
            return True
        try:
            return self._socket is not None and self._socket.sendto(data, address) >= 0
        except OSError:
            return False

    def receive(self, data: bytes, address: Address) -> None:
        """Take one datagram."""
        self._datagram(data, address, time())

    @abstractmethod
    def forget(self, channel: UdpChannel) -> None:
        """Let go of a closed channel."""

    @abstractmethod
    def _datagram(self, data: bytes, address: Address, now: float) -> None:
        """Give one datagram to its channel."""

    def _make_socket(self, family: int) -> socket.socket:
        self._socket = sock = socket.socket(family, socket.SOCK_DGRAM)
        sock.setblocking(False)
        for option in (socket.SO_RCVBUF, socket.SO_SNDBUF):
            with suppress(
                OSError
            ):  # some systems refuse what is over their limit instead of giving the limit
                sock.setsockopt(socket.SOL_SOCKET, option, self._buffer)
        return sock

    async def _watch(self, sock: socket.socket) -> None:
        """Read in batches, or by a transport where the event loop watches no sockets (Windows)."""
        loop = asyncio.get_running_loop()
        try:
            loop.add_reader(sock, self._readable, sock)
        except NotImplementedError:
            self._transport, _ = await loop.create_datagram_endpoint(lambda: _Protocol(self), sock=sock)

    def _readable(self, sock: socket.socket) -> None:
        receive, datagram = sock.recvfrom, self._datagram
        for _ in range(_BATCH):
            try:
                data, address = receive(_LARGEST)
            except (BlockingIOError, InterruptedError):
                return
            except OSError:  # an ICMP error about something sent earlier; the next datagram may be fine
                continue
            datagram(data, address, time())

    async def _stop(self) -> None:
        """Read no more."""
        if self._socket is not None and self._transport is None:
            with suppress(NotImplementedError):
                asyncio.get_running_loop().remove_reader(self._socket)

    async def _release(self) -> None:
        if self._transport is not None:
            self._transport.close()
        elif self._socket is not None:
            self._socket.close()
        self._socket = self._transport = None


class UdpListener(UdpLink):
    """`udpin`: everyone who sends is a channel."""

    def __init__(self, url: LinkURL, options: Options) -> None:
        super().__init__(url, options)
        self._max_peers = options.whole("max_peers", 256)
        self._idle = options.seconds("idle", 60.0)
        self._peers: dict[Address, UdpChannel] = {}

    async def _open(self) -> None:
        try:
            family, address = await _resolve_one(self.url)
            sock = self._make_socket(family)
            self._bind(sock, address)
        except OSError as error:
            raise explain(self.url, error) from error
        await self._watch(sock)
        if self._idle:
            self._spawn(self._close_idle())

    def _bind(self, sock: socket.socket, address: Address) -> None:
        group = _ip(address)
        if sys.platform == "win32":
            sock.setsockopt(socket.SOL_SOCKET, socket.SO_EXCLUSIVEADDRUSE, 1)
        if group.version != 4 or not group.is_multicast:
            sock.bind(address)
            return
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)  # a group is there to be shared
        sock.bind(("", address[1]) if sys.platform == "win32" else address)
        sock.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, group.packed + bytes(4))

    def _datagram(self, data: bytes, address: Address, now: float) -> None:
        channel = self._peers.get(address) or self._admit(address)
        if channel is not None:
            channel.heard = now
            self._inbox.deliver(channel, data, now)

    def _admit(self, address: Address) -> UdpChannel | None:
        if len(self._peers) >= self._max_peers or self._inbox.full or self._closed:
            self._inbox.past.dropped_in += 1
            return None
        channel = UdpChannel(f"udpin {format_address(address)}", address, self._inbox.closed, self)
        self._peers[address] = channel
        self._inbox.opened(channel)
        return channel

    def forget(self, channel: UdpChannel) -> None:
        """A closed peer that sends again is a new channel."""
        del self._peers[channel.address]

    async def _close_idle(self) -> None:
        while True:
            await asyncio.sleep(self._idle / 4)
            oldest = time() - self._idle
            for channel in [peer for peer in self._peers.values() if peer.heard < oldest]:
                channel.close(f"silent for {self._idle:g} s")


class UdpSender(UdpLink):
    """`udpout`: one peer, told from the start."""

    def __init__(self, url: LinkURL, options: Options) -> None:
        super().__init__(url, options)
        self._channel: UdpChannel | None = None
        self._anyone = False

    async def _open(self) -> None:
        try:
            family, address = await _resolve_one(self.url)
            sock = self._make_socket(family)
            self._anyone = self._reaches_many(sock, address)
            sock.bind(("::" if family == socket.AF_INET6 else "0.0.0.0", 0))  # noqa: S104
        except OSError as error:
            raise explain(self.url, error) from error
        await self._watch(sock)
        self._channel = UdpChannel(f"udpout {format_address(address)}", address, self._inbox.closed, self)
        self._inbox.opened(self._channel)

    def _reaches_many(self, sock: socket.socket, address: Address) -> bool:
        """Whether the address is a multicast group or, as far as it shows, a broadcast address."""
        target = _ip(address)
        if target.version == 4 and target.packed[3] == 255:
            sock.setsockopt(socket.SOL_SOCKET, socket.SO_BROADCAST, 1)
            return True
        return target.is_multicast

    def _datagram(self, data: bytes, address: Address, now: float) -> None:
        channel = self._channel
        if channel is not None and (self._anyone or address[0] == channel.address[0]):
            self._inbox.deliver(channel, data, now)
        else:
            self._inbox.past.dropped_in += 1

    def forget(self, channel: UdpChannel) -> None:
        """Nothing more can come: the link ends with its only channel."""
        self._channel = None
        asyncio.get_running_loop().call_soon(self._inbox.end)


class _Protocol(asyncio.DatagramProtocol):
    """The way for event loops that watch no sockets."""

    def __init__(self, link: UdpLink) -> None:
        self._link = link

    def datagram_received(self, data: bytes, addr: Address) -> None:
        self._link.receive(data, addr)


async def _resolve_one(url: LinkURL) -> tuple[int, Address]:
    """The host's address, IPv4 if it has both: `localhost` must be where 0.0.0.0 listens."""
    found = await resolve(url.host, url.port, socket.SOCK_DGRAM)
    return min(found, key=lambda entry: entry[0] != socket.AF_INET)


def _ip(address: Address) -> ipaddress.IPv4Address | ipaddress.IPv6Address:
    return ipaddress.ip_address(address[0].partition("%")[0])
