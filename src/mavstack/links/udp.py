"""UDP links: `udpin://host:port` listens, `udpout://host:port` sends to one peer.

With udpin each remote address is a channel, up to `max_peers` (see `admission`); a channel that is silent
for `idle` seconds is closed. With `trust_senders=no`, the default of a router, a new peer gets no more than
three times what it sent until it answers, since its address may be invented (see `probation`). A multicast
group as the host is joined. With udpout there is one channel, open from the start: it receives datagrams
from any port of the peer, and from any sender if that is a group's address.

Each datagram becomes one event, or, for a reader that parses streams (`Link.joins_datagrams`), those of one
sender that wait together become one. If many wait, they are first read into a `backlog`, which is fair to all
senders, so that a flood from one of them does not lose the packets of the others; if even reading them takes
too long, a `flood_filter` in the kernel thins out the senders that send most. Datagrams that have no room are
dropped and counted. `kernel_drops` counts datagrams that the kernel dropped before that, where the system
reports it (Linux): a larger `socket_buffer` helps, up to the system's limit (sysctl net.core.rmem_max; a
process with CAP_NET_ADMIN may exceed it). A link to a loopback address is reachable from this machine only.
Sending never blocks and never raises: an unreachable peer may become reachable later, so errors only count as
drops. While the kernel accepts no more, datagrams wait (see `udp_outbox`).
"""

from __future__ import annotations

import asyncio
import socket
import struct
import sys
from abc import abstractmethod
from contextlib import suppress
from time import monotonic, time
from typing import TYPE_CHECKING

from mavstack.links.address import Address, format_address, is_multicast, packed_ip, resolve_datagram
from mavstack.links.admission import PeerAdmission
from mavstack.links.backlog import Backlog
from mavstack.links.base import Link
from mavstack.links.flood_filter import ADJUST_INTERVAL, FloodFilter
from mavstack.links.joined_datagrams import join_datagrams
from mavstack.links.native_reading import NativeReading
from mavstack.links.os_errors import open_error
from mavstack.links.probation import Probation
from mavstack.links.udp_channel import UdpChannel
from mavstack.links.udp_outbox import UdpOutbox
from mavstack.links.udp_transport import TransportOutbox
from mavstack.security.admission import Proof

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack._core import Intake
    from mavstack.links.backlog import Datagram
    from mavstack.links.channel import Data
    from mavstack.links.options import Options
    from mavstack.links.url import LinkURL

DEFAULT_SOCKET_BUFFER = 4 << 20
MAX_DIRECT = 64  # datagrams handled per wake-up of the event loop; if more wait, the backlog is used
MAX_BATCH = 1024  # maximum number of datagrams read into the backlog at a time
CLOSE_TIMEOUT = 1.0  # seconds for which closing a link waits until the system accepts waiting datagrams
BACKLOG_TIME = 0.004  # seconds for which the backlog is handled until the kernel's queue is emptied again
CLOCK_INTERVAL = 8  # datagrams handled between two readings of the clock
MAX_DATAGRAM = 1 << 16
_SO_RCVBUFFORCE = 33  # number of the socket option on Linux
_SO_MEMINFO = 55  # Linux; its ninth number counts the datagrams dropped because the socket buffer was full


