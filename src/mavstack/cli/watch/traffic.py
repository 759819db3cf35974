"""Counts and rates of packets by system, component and message, without clock or output.

`add` is called for every packet of a busy link, so it does four assignments per packet and decodes nothing.

Rates are computed from marks. A mark is the count of a meter at some time; the caller sets marks about once a
second, and the rate is measured from the oldest of the few marks kept. The times are those of the last packet
before each end of that window, not of the marks themselves: a steady 1 Hz then reads 1.0 wherever the window
lies, and the rate of a stream that stops falls from the moment a packet is overdue. Without marks the rate is
the average over all packets. The number of meters is bounded, whatever ids a link sends.
"""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

from mavstack.cli.watch.notices import MAX_NOTICES, is_notice

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.wire import Packet

#: System, component, message id.
Key: TypeAlias = tuple[int, int, int]

MAX_STREAMS = 20_000
_MARKS = 6
#: Number of kept packets: twice the shown notices, since PX4 sends an event and a status text per notice.
_NOTICES = 2 * MAX_NOTICES
#: Ids of STATUSTEXT and EVENT.
_WITH_NOTICES = frozenset({253, 410})


class Rate(NamedTuple):
    """Packets and bytes per second."""

    packets: float = 0.0
    bytes: float = 0.0


class Meter:
    """A count of packets and bytes, and their rate."""

    __slots__ = ("_marks", "bytes", "count", "time")

    def __init__(self, now: float, count: int = 0, size: int = 0) -> None:
        self.count = 0
        self.bytes = 0
        self.time = now
        self._marks = deque([(now, count, size)], maxlen=_MARKS)

    def mark(self) -> None:
        """Set a mark, which moves the window of the rate."""
        self._marks.append((self.time, self.count, self.bytes))

    def rate(self, now: float) -> Rate:
        """Return the rate at the time `now`."""
        since, count, size = self._marks[0]
        packets = self.count - count
        if packets <= 0:
            return Rate()
        span = self.time - since
        overdue = now - self.time
        if overdue > 2 * span / packets:
            span += overdue
        return Rate(packets / span, (self.bytes - size) / span) if span > 0 else Rate()


class Stream(Meter):
    """One message of one component: its meter and its last packet."""

    __slots__ = ("packet",)

    def __init__(self, now: float, packet: Packet) -> None:
        # The rate is counted from the first packet on: the first interval ends with the second packet.
        super().__init__(now, 1, len(packet))
        self.packet = packet


class Traffic:
    """The streams of all components, and their total."""

    def __init__(self) -> None:
        self.streams: dict[Key, Stream] = {}
        self.total: Meter | None = None
        #: Packets that belong to no stream, because MAX_STREAMS is reached.
        self.untracked = 0
        #: The last STATUSTEXT packets, and the last EVENT packets that are not only for programs.
        self.notices: deque[Packet] = deque(maxlen=_NOTICES)

    def add(self, packets: Sequence[Packet], now: float) -> None:
        """Count packets received at the time `now`."""
        if not packets:
            return
        streams = self.streams
        size = 0
        for packet in packets:
            length = len(packet)
            size += length
            stream = streams.get((packet.system, packet.component, packet.message_id))
            if stream is None:
                stream = self._begin(packet, now)
            stream.count += 1
            stream.bytes += length
            stream.packet = packet
            stream.time = now
            if packet.message_id in _WITH_NOTICES and is_notice(packet):
                self.notices.append(packet)
        self._count(packets, size, now)

    def mark(self) -> None:
        """Set a mark in each meter."""
        if self.total is not None:
            self.total.mark()
        for stream in self.streams.values():
            stream.mark()

    @property
    def packets(self) -> int:
        """Number of counted packets."""
        return self.total.count if self.total else 0

    def _count(self, packets: Sequence[Packet], size: int, now: float) -> None:
        if self.total is None:
            self.total = Meter(now)
        self.total.count += len(packets)
        self.total.bytes += size
        self.total.time = now

    def _begin(self, packet: Packet, now: float) -> Stream:
        stream = Stream(now, packet)
        if len(self.streams) < MAX_STREAMS:
            self.streams[packet.system, packet.component, packet.message_id] = stream
        else:
            self.untracked += 1
        return stream
