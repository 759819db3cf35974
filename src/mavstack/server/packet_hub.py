"""The hub that hands the received packets to the clients of WebSockets.

A packet after a pause is handed on at once. Those that follow closely are collected for a moment and handed
on as one batch, whose bytes are joined once for all clients, so that many clients cost little more than one.
The moment is longer for more clients, each of which costs a message per batch.
"""

from __future__ import annotations

import asyncio
from functools import cached_property
from typing import TYPE_CHECKING, Final, Protocol

from mavstack.security import carries_signing_key
from mavstack.server.latest_messages import LatestMessages
from mavstack.server.message_json import packet_json

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.node.dispatch import Listener
    from mavstack.vehicle import Connection
    from mavstack.wire import Packet

#: Minimum and maximum seconds between batches, and seconds that each client adds.
MIN_INTERVAL: Final = 0.001
MAX_INTERVAL: Final = 0.02
CLIENT_INTERVAL: Final = 0.001


class Batch:
    """Packets that were received together, with their times of receipt."""

    def __init__(self, packets: Sequence[tuple[Packet, float]]) -> None:
        self.packets = packets
        self._texts: dict[int, str] = {}

    @cached_property
    def data(self) -> bytes:
        """The bytes of all packets."""
        return b"".join([packet.raw for packet, _ in self.packets])

    def text(self, index: int) -> str:
        """Return one packet as JSON, which is made once for all clients."""
        text = self._texts.get(index)
        if text is None:
            text = self._texts[index] = packet_json(*self.packets[index])
        return text


class BatchClient(Protocol):
    """A client that is handed batches; it must not block."""

    def put(self, batch: Batch) -> None:
        """Send or queue a batch, or drop it and count its packets."""


class PacketHub:
    """The packets of a connection: the latest ones, and batches for clients."""

    def __init__(self, connection: Connection) -> None:
        self.latest = LatestMessages()
        self.clients: set[BatchClient] = set()
        #: Packets received since the station was opened.
        self.received = 0
        self._connection = connection
        self._listener: Listener | None = None
        self._pending: list[tuple[Packet, float]] = []
        self._timer: asyncio.TimerHandle | None = None
        #: The time of the last batch, by the clock of the event loop.
        self._flushed_at = 0.0

    def open(self) -> None:
        """Receive the packets of the connection."""
        self._listener = self._connection.add_packet_listener(None, self._receive)

    def close(self) -> None:
        """Receive no more packets."""
        if self._listener is not None:
            self._listener.close()
        if self._timer is not None:
            self._timer.cancel()

    def _receive(self, packet: Packet) -> None:
        now = self._connection.now()
        self.received += 1
        self.latest.store(packet, now)
        if not self.clients or carries_signing_key(packet):
            return
        self._pending.append((packet, now))
        if self._timer is None:
            loop = asyncio.get_running_loop()
            interval = min(max(len(self.clients) * CLIENT_INTERVAL, MIN_INTERVAL), MAX_INTERVAL)
            due = self._flushed_at + interval
            if due <= loop.time():
                self._flush()
            else:
                self._timer = loop.call_at(due, self._flush)

    def _flush(self) -> None:
        self._timer, self._flushed_at = None, asyncio.get_running_loop().time()
        batch, self._pending = Batch(self._pending), []
        for client in tuple(self.clients):
            client.put(batch)