class UdpLink(Link):
    """Base of UDP links: one socket, read in batches."""

    def __init__(self, url: LinkURL, options: Options) -> None:
        super().__init__(url, options)
        self._buffer = options.size("socket_buffer", DEFAULT_SOCKET_BUFFER)
        self._socket: socket.socket | None = None
        self._backlog = Backlog()
        self._filter: FloodFilter | None = None
        self._known_drops = 0
        self._filter_timer: asyncio.TimerHandle | None = None
        self._native: NativeReading | None = None
        self._outbox: UdpOutbox | TransportOutbox | None = None

    @property
    def address(self) -> tuple[str, int] | None:
        """Host and port to which the socket is bound, or None before the link is open."""
        return self._socket.getsockname()[:2] if self._socket else None

    @property
    def kernel_drops(self) -> int | None:
        """Number of datagrams dropped by the kernel because the socket buffer was full; None if unknown."""
        if self._socket is None or sys.platform != "linux":
            return None
        with suppress(OSError, struct.error):
            info = self._socket.getsockopt(socket.SOL_SOCKET, _SO_MEMINFO, 64)
            return int(struct.unpack_from("9I", info)[8])
        return None

    def send_to(self, data: Data, channel: UdpChannel) -> bool:
        """Send one datagram, or let it wait; return false if it is dropped."""
        return self._outbox is not None and self._outbox.send(data, channel)

    def hold(self) -> None:
        """Let datagrams that are written wait until `release`, which sends them together."""
        if isinstance(self._outbox, UdpOutbox):
            self._outbox.hold()

    def release(self) -> None:
        """Send the datagrams that were written since `hold`."""
        if isinstance(self._outbox, UdpOutbox):
            self._outbox.release()

    def receive(self, data: bytes, address: Address, count: int = 1) -> None:
        """Receive a datagram, or `count` joined ones, from another reader of the socket."""
        self._datagram(data, address, time(), count)

    def read_natively(self, intake: Intake, number: int) -> NativeReading | None:
        """Let an intake read the socket; return None if the link goes on to read it."""
        is_watched = isinstance(self._outbox, UdpOutbox)
        if self._socket is None or not is_watched or not self._has_plain_peers():
            return None
        self._native = NativeReading(self, intake, number)
        self._native.start()
        return self._native

    def pass_socket(self) -> int | None:
        """Stop reading; return the descriptor of the socket, or None if it is closed."""
        if self._socket is None or self._closed:
            return None
        asyncio.get_running_loop().remove_reader(self._socket)
        return self._socket.fileno()

    def watch_socket(self, watcher: Callable[[], None] | None) -> None:
        """Call a function if a socket that another reader reads has something; None: do so no more."""
        if self._socket is not None and not self._closed:
            loop = asyncio.get_running_loop()
            if watcher is None:
                loop.remove_reader(self._socket)
            else:
                loop.add_reader(self._socket, watcher)

    def read_itself(self) -> None:
        """Read the socket by the event loop again."""
        if self._socket is not None and not self._closed:
            asyncio.get_running_loop().add_reader(self._socket, self._readable, self._socket)

    @abstractmethod
    def sender_of(self, channel: UdpChannel) -> Address | None:
        """Return the address that datagrams of a channel have, port 0 for any; None: they need a look."""

    @abstractmethod
    def _has_plain_peers(self) -> bool:
        """Return whether the senders of datagrams are known by their addresses."""

    @abstractmethod
    def remove_channel(self, channel: UdpChannel) -> None:
        """Remove a closed channel."""

    @abstractmethod
    def _datagram(self, data: bytes, address: Address, now: float, count: int = 1) -> None:
        """Pass a datagram, or `count` joined datagrams, to the channel of the sender."""

    @abstractmethod
    def _knows(self, address: Address) -> bool:
        """Return whether valid packets came from an address."""

    def _make_socket(self, family: int) -> socket.socket:
        self._socket = sock = socket.socket(family, socket.SOCK_DGRAM)
        sock.setblocking(False)
        for option in (socket.SO_RCVBUF, socket.SO_SNDBUF):
            with suppress(OSError):  # some systems raise for a size above their limit
                sock.setsockopt(socket.SOL_SOCKET, option, self._buffer)
        if sys.platform == "linux":
            with suppress(OSError):  # the process may not exceed the system's limit
                sock.setsockopt(socket.SOL_SOCKET, _SO_RCVBUFFORCE, self._buffer)
        return sock

    async def _start_reading(self, sock: socket.socket) -> None:
        """Read in batches, or by a transport if the event loop has no socket readers (Windows)."""
        loop = asyncio.get_running_loop()
        try:
            loop.add_reader(sock, self._readable, sock)
            self._outbox = UdpOutbox(sock, self._send_queue, self.inbox)
        except NotImplementedError:
            self._outbox = TransportOutbox(self._send_queue, self.receive)
            await self._outbox.open(sock)

    def _readable(self, sock: socket.socket) -> None:
        if self._backlog:  # a callback for the next part of the backlog is scheduled already
            if self._native is not None and self._native.is_due:
                self.pass_socket()  # the thread reads it when the backlog was handled
            else:
                self._fill_backlog(sock)
            return
        emptied = self._read_joined(sock) if self.joins_datagrams else self._read_singly(sock)
        if not emptied:
            self._fill_backlog(sock)
            self._handle_backlog()
        elif self._native is not None:
            self._native.handled()

    def _read_singly(self, sock: socket.socket) -> bool:
        """Pass on datagrams one by one, each before the next is read; return whether all were read."""
        receive, datagram = sock.recvfrom, self._datagram
        for _ in range(MAX_DIRECT):
            try:
                data, address = receive(MAX_DATAGRAM)
            except (BlockingIOError, InterruptedError):
                return True
            except OSError:  # reports an ICMP error about a datagram that was sent earlier
                continue
            datagram(data, address, time())
        return False

    def _read_joined(self, sock: socket.socket) -> bool:
        """As `_read_singly`, but datagrams of one sender that follow each other are passed on as one."""
        receive, now, emptied = sock.recvfrom, time(), False
        datagrams: list[Datagram] = []
        for _ in range(MAX_DIRECT):
            try:
                datagrams.append((*receive(MAX_DATAGRAM), now))
            except (BlockingIOError, InterruptedError):
                emptied = True
                break
            except OSError:
                pass
        for joined in join_datagrams(datagrams):
            self._datagram(*joined)
        return emptied

    def _fill_backlog(self, sock: socket.socket) -> None:
        """Empty the kernel's queue into the backlog."""
        receive, add, now = sock.recvfrom, self._backlog.add, time()
        senders: list[Address] = []
        emptied = False
        for _ in range(MAX_BATCH):
            try:
                data, address = receive(MAX_DATAGRAM)
            except (BlockingIOError, InterruptedError):
                emptied = True
                break
            except OSError:  # reports an ICMP error, as in `_read_singly`
                continue
            senders.append(address)
            if not add((data, address, now), known=self._knows(address)):
                self.inbox.drop()
        if self._filter is None:
            self._filter = FloodFilter(sock)
        self._filter.observe(senders, emptied=emptied)
        if not emptied and self._filter_timer is None:
            self._known_drops = self.kernel_drops or 0
            self._adjust_later()

    def _adjust_later(self) -> None:
        self._filter_timer = asyncio.get_running_loop().call_later(ADJUST_INTERVAL, self._adjust_filter)

    def _adjust_filter(self) -> None:
        self._filter_timer = None
        if self._filter is None or self._socket is None or self._closed:
            return
        self._filter.adjust(overflowed=(self.kernel_drops or 0) > self._known_drops)
        if self._filter.active:
            self._adjust_later()

    def _handle_backlog(self) -> None:
        """Pass on datagrams of the backlog for a moment; the rest follows in the next round of the loop."""
        backlog, end = self._backlog, monotonic() + BACKLOG_TIME
        try:
            while backlog and not self._closed and monotonic() < end:
                datagrams = (backlog.pop() for _ in range(min(CLOCK_INTERVAL, len(backlog))))
                for each in join_datagrams(datagrams) if self.joins_datagrams else datagrams:
                    self._datagram(*each)
        finally:
            if backlog and not self._closed:
                asyncio.get_running_loop().call_soon(self._handle_backlog)
            elif self._native is not None:
                self._native.handled()

    async def stop_transport(self) -> None:
        """Stop reading."""
        if self._native is not None:
            self._native.stop()
        self._backlog.clear()
        if self._filter_timer is not None:
            self._filter_timer.cancel()
        if self._socket is not None and not isinstance(self._outbox, TransportOutbox):
            with suppress(NotImplementedError):
                asyncio.get_running_loop().remove_reader(self._socket)

    async def release_transport(self) -> None:
        """Release the remaining resources."""
        if self._outbox is not None:
            outbox, self._outbox = self._outbox, None
            await outbox.close(CLOSE_TIMEOUT)
        elif self._socket is not None:
            self._socket.close()
        self._socket = None


