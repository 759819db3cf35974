"""The flows of a capture: one direction of a UDP or TCP connection each, with a parser of its own.

TCP segments are put into order, and data that was sent again is left out. If the capture misses a segment,
the parser continues after the gap.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final, NamedTuple

from mavstack.logs.packets.pcap.datagrams import address_text
from mavstack.wire import Parser

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from mavstack.dialects import Dialect
    from mavstack.logs.packets.pcap.datagrams import Segment
    from mavstack.wire import Packet

#: Maximum number of bytes and segments that wait for a missing segment; with more, the segment is not in the
#: capture.
_MAX_WAITING_BYTES: Final = 1 << 20
_MAX_WAITING_SEGMENTS: Final = 256
_SEQUENCE_MASK, _SEQUENCE_HALF = 0xFFFF_FFFF, 1 << 31


class FlowKey(NamedTuple):
    """The direction of a connection.

    Attributes:
        protocol: "udp" or "tcp".
        source: Address and port of the sender.
        target: Address and port of the receiver.
    """

    protocol: str
    source: tuple[bytes, int]
    target: tuple[bytes, int]

    def __str__(self) -> str:
        return f"{self.protocol} {address_text(self.source)} → {address_text(self.target)}"


@dataclass(slots=True)
class Flow:
    """A flow.

    Attributes:
        parser: The parser of its data.
        known_packets: Number of packets whose id is in the dialect; a flow without any is of another
        protocol. payload_bytes: Bytes of data. lost_bytes: Bytes of TCP data that the capture does not hold.
    """

    parser: Parser
    known_packets: int = 0
    payload_bytes: int = 0
    lost_bytes: int = 0
    _time: int = 0
    _next: int | None = None
    _waiting: dict[int, tuple[int, bytes]] = field(default_factory=dict)

    def receive(self, segment: Segment, time: int) -> Iterator[tuple[int, Packet]]:
        """Yield the packets that a segment completes, each with the time at which its last byte was captured.

        Args:
            segment: The segment.
            time: Time of its frame in microseconds since 1970.
        """
        pieces = [(time, segment.payload)] if segment.protocol == "udp" else self._order(segment, time)
        yield from self._parse(pieces)

    def finish(self) -> Iterator[tuple[int, Packet]]:
        """Yield the packets after the last gap, and those at the end of the flow."""
        yield from self._parse(self._skip_gaps())
        yield from self._counted(self._time, self.parser.flush())

    def _parse(self, pieces: Iterable[tuple[int, bytes]]) -> Iterator[tuple[int, Packet]]:
        for time, piece in pieces:
            self._time = time
            self.payload_bytes += len(piece)
            yield from self._counted(time, self.parser.feed(piece))

    def _counted(self, time: int, packets: list[Packet]) -> Iterator[tuple[int, Packet]]:
        for packet in packets:
            self.known_packets += packet.name is not None
            yield time, packet

    def _order(self, segment: Segment, time: int) -> Iterator[tuple[int, bytes]]:
        if segment.starts:
            yield from self._skip_gaps()
            self._next = segment.sequence
        if not segment.payload:
            return
        if self._next is None:
            self._next = segment.sequence
        _, known = self._waiting.get(segment.sequence, (0, b""))
        if len(segment.payload) > len(known):
            self._waiting[segment.sequence] = time, segment.payload
        yield from self._take_ready()
        size = sum(len(data) for _, data in self._waiting.values())
        if size > _MAX_WAITING_BYTES or len(self._waiting) > _MAX_WAITING_SEGMENTS:
            yield from self._skip_gaps()

    def _take_ready(self) -> Iterator[tuple[int, bytes]]:
        """Take the waiting segments that continue the data, and drop those that repeat it."""
        while self._waiting and self._next is not None:
            sequence = min(self._waiting, key=self._distance)
            distance = self._distance(sequence)
            if distance > 0:
                return
            time, payload = self._waiting.pop(sequence)
            data = payload[-distance:]
            self._next = self._next + len(data) & _SEQUENCE_MASK
            if data:
                self._time = max(self._time, time)
                yield self._time, data

    def _distance(self, sequence: int) -> int:
        """Return the signed distance of a sequence number from the next one."""
        distance = sequence - (self._next or 0) & _SEQUENCE_MASK
        return distance - 2 * _SEQUENCE_HALF if distance >= _SEQUENCE_HALF else distance

    def _skip_gaps(self) -> Iterator[tuple[int, bytes]]:
        while self._waiting:
            sequence = min(self._waiting, key=self._distance)
            self.lost_bytes += max(self._distance(sequence), 0)
            self._next = sequence
            yield from self._take_ready()


class Flows:
    """All flows of a capture.

    Args:
        dialect: The dialect of the packets.
    """

    def __init__(self, dialect: Dialect) -> None:
        self._dialect = dialect
        self.by_key: dict[FlowKey, Flow] = {}

    def receive(self, segment: Segment, time: int) -> Iterator[tuple[FlowKey, int, Packet]]:
        """Yield the packets that a segment completes, with their flow and time; see `Flow.receive`."""
        key = FlowKey(segment.protocol, segment.source, segment.target)
        flow = self.by_key.get(key)
        if flow is None:
            flow = self.by_key[key] = Flow(Parser(self._dialect))
        yield from ((key, *found) for found in flow.receive(segment, time))

    def finish(self) -> Iterator[tuple[FlowKey, int, Packet]]:
        """Yield the packets at the end of each flow."""
        for key, flow in self.by_key.items():
            yield from ((key, *found) for found in flow.finish())
