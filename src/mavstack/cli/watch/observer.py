"""The observer of a link: one parser per channel, traffic per message, and link quality.

The counts of a closed channel are kept, so that totals only grow. Memory is bounded by the number of MAVLink
ids, not by the amount of data.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TypeAlias

from mavstack.cli.watch.traffic import Traffic
from mavstack.wire import Parser

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mavstack.dialects import Dialect
    from mavstack.wire import Packet

Source: TypeAlias = tuple[int, int]


@dataclass(frozen=True, slots=True)
class Selection:
    """A selection of packets by message id and by system; None selects all."""

    message_ids: frozenset[int] | None = None
    system: int | None = None

    def select(self, packets: Sequence[Packet]) -> Sequence[Packet]:
        """Return the selected packets."""
        ids, system = self.message_ids, self.system
        if ids is not None:
            packets = [packet for packet in packets if packet.message_id in ids]
        if system is not None:
            packets = [packet for packet in packets if packet.system == system]
        return packets


@dataclass(slots=True)
class SourceCounts:
    """Received packets of a source, and lost packets by the gaps in its sequence numbers."""

    received: int = 0
    lost: int = 0

    @property
    def loss(self) -> float:
        """Share of the sent packets that were lost, 0 to 1."""
        return self.lost / (self.lost + self.received) if self.lost else 0.0

    def add(self, received: int, lost: int) -> None:
        """Add counts."""
        self.received += received
        self.lost += lost


@dataclass(slots=True)
class Totals:
    """Counts of all parsers, for selected and other packets."""

    packets: int = 0
    bytes: int = 0
    version_1: int = 0
    version_2: int = 0
    signed: int = 0
    unknown: int = 0
    bad_bytes: int = 0
    bad_checksum: int = 0
    sources: dict[Source, SourceCounts] = field(default_factory=dict)

    def add(self, parser: Parser) -> None:
        """Add the counts of one parser."""
        statistics = parser.statistics
        self.packets += statistics.packets
        self.bytes += statistics.packet_bytes
        self.version_1 += statistics.version_1
        self.version_2 += statistics.version_2
        self.signed += statistics.signed
        self.unknown += statistics.unknown
        self.bad_bytes += statistics.bad_bytes
        self.bad_checksum += statistics.bad_checksum
        for source, counts in parser.sources.items():
            self.sources.setdefault(source, SourceCounts()).add(counts.received, counts.lost)

    @property
    def all_sources(self) -> SourceCounts:
        """Sum of the counts of all sources."""
        total = SourceCounts()
        for counts in self.sources.values():
            total.add(counts.received, counts.lost)
        return total


class Observer:
    """Parses and counts the bytes of the channels of a link or of a file."""

    def __init__(self, dialect: Dialect, selection: Selection | None = None) -> None:
        self.dialect = dialect
        self.selection = selection or Selection()
        self.traffic = Traffic()
        self.channels: dict[str, Parser] = {}
        self.first_recorded: float | None = None
        self.last_recorded: float | None = None
        #: True if a packet was recorded after the end of the duration to read.
        self.beyond_duration = False
        self._closed = Totals()

    def open(self, channel: str, *, timestamped: bool = False) -> None:
        """Begin a stream of bytes."""
        self.close(channel)
        self.channels[channel] = Parser(self.dialect, timestamped=timestamped)

    def receive(
        self, channel: str, data: bytes, now: float, duration: float | None = None
    ) -> Sequence[Packet]:
        """Parse and count data; return the selected packets.

        Args:
            channel: Name of the channel.
            data: Received bytes.
            now: Time of the reception, in seconds of a monotonic clock.
            duration: Seconds of a recording after which packets are ignored; None reads all.
        """
        packets: Sequence[Packet] = self.channels[channel].feed(data)
        return self._count(packets if duration is None else self._within(packets, duration), now)

    def flush(self, channel: str, now: float) -> Sequence[Packet]:
        """Count and return the last selected packets of a stream that ends."""
        return self._count(self.channels[channel].flush(), now)

    def close(self, channel: str) -> None:
        """End a stream; its counts are kept."""
        parser = self.channels.pop(channel, None)
        if parser is not None:
            self._closed.add(parser)

    def totals(self) -> Totals:
        """Return the counts of all channels, including closed ones."""
        totals = Totals()
        for parser in self.channels.values():
            totals.add(parser)
        return _sum(self._closed, totals)

    @property
    def recorded_seconds(self) -> float | None:
        """Seconds from the earliest to the latest recorded time; None without recorded times."""
        if self.first_recorded is None or self.last_recorded is None:
            return None
        return self.last_recorded - self.first_recorded

    def _count(self, packets: Sequence[Packet], now: float) -> Sequence[Packet]:
        self._note_times(packets)
        selected = self.selection.select(packets)
        self.traffic.add(selected, now)
        return selected

    def _within(self, packets: Sequence[Packet], duration: float) -> list[Packet]:
        first = self.first_recorded
        if first is None:
            first = next((recorded_time(packet) for packet in packets if packet.timestamp is not None), 0.0)
        within = [packet for packet in packets if recorded_time(packet) - first <= duration]
        self.beyond_duration = len(within) < len(packets)
        return within

    def _note_times(self, packets: Sequence[Packet]) -> None:
        times = [time for packet in packets if (time := packet.timestamp) is not None]
        if not times:
            return
        first, last = min(times) / 1e6, max(times) / 1e6
        self.first_recorded = first if self.first_recorded is None else min(self.first_recorded, first)
        self.last_recorded = last if self.last_recorded is None else max(self.last_recorded, last)


def recorded_time(packet: Packet) -> float:
    """Return the recorded Unix time of a packet in seconds, 0 if it has none."""
    return (packet.timestamp or 0) / 1e6


def _sum(first: Totals, second: Totals) -> Totals:
    """Add the first totals to the second and return them."""
    for name in (
        "packets",
        "bytes",
        "version_1",
        "version_2",
        "signed",
        "unknown",
        "bad_bytes",
        "bad_checksum",
    ):
        setattr(second, name, getattr(first, name) + getattr(second, name))
    for source, counts in first.sources.items():
        second.sources.setdefault(source, SourceCounts()).add(counts.received, counts.lost)
    return second