class UdpListener(UdpLink):
    """A udpin link: each sender is a channel.

    Attributes:
        max_peers: Maximum number of channels.
        idle: Seconds of silence after which a channel is closed; 0: never.
        trusts_senders: New peers get everything at once, whether they answer or not (see `probation`).
        router_trusts_senders: The same for the socket of a router's endpoint, whose default is no.
    """

    def __init__(self, url: LinkURL, options: Options) -> None:
        super().__init__(url, options)
        self.max_peers = options.integer("max_peers", 256)
        self._admission = PeerAdmission(self.max_peers)
        self.idle = options.seconds("idle", 60.0)
        self.trusts_senders = options.flag("trust_senders", default=True)
        self.router_trusts_senders = options.flag("trust_senders", default=False)
        self._peers: dict[Address, UdpChannel] = {}

    def trust_senders(self) -> None:
        """Send everything to new peers at once; call it before `open`."""
        self.trusts_senders = True

    async def open_socket(self) -> socket.socket:
        """Open the bound socket alone, for a program that reads it itself; `close` closes it.

        Raises:
            LinkError: The socket cannot be opened.
        """
        try:
            family, address = await resolve_datagram(self.url.host, self.url.port)
            sock = self._make_socket(family)
            self._bind(sock, address)
        except OSError as error:
            raise open_error(self.url, error) from error
        return sock

    async def open_transport(self) -> None:
        """Open the transport of the link."""
        await self._start_reading(await self.open_socket())
        if self.idle:
            self.spawn(self._close_idle())

    def _bind(self, sock: socket.socket, address: Address) -> None:
        group = packed_ip(address)
        if sys.platform == "win32":
            sock.setsockopt(socket.SOL_SOCKET, socket.SO_EXCLUSIVEADDRUSE, 1)
        if len(group) != 4 or not is_multicast(group):
            sock.bind(address)
            return
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)  # several programs may join a group
        sock.bind(("", address[1]) if sys.platform == "win32" else address)
        sock.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, group + bytes(4))

    def _datagram(self, data: bytes, address: Address, now: float, count: int = 1) -> None:
        channel = self._peers.get(address) or self._admit(address, data, now)
        if channel is not None:
            channel.last_received = now
            if channel.probation is not None:
                channel.probation.received(data)
                channel.probation = None if channel.probation.is_over else channel.probation
            self.inbox.deliver(channel, data, now, count)
        else:
            self.inbox.drop(count=count)

    def _admit(self, address: Address, data: bytes, now: float) -> UdpChannel | None:
        if self.inbox.full or self._closed:
            return None
        host = format_address(address).rpartition(":")[0]
        if not self._admission.admit(host, self._peers.values(), now, self._proof_of(data)):
            return None
        channel = UdpChannel(f"udpin {format_address(address)}", address, self.inbox.remove_channel, self)
        channel.probation = None if self.trusts_senders else Probation()
        self._peers[address] = channel
        self.inbox.add_channel(channel)
        return channel

    def _proof_of(self, data: bytes) -> Proof:
        """Return what a new peer has proved, if that decides on its admission."""
        is_full = len(self._peers) >= self.max_peers
        is_signed = is_full and self.authenticates is not None and self.authenticates(data)
        return Proof.AUTHENTICATED if is_signed else Proof.SILENT

    def sender_of(self, channel: UdpChannel) -> Address | None:
        """Return the address that datagrams of a channel have."""
        return channel.address if channel.probation is None else None

    def _has_plain_peers(self) -> bool:
        return self.trusts_senders

    def _knows(self, address: Address) -> bool:
        return address in self._peers and self._peers[address].last_valid > 0

    def remove_channel(self, channel: UdpChannel) -> None:
        """Remove a closed channel; the peer gets a new one if it sends again."""
        del self._peers[channel.address]

    async def _close_idle(self) -> None:
        while True:
            await asyncio.sleep(self.idle / 4)
            oldest = time() - self.idle
            for channel in [peer for peer in self._peers.values() if peer.last_received < oldest]:
                channel.close(f"silent for {self.idle:g} s")
