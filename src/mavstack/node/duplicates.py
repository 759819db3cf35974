"""Drops the second copy of a packet that came over two channels, as redundant links and routers make them.

A copy is byte for byte the same, of the same source, within `WINDOW` seconds, on another channel. The same
bytes on the same channel are not a copy: after 256 packets the same message may rightly look the same.
"""

from __future__ import annotations

from collections import OrderedDict
from typing import TYPE_CHECKING, Generic, TypeVar

if TYPE_CHECKING:
    from mavstack.wire import Packet

Channel = TypeVar("Channel")

WINDOW = 1.0
MOST_REMEMBERED = 1024


class Duplicates(Generic[Channel]):
    """The packets of the last second, of sources that are heard on several channels."""

    def __init__(self) -> None:
        self.dropped = 0
        self._seen: OrderedDict[bytes, tuple[Channel, float]] = OrderedDict()

    def is_copy(self, packet: Packet, channel: Channel, now: float) -> bool:
        """Whether the packet came before on another channel; remembers it if not."""
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
            if now - seen < WINDOW and len(self._seen) < MOST_REMEMBERED:
                return
            del self._seen[raw]
