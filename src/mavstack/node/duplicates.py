"""Duplicate packets, as redundant links and routers cause them: the second copy is dropped.

A duplicate has the same bytes, arrives within `WINDOW` seconds, and on another channel. The same bytes on the
same channel are no duplicate: sequence numbers repeat after 256 packets, so equal messages may be equal
packets.
"""

from __future__ import annotations

from collections import OrderedDict
from typing import TYPE_CHECKING, Generic, TypeVar

if TYPE_CHECKING:
    from mavstack.wire import Packet

Channel = TypeVar("Channel")

#: Seconds within which the same packet on another channel is a duplicate.
WINDOW = 1.0
MAX_PACKETS = 1024


class Duplicates(Generic[Channel]):
    """The packets of the last second from sources that are heard on several channels."""

    def __init__(self) -> None:
        self.dropped = 0
        self._seen: OrderedDict[bytes, tuple[Channel, float]] = OrderedDict()

    def is_copy(self, packet: Packet, channel: Channel, now: float) -> bool:
        """Return whether the packet was received on another channel before; record it if not."""
        self._expire(now)
        raw = packet.raw
        before = self._seen.get(raw)
        if before is not None and before[0] is not channel:
            self.dropped += 1
            return True
        self._seen[raw] = (channel, now)
        self._seen.move_to_end(raw)
        return False

    def _expire(self, now: float) -> None:
        while self._seen:
            raw, (_, seen) = next(iter(self._seen.items()))
            if now - seen < WINDOW and len(self._seen) < MAX_PACKETS:
                return
            del self._seen[raw]
