"""Bytes in, traffic and link quality out: one parser a channel, and what all of them counted.

A channel that closes leaves its counts behind, so that totals only grow. Everything counted here is bounded
by the ids of MAVLink, not by how much comes.
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
    """Which packets count: by message id and by system; `None` is all."""

    message_ids: frozenset[int] | None = None
    system: int | None = None

    def of(self, packets: Sequence[Packet]) -> Sequence[Packet]:
        """Those of `packets` that are selected."""
        ids, system = self.message_ids, self.system
        if ids is not None:
            packets = [packet for packet in packets if packet.message_id in ids]
        if system is not None:
            packets = [packet for packet in packets if packet.system == system]
        return packets


@dataclass(slots=True)
class Heard:
    """How many packets of a source came on a channel, and how many the sequence numbers say are missing."""

    received: int = 0
    lost: int = 0

    @property
    def loss(self) -> float:
        """Share of the packets sent that were lost, 0 to 1."""
        return self.lost / (self.lost + self.received) if self.lost else 0.0

    def add(self, received: int, lost: int) -> None:
        """Count more."""
        self.received += received
        self.lost += lost


@dataclass(slots=True)
class Totals:
    """What parsers counted, selected or not."""

    packets: int = 0
    bytes: int = 0
    version_1: int = 0
    version_2: int = 0
    signed: int = 0
    unknown: int = 0
    bad_bytes: int = 0
    bad_checksum: int = 0
    sources: dict[Source, Heard] = field(default_factory=dict)

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
        for source, heard in parser.sources.items():
            self.sources.setdefault(source, Heard()).add(heard.received, heard.lost)

    @property
    def heard(self) -> Heard:
        """All sources as one."""
        whole = Heard()
        for heard in self.sources.values():
            whole.add(heard.received, heard.lost)
        return whole


class Observer:
    """Parses what comes on the channels of a link or from a file, and counts it."""

    def __init__(self, dialect: Dialect, selection: Selection | None = None) -> None:
        self.dialect = dialect
        self.selection = selection or Selection()
        self.traffic = Traffic()
        self.channels: dict[str, Parser] = {}
        self.first_recorded: float | None = None
        self.last_recorded: float | None = None
        #: Whether packets came after the limit that was given.
        self.beyond_limit = False
        self._closed = Totals()

    def open(self, channel: str, *, timestamped: bool = False) -> None:
        """Begin a stream of bytes."""
        self.close(channel)
        self.channels[channel] = Parser(self.dialect, timestamped=timestamped)

    def receive(self, channel: str, data: bytes, now: float, limit: float | None = None) -> Sequence[Packet]:
        """The selected packets that `data` completes, counted; of a recording up to `limit` seconds of it."""
        packets: Sequence[Packet] = self.channels[channel].feed(data)
        return self._count(packets if limit is None else self._within(packets, limit), now)

    def flush(self, channel: str, now: float) -> Sequence[Packet]:
        """The last selected packets of a stream that ends."""
        return self._count(self.channels[channel].flush(), now)

    def close(self, channel: str) -> None:
        """End a stream; its counts stay."""
        parser = self.channels.pop(channel, None)
        if parser is not None:
            self._closed.add(parser)

    def totals(self) -> Totals:
        """What all channels, past ones included, have counted so far."""
        totals = Totals()
        for parser in self.channels.values():
            totals.add(parser)
        return _sum(self._closed, totals)

    @property
    def recorded_seconds(self) -> float | None:
        """From the earliest recorded time to the latest; `None` without recorded times."""
        if self.first_recorded is None or self.last_recorded is None:
            return None
        return self.last_recorded - self.first_recorded

    def _count(self, packets: Sequence[Packet], now: float) -> Sequence[Packet]:
        self._note_times(packets)
        selected = self.selection.of(packets)
        self.traffic.add(selected, now)
        return selected

    def _within(self, packets: Sequence[Packet], limit: float) -> list[Packet]:
        first = self.first_recorded
        if first is None:
            first = next((recorded_time(packet) for packet in packets if packet.timestamp is not None), 0.0)
        within = [packet for packet in packets if recorded_time(packet) - first <= limit]
        self.beyond_limit = len(within) < len(packets)
        return within

    def _note_times(self, packets: Sequence[Packet]) -> None:
        times = [time for packet in packets if (time := packet.timestamp) is not None]
        if not times:
            return
        first, last = min(times) / 1e6, max(times) / 1e6
        self.first_recorded = first if self.first_recorded is None else min(self.first_recorded, first)
        self.last_recorded = last if self.last_recorded is None else max(self.last_recorded, last)


def recorded_time(packet: Packet) -> float:
    """Unix time in seconds that was recorded before the packet, 0 if none was."""
    return (packet.timestamp or 0) / 1e6


def _sum(first: Totals, second: Totals) -> Totals:
    """Both together."""
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
    for source, heard in first.sources.items():
        second.sources.setdefault(source, Heard()).add(heard.received, heard.lost)
    return second
