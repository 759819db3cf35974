"""The observer of a link: one parser per channel, traffic per message, and link quality.

The counts of a closed channel are kept, so that totals only grow. Memory is bounded by the number of MAVLink
ids, not by the amount of data.
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, TypeAlias

from mavstack.cli.watch.notices import Notices
from mavstack.cli.watch.traffic import Traffic
from mavstack.security.timestamps import time_if_set
from mavstack.wire import Parser

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from mavstack.dialects import Dialect
    from mavstack.logs.recorder import Recorder
    from mavstack.wire import Packet, Signing

SourceAddress: TypeAlias = tuple[int, int]


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
    sources: dict[SourceAddress, SourceCounts] = field(default_factory=dict)

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

    def plus(self, other: Totals) -> Totals:
        """Return the sum with other counts."""
        total = Totals()
        for name in _COUNTS:
            setattr(total, name, getattr(self, name) + getattr(other, name))
        for counts in (self, other):
            for source, each in counts.sources.items():
                total.sources.setdefault(source, SourceCounts()).add(each.received, each.lost)
        return total

    @property
    def all_sources(self) -> SourceCounts:
        """Sum of the counts of all sources."""
        total = SourceCounts()
        for counts in self.sources.values():
            total.add(counts.received, counts.lost)
        return total


_COUNTS = tuple(each.name for each in fields(Totals) if each.name != "sources")


class Observer:
    """Parses and counts the bytes of the channels of a link or of a file."""

    def __init__(self, dialect: Dialect, selection: Selection | None = None) -> None:
        self.dialect = dialect
        self.selection = selection or Selection()
        #: Called with all received packets, selected or not, and their Unix time (0: not known).
        self.tap: Callable[[Sequence[Packet], float], None] = lambda packets, time: None
        #: Number of packets that were passed to `tap`.
        self.received = 0
        self.traffic = Traffic()
        self.notices = Notices()
        self.channels: dict[str, Parser] = {}
        self.first_recorded: float | None = None
        self.last_recorded: float | None = None
        #: True if the recording continues after the duration that is read.
        self.beyond_duration = False
        self._closed = Totals()

    def open(self, channel: str, *, timestamped: bool = False, signing: Signing | None = None) -> None:
        """Begin a stream of bytes; with `signing`, only packets signed with its key count."""
        self.close(channel)
        self.channels[channel] = Parser(self.dialect, timestamped=timestamped, signing=signing)

    def record_to(self, recorder: Recorder) -> None:
        """Pass all received packets to a recorder."""
        self.tap = recorder.add

    def receive(
        self,
        channel: str,
        data: bytes,
        now: float,
        duration: float | None = None,
        *,
        time: float | None = None,
    ) -> Sequence[Packet]:
        """Parse and count data; return the selected packets.

        Args:
            channel: Name of the channel.
            data: Received bytes.
            now: Time of the reception, in seconds of a monotonic clock.
            duration: Seconds of a recording after which packets are ignored; None reads all.
            time: Unix time of the reception, which signatures are checked against; None: not known.
        """
        packets: Sequence[Packet] = self.channels[channel].feed(data, time_if_set(time or 0.0))
        self._pass_on(packets, time or 0.0)
        return self._count(packets if duration is None else self._within(packets, duration), now)

    def flush(self, channel: str, now: float, *, time: float | None = None) -> Sequence[Packet]:
        """Count and return the last selected packets of a stream that ends."""
        packets = self.channels[channel].flush(time_if_set(time or 0.0))
        self._pass_on(packets, time or 0.0)
        return self._count(packets, now)

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
        return self._closed.plus(totals)

    @property
    def recorded_seconds(self) -> float | None:
        """Seconds from the earliest to the latest recorded time; None without recorded times."""
        if self.first_recorded is None or self.last_recorded is None:
            return None
        return self.last_recorded - self.first_recorded

    def _pass_on(self, packets: Sequence[Packet], time: float) -> None:
        """Pass received packets to the tap."""
        self.received += len(packets)
        self.tap(packets, time)

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
