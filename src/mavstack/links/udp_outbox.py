"""The datagrams that wait to be sent on the socket of a UDP link.

Datagrams that are written while the outbox is held leave together, in order, by one system call for each
64 of them. If the system accepts no more, the rest waits until it does, up to `send_queue` bytes of each
channel; a datagram that the system refuses for another reason is dropped and counted.
"""

from __future__ import annotations

import asyncio
from collections import Counter
from typing import TYPE_CHECKING, Final

from mavstack._core import DatagramSender

if TYPE_CHECKING:
    import socket

    from mavstack.links.channel import Data
    from mavstack.links.inbox import Inbox
    from mavstack.links.udp_channel import UdpChannel

#: Seconds between two attempts while the outbox closes.
CLOSE_INTERVAL: Final = 0.01


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
        self._waiting: list[tuple[bytes, tuple[object, ...]]] = []
        self._channels: list[UdpChannel] = []
        #: Waiting bytes of each channel while the system accepts none; None: it accepts more.
        self._blocked: Counter[UdpChannel] | None = None

    def send(self, data: Data, channel: UdpChannel) -> bool:
        """Send a datagram to a channel's peer, or let it wait; return false if it is dropped."""
        if not self._is_held and self._blocked is None:
            try:
                return self._socket.sendto(data, channel.address) >= 0
            except BlockingIOError:
                self._note_blocked(is_blocked=True)
            except OSError:
                return False
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
        if self._sender is None:
            self._sender = DatagramSender(self._socket.fileno())
        is_full = False
        while self._waiting and not is_full:
            count, is_full = self._sender.send(self._waiting)
            if count < len(self._waiting) and not is_full:
                self._drop(self._channels[count], len(self._waiting[count][0]))
                count += 1
            del self._waiting[:count], self._channels[:count]
        self._note_blocked(is_blocked=is_full)

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
        while self._waiting and self._loop.time() < end:  # noqa: ASYNC110 (rare, and bounded)
            await asyncio.sleep(CLOSE_INTERVAL)  # the event loop watches the socket
        for (data, _), channel in zip(self._waiting, self._channels, strict=True):
            self._drop(channel, len(data))
        self._waiting.clear()
        self._channels.clear()
        self._note_blocked(is_blocked=False)
        self._sender = None  # closes its descriptor
        self._socket.close()
