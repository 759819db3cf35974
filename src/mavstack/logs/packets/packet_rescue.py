"""Rescue of logs of packets: packets whose CRC is right, byte for byte with their times.

A packet whose time is damaged gets the time of the packet before it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack._core import looks_timestamped
from mavstack.logs.damage import LogDamage
from mavstack.logs.registry import MAX_HEAD
from mavstack.logs.rescue import Rescue
from mavstack.wire import Parser

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from mavstack.dialects import Dialect
    from mavstack.logs.log_bytes import LogBytes
    from mavstack.wire import Packet

_CHUNK: Final = 1 << 20
_TIMESTAMP: Final = 8


class PacketRescue(Rescue):
    """Finds the packets of a tlog or raw stream.

    Args:
        data: The bytes of the file.
        dialect: The dialect of the packets.
        timestamped: True for a tlog, False for a raw stream; None detects it from the content.
    """

    def __init__(self, data: LogBytes, dialect: Dialect, timestamped: bool | None = None) -> None:
        super().__init__(data)
        if timestamped is None:
            timestamped = looks_timestamped(data.read(0, MAX_HEAD), dialect)
        self._timestamped = timestamped
        self._parser = Parser(dialect, timestamped=timestamped)
        self._time: int | None = None

    def pieces(self, progress: Callable[[int, int], None]) -> Iterator[bytes]:
        """Yield the packets; see `Rescue.pieces`."""
        for start in range(0, self.data.size, _CHUNK):
            yield self._content(self._parser.feed(self.data.read(start, _CHUNK)))
            progress(min(start + _CHUNK, self.data.size), self.data.size)
        yield self._content(self._parser.flush())
        totals = self._parser.statistics
        damaged = totals.bad_checksum + totals.bad_flags + totals.bad_length if totals.bad_bytes else 0
        self.damage = LogDamage(bad_bytes=totals.bad_bytes, bad_records=damaged)

    def _content(self, packets: Sequence[Packet]) -> bytes:
        self.records += len(packets)
        if not self._timestamped:
            return b"".join(packet.raw for packet in packets)
        if self._time is None:
            self._time = next((packet.timestamp for packet in packets if packet.timestamp is not None), None)
        return b"".join(map(self._stamped, packets))

    def _stamped(self, packet: Packet) -> bytes:
        if packet.timestamp is not None:
            self._time = packet.timestamp
        return (self._time or 0).to_bytes(_TIMESTAMP, "big") + packet.raw
