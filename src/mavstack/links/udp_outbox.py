"""The datagrams that wait to be sent on the socket of a UDP link.

Datagrams that are written while the outbox is held leave together, in order, by one system call for each
64 of them. If the system accepts no more, the rest waits until it does, up to `send_queue` bytes of each
channel; a datagram that the system refuses for another reason is dropped and counted.
"""

from __future__ import annotations

import asyncio
from collections import Counter
from typing import TYPE_CHECKING, Final, TypeAlias

from mavstack._core import DatagramSender
from mavstack.links.address import Address

if TYPE_CHECKING:
    import socket

    from mavstack.links.channel import Data
    from mavstack.links.inbox import Inbox
    from mavstack.links.udp_channel import UdpChannel

#: Seconds between two attempts while the outbox closes.
CLOSE_INTERVAL: Final = 0.01
#: Maximum number of datagrams sent together: the core sends as many by one system call.
MAX_BATCH: Final = 64

Datagram: TypeAlias = tuple[bytes, Address]


class UdpOutbox:
    """The waiting datagrams of one socket.

    Args:
        sock: The socket; the event loop can watch it.
        limit: Maximum number of bytes that wait for one channel while the system accepts none.
        inbox: The inbox of the link, which keeps the counters of closed channels.
    """

    def __init__(self, sock: socket.socket, limit: int, inbox: Inbox) -> None:
        self._socket = sock
        self._limit = limit
        self._inbox = inbox
        self._sender: DatagramSender | None = None
        self._loop = asyncio.get_running_loop()
        self._is_held = False
        self._waiting: list[Datagram] = []
        self._channels: list[UdpChannel] = []
        #: Waiting bytes of each channel while the system accepts none; None: it accepts more.
        self._blocked: Counter[UdpChannel] | None = None

    def send(self, data: Data, channel: UdpChannel) -> bool:
        """Send a datagram to a channel's peer, or let it wait; return false if it is dropped."""
        if not self._is_held and self._blocked is None:
            count, is_full = self._send_one(data, channel.address)
            if not is_full:
                return count > 0
            self._note_blocked(is_blocked=True)
        if self._blocked is not None:
            if self._blocked[channel] + len(data) > self._limit:
                return False
            self._blocked[channel] += len(data)
        self._waiting.append((bytes(data), channel.address))
        self._channels.append(channel)
        return True

    def hold(self) -> None:
        """Let datagrams wait until `release`."""
        self._is_held = True

    def release(self) -> None:
        """Send the waiting datagrams."""
        self._is_held = False
        if self._waiting and self._blocked is None:
            self._flush()

    def _flush(self) -> None:
        """Send what waits, as far as the system accepts it."""
        done, is_full = 0, False
        while done < len(self._waiting) and not is_full:
            batch = self._waiting[done : done + MAX_BATCH]
            count, is_full = self._send_batch(batch)
            done += count
            if count < len(batch) and not is_full:
                self._drop(self._channels[done], len(batch[count][0]))
                done += 1
        del self._waiting[:done], self._channels[:done]
        self._note_blocked(is_blocked=is_full)

    def _send_batch(self, datagrams: list[Datagram]) -> tuple[int, bool]:
        """Send datagrams until one is refused; return their number, and whether the system is full."""
        if self._sender is None:
            try:
                self._sender = DatagramSender(self._socket.fileno())
            except OSError:  # the system has no descriptor left
                return self._send_one(*datagrams[0])
        return self._sender.send(datagrams)

    def _send_one(self, data: Data, address: Address) -> tuple[int, bool]:
        """Send a datagram, as `_send_batch` does."""
        try:
            self._socket.sendto(data, address)
        except BlockingIOError:
            return 0, True
        except OSError:
            return 0, False
        return 1, False

    def _drop(self, channel: UdpChannel, size: int) -> None:
        """Count a datagram as dropped that was counted as sent."""
        counters = self._inbox.closed_counters if channel.closed else channel.counters
        counters.bytes_out -= size
        counters.chunks_out -= 1
        counters.dropped_out += 1

    def _note_blocked(self, *, is_blocked: bool) -> None:
        if is_blocked and self._blocked is None:
            self._loop.add_writer(self._socket, self._flush)
        elif not is_blocked and self._blocked is not None:
            self._loop.remove_writer(self._socket)
        self._blocked = self._count_waiting() if is_blocked else None

    def _count_waiting(self) -> Counter[UdpChannel]:
        counts: Counter[UdpChannel] = Counter()
        for (data, _), channel in zip(self._waiting, self._channels, strict=True):
            counts[channel] += len(data)
        return counts

    async def close(self, timeout: float) -> None:  # noqa: ASYNC109 (how long datagrams may still leave)
        """Send what waits for up to a time, and close the socket; what is left is dropped and counted."""
        end = self._loop.time() + timeout
        try:
            while self._waiting and self._loop.time() < end:  # noqa: ASYNC110 (rare, and bounded)
                await asyncio.sleep(CLOSE_INTERVAL)  # the event loop watches the socket
        finally:
            self._close()

    def _close(self) -> None:
        for (data, _), channel in zip(self._waiting, self._channels, strict=True):
            self._drop(channel, len(data))
        self._waiting.clear()
        self._channels.clear()
        self._note_blocked(is_blocked=False)
        self._sender = None  # closes its descriptor
        self._socket.close()
