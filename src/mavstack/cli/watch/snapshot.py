"""A snapshot of an observer as plain values, which the summary and the live display show.

Making a snapshot decodes only the last packet of each stream. It can be rendered in another thread while the
observer goes on counting.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from mavstack.cli.common.field_values import UNKNOWN, FieldText, field_texts, raw_hex
from mavstack.cli.common.identity import Identity, identify
from mavstack.cli.watch.observer import SourceCounts, Totals
from mavstack.cli.watch.traffic import Rate

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from mavstack.cli.watch.observer import Observer
    from mavstack.cli.watch.traffic import Meter
    from mavstack.cli.watch.trend import TrendRow
    from mavstack.wire import Packet, Parser

HEARTBEAT = 0
_TARGETS = frozenset({"target_system", "target_component", "target_network"})
_MAX_VALUE_WIDTH = 50
_TIMES = frozenset({"time_boot_ms", "time_usec"})


@dataclass(frozen=True, slots=True)
class MessageRow:
    """One message of one component: count, rate, last packet."""

    system: int
    component: int
    message_id: int
    name: str
    count: int
    rate: Rate
    packet: Packet
    label: str = ""

    @property
    def source(self) -> str:
        """System and component: `1/1`, after the letter of the link if there are several: `A 1/1`."""
        return f"{self.label} {self.system}/{self.component}".lstrip()

    def values(self) -> list[FieldText]:
        """Return the known values of the last packet without times; flags and targets come last."""
        message = self.packet.message
        if message is None:
            return [FieldText("raw", raw_hex(self.packet))]
        known = (value for value in field_texts(message) if value.known and value.name not in _TIMES)
        shortened = [value._replace(text=shorten(value.text, _MAX_VALUE_WIDTH)) for value in known]
        return sorted(shortened, key=lambda value: value.flags or value.name in _TARGETS)


@dataclass(frozen=True, slots=True)
class ComponentRow:
    """One component of one system: identity and counts."""

    system: int
    component: int
    identity: Identity
    counts: SourceCounts
    label: str = ""

    @property
    def source(self) -> str:
        """System and component: `1/1`, after the letter of the link if there are several: `A 1/1`."""
        return f"{self.label} {self.system}/{self.component}".lstrip()

    @property
    def state(self) -> str:
        """Armed or disarmed, flight mode and MAV_STATE, in a few words."""
        armed = {True: "ARMED", False: "disarmed", None: ""}[self.identity.armed]
        return " ".join(word for word in (armed, self.identity.mode, self.identity.state) if word)


@dataclass(frozen=True, slots=True)
class ChannelQuality:
    """The reception quality of one channel."""

    name: str
    packets: int
    bad_bytes: int
    counts: SourceCounts


@dataclass(frozen=True, slots=True)
class Snapshot:
    """The state of an observer at one moment."""

    title: str
    seconds: float | None
    selected: int
    untracked: int
    rate: Rate
    totals: Totals
    channels: list[ChannelQuality]
    components: list[ComponentRow]
    messages: list[MessageRow]
    texts: list[str]
    note: str = ""
    #: Packets that were refused because they are not signed with the key of the link.
    refused: int = 0
    #: True if several links or files are shown together; `channels` then has one entry for each.
    several: bool = False
    trends: Sequence[TrendRow] = ()
    #: The running recording and replay, in words; empty: none.
    activity: str = ""


def take_snapshot(
    observer: Observer, title: str, now: float, seconds: float | None, note: str = "", refused: int = 0
) -> Snapshot:
    """Return a snapshot of an observer.

    Args:
        observer: Observer of the link or file.
        title: Name of the link or file.
        now: Time of the snapshot, on the clock of the observer.
        seconds: Duration of the observation; None if it is not known.
        note: Problem of the link, shown below the title.
        refused: Packets that the key of the link did not sign.
    """
    totals = observer.totals()
    messages = _message_rows(observer, now)
    return Snapshot(
        title=title,
        seconds=seconds,
        selected=observer.traffic.packets,
        untracked=observer.traffic.untracked,
        rate=_rate(observer, observer.traffic.total, now),
        totals=totals,
        channels=[_quality(name, parser) for name, parser in tuple(observer.channels.items())],
        components=_component_rows(observer, messages, totals),
        messages=messages,
        texts=observer.notices.texts(tuple(observer.traffic.notices)),
        note=note,
        refused=refused,
    )


def merge_snapshots(snapshots: Mapping[str, Snapshot]) -> Snapshot:
    """Return one snapshot of several links or files by their letters; the rows have these letters."""
    if len(snapshots) == 1:
        return next(iter(snapshots.values()))
    totals = Totals()
    labelled, parts = snapshots.items(), snapshots.values()
    for each in parts:
        totals = totals.plus(each.totals)
    notes = (f"{label}: {part.note}" for label, part in labelled if part.note)
    return Snapshot(
        title=f"{len(snapshots)} sources",
        seconds=max((each.seconds for each in parts if each.seconds is not None), default=None),
        selected=sum(each.selected for each in parts),
        untracked=sum(each.untracked for each in parts),
        rate=Rate(sum(each.rate.packets for each in parts), sum(each.rate.bytes for each in parts)),
        totals=totals,
        channels=[_part_quality(label, part) for label, part in labelled],
        components=[replace(row, label=label) for label, part in labelled for row in part.components],
        messages=[replace(row, label=label) for label, part in labelled for row in part.messages],
        texts=[f"{label} {text}" for label, part in labelled for text in part.texts],
        note="  ".join(notes),
        refused=sum(each.refused for each in parts),
        several=True,
    )


def _part_quality(label: str, part: Snapshot) -> ChannelQuality:
    totals = part.totals
    return ChannelQuality(f"{label} {part.title}", totals.packets, totals.bad_bytes, totals.all_sources)


def shorten(line: str, width: int) -> str:
    """Return a line of at most `width` letters, with an ellipsis if it was longer."""
    return line if len(line) <= width else f"{line[: width - 1]}…"


def loss_text(counts: SourceCounts) -> str:
    """Return the loss in percent."""
    return f"{counts.loss * 100:.1f} %"


def rate_text(rate: float) -> str:
    """Return a rate in hertz with its significant digits."""
    if rate <= 0:
        return UNKNOWN
    return f"{rate:.2f}" if rate < 1 else f"{rate:.1f}" if rate < 1000 else f"{rate:.0f}"


def elapsed_text(seconds: float | None) -> str:
    """Return an elapsed time: 42.0 s, 3 min 07 s, 2 h 05 min."""
    if seconds is None:
        return "unknown time"
    if seconds < 120:
        return f"{seconds:.1f} s"
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes:02d} min" if hours else f"{minutes} min {rest:02d} s"


def values_text(values: Iterable[FieldText]) -> str:
    """Return values in one line."""
    return "  ".join(f"{value.name} {value.text}" for value in values)


def _message_rows(observer: Observer, now: float) -> list[MessageRow]:
    return [
        MessageRow(
            *key,
            name=stream.packet.name or f"unknown id {key[2]}",
            count=stream.count,
            rate=_rate(observer, stream, now),
            packet=stream.packet,
        )
        for key, stream in observer.traffic.streams.items()
    ]


def _rate(observer: Observer, meter: Meter | None, now: float) -> Rate:
    """Return the current rate of a link, or the average rate of a recording."""
    if meter is None:
        return Rate()
    recorded = observer.recorded_seconds
    if recorded is None:
        return meter.rate(now)
    return Rate(meter.count / recorded, meter.bytes / recorded) if recorded > 0 else Rate()


def _component_rows(observer: Observer, messages: list[MessageRow], totals: Totals) -> list[ComponentRow]:
    heartbeats = {(row.system, row.component): row.packet for row in messages if row.message_id == HEARTBEAT}
    sources = sorted({(row.system, row.component) for row in messages})
    return [
        ComponentRow(
            system,
            component,
            identify(component, heartbeats.get((system, component)), observer.dialect),
            totals.sources.get((system, component), SourceCounts()),
        )
        for system, component in sources
    ]


def _quality(name: str, parser: Parser) -> ChannelQuality:
    totals = Totals()
    totals.add(parser)
    return ChannelQuality(name, totals.packets, totals.bad_bytes, totals.all_sources)
