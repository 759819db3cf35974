"""What a summary or a live picture shows, as plain values: made from an observer, drawn by others.

Making one decodes the last packet of each stream, nothing else; it can be drawn in another thread while the
observer goes on counting.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from mavstack.cli.common.field_values import UNKNOWN, FieldText, field_texts, raw_hex
from mavstack.cli.common.identity import Identity, identify
from mavstack.cli.watch.observer import Heard, Totals
from mavstack.cli.watch.traffic import Rate

if TYPE_CHECKING:
    from collections.abc import Iterable

    from mavstack.cli.watch.observer import Observer
    from mavstack.cli.watch.traffic import Meter
    from mavstack.wire import Packet, Parser

HEARTBEAT = 0
_TARGETS = frozenset({"target_system", "target_component", "target_network"})
_LONGEST_VALUE = 50
_TIMES = frozenset({"time_boot_ms", "time_usec"})


@dataclass(frozen=True, slots=True)
class Row:
    """One message of one component."""

    system: int
    component: int
    message_id: int
    name: str
    count: int
    rate: Rate
    packet: Packet

    @property
    def source(self) -> str:
        """System and component as people write them."""
        return f"{self.system}/{self.component}"

    def values(self) -> list[FieldText]:
        """The last values that are known, without times, what tells most first."""
        message = self.packet.message
        if message is None:
            return [FieldText("raw", raw_hex(self.packet))]
        known = (value for value in field_texts(message) if value.known and value.name not in _TIMES)
        shortened = [value._replace(text=cut(value.text, _LONGEST_VALUE)) for value in known]
        return sorted(shortened, key=lambda value: value.flags or value.name in _TARGETS)


@dataclass(frozen=True, slots=True)
class Member:
    """One component of one system."""

    system: int
    component: int
    identity: Identity
    heard: Heard

    @property
    def source(self) -> str:
        """System and component as people write them."""
        return f"{self.system}/{self.component}"

    @property
    def state(self) -> str:
        """Whether it is armed, its mode and its state, in a few words."""
        armed = {True: "ARMED", False: "disarmed", None: ""}[self.identity.armed]
        return " ".join(word for word in (armed, self.identity.mode, self.identity.state) if word)


@dataclass(frozen=True, slots=True)
class Quality:
    """How well one channel is heard."""

    name: str
    packets: int
    bad_bytes: int
    heard: Heard


@dataclass(frozen=True, slots=True)
class Picture:
    """All of it, at one moment."""

    title: str
    seconds: float | None
    selected: int
    untracked: int
    rate: Rate
    totals: Totals
    channels: list[Quality]
    members: list[Member]
    rows: list[Row]
    texts: list[str]
    note: str = ""


def take(observer: Observer, title: str, now: float, seconds: float | None, note: str = "") -> Picture:
    """The picture at `now`, `seconds` after it began; `None` if nobody knows."""
    totals = observer.totals()
    rows = _rows(observer, now)
    return Picture(
        title=title,
        seconds=seconds,
        selected=observer.traffic.packets,
        untracked=observer.traffic.untracked,
        rate=_rate(observer, observer.traffic.total, now),
        totals=totals,
        channels=[_quality(name, parser) for name, parser in tuple(observer.channels.items())],
        members=_members(observer, rows, totals),
        rows=rows,
        texts=[_status(packet) for packet in observer.traffic.texts if packet.name == "STATUSTEXT"],
        note=note,
    )


def cut(line: str, width: int) -> str:
    """The line, with an ellipsis where it is too long."""
    return line if len(line) <= width else f"{line[: width - 1]}…"


def loss_text(heard: Heard) -> str:
    """The loss of a link or a source, in words."""
    return f"{heard.loss * 100:.1f} %"


def size_text(size: float) -> str:
    """A number of bytes as people read it."""
    for unit in ("B", "kB", "MB"):
        if size < 1000:
            return f"{size:.0f} {unit}" if unit == "B" else f"{size:.1f} {unit}"
        size /= 1000
    return f"{size:.1f} GB"


def rate_text(rate: float) -> str:
    """Packets a second with as many digits as mean something."""
    if rate <= 0:
        return UNKNOWN
    return f"{rate:.2f}" if rate < 1 else f"{rate:.1f}" if rate < 1000 else f"{rate:.0f}"


def duration_text(seconds: float | None) -> str:
    """A duration as people read it."""
    if seconds is None:
        return "unknown time"
    if seconds < 120:
        return f"{seconds:.1f} s"
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes:02d} min" if hours else f"{minutes} min {rest:02d} s"


def values_text(values: Iterable[FieldText]) -> str:
    """Values on one line."""
    return "  ".join(f"{value.name} {value.text}" for value in values)


def _rows(observer: Observer, now: float) -> list[Row]:
    return [
        Row(
            *key,
            name=stream.packet.name or f"unknown id {key[2]}",
            count=stream.count,
            rate=_rate(observer, stream, now),
            packet=stream.packet,
        )
        for key, stream in observer.traffic.streams.items()
    ]


def _rate(observer: Observer, meter: Meter | None, now: float) -> Rate:
    """Live as it is now; of a recording the average over all of it."""
    if meter is None:
        return Rate()
    recorded = observer.recorded_seconds
    if recorded is None:
        return meter.rate(now)
    return Rate(meter.count / recorded, meter.bytes / recorded) if recorded > 0 else Rate()


def _members(observer: Observer, rows: list[Row], totals: Totals) -> list[Member]:
    heartbeats = {(row.system, row.component): row.packet for row in rows if row.message_id == HEARTBEAT}
    sources = sorted({(row.system, row.component) for row in rows})
    return [
        Member(
            system,
            component,
            identify(component, heartbeats.get((system, component)), observer.dialect),
            totals.sources.get((system, component), Heard()),
        )
        for system, component in sources
    ]


def _quality(name: str, parser: Parser) -> Quality:
    totals = Totals()
    totals.add(parser)
    return Quality(name, totals.packets, totals.bad_bytes, totals.heard)


def _status(packet: Packet) -> str:
    """A status text with its sender and severity."""
    values = {value.name: value.text for value in field_texts(packet.message)}
    return f"{packet.system}/{packet.component} {values['severity']}: {values['text']}"
