"""The summary of a link or a file: one JSON object, or one page of text."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any

from mavstack.cli.common.output import table_lines
from mavstack.cli.common.text import size_text
from mavstack.cli.watch.snapshot import elapsed_text, loss_text, rate_text, shorten, values_text

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from mavstack.cli.watch.observer import Observer
    from mavstack.cli.watch.snapshot import MessageRow, Snapshot

_PIPE_WIDTH = 160
_LEFT = frozenset({"MESSAGE", "SOURCE", "SYSTEM", "TYPE", "AUTOPILOT", "STATE", "LAST VALUES"})


def summary_object(observer: Observer, seconds: float | None, refused: int = 0) -> dict[str, Any]:
    """Return the counts as values for JSON.

    Args:
        observer: Observer of the link or file.
        seconds: Duration of the observation; None if it is not known.
        refused: Packets that the key of the link did not sign.
    """
    messages: Counter[str] = Counter()
    unknown: Counter[int] = Counter()
    for (_, _, message_id), stream in observer.traffic.streams.items():
        name = stream.packet.name
        if name is None:
            unknown[message_id] += stream.count
        else:
            messages[name] += stream.count
    totals = observer.totals()
    sources = sorted({(system, component) for system, component, _ in observer.traffic.streams})
    return {
        "packets": observer.traffic.packets,
        "bytes": observer.traffic.total.bytes if observer.traffic.total else 0,
        "messages": dict(sorted(messages.items())),
        "unknown": {str(message_id): count for message_id, count in sorted(unknown.items())},
        "untracked": observer.traffic.untracked,
        "bad_bytes": totals.bad_bytes,
        "bad_checksum": totals.bad_checksum,
        "signed": totals.signed,
        "refused": refused,
        "mavlink_1": totals.version_1,
        "mavlink_2": totals.version_2,
        "lost": totals.all_sources.lost,
        "sources": [f"{system}/{component}" for system, component in sources],
        "duration_s": None if seconds is None else round(seconds, 6),
    }


def merge_summaries(titles: Sequence[str], parts: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """Return the sum of several links or files, with each of them and its title in `by_source`."""
    if len(parts) == 1:
        return parts[0]
    merged: dict[str, Any] = {}
    for name, first in parts[0].items():
        values = [part[name] for part in parts]
        if isinstance(first, dict):
            merged[name] = dict(sorted(sum(map(Counter, values), Counter()).items()))
        elif isinstance(first, list):
            merged[name] = list(dict.fromkeys(each for value in values for each in value))
        elif name == "duration_s":
            merged[name] = max((value for value in values if value is not None), default=None)
        else:
            merged[name] = sum(values)
    by_source = [{"source": title, **part} for title, part in zip(titles, parts, strict=True)]
    return {**merged, "by_source": by_source}


def summary_text(snapshot: Snapshot, width: int | None = None) -> str:
    """Return one page of text whose lines are shortened to `width` columns."""
    width = width or _PIPE_WIDTH
    lines = [*_head(snapshot), "", *_components(snapshot), "", *_messages(snapshot)]
    if snapshot.texts:
        lines += ["", "last status texts:", *(f"  {text}" for text in snapshot.texts)]
    return "\n".join(shorten(line, width).rstrip() for line in lines)


def headline(snapshot: Snapshot) -> str:
    """Return the number of packets and the rate."""
    speed = f"{rate_text(snapshot.rate.packets)} msg/s, {size_text(snapshot.rate.bytes)}/s"
    known = "" if snapshot.seconds is None else f" in {elapsed_text(snapshot.seconds)}: {speed}"
    return f"{snapshot.selected} packets{known}"


def quality(snapshot: Snapshot) -> str:
    """Return the lost, bad, unknown and signed packets, and the protocol versions."""
    totals, counts = snapshot.totals, snapshot.totals.all_sources
    parts = [
        f"lost {counts.lost} ({loss_text(counts)})",
        f"bad {size_text(totals.bad_bytes)}",
        f"unknown {totals.unknown}",
        f"signed {totals.signed}",
        f"refused {snapshot.refused}" if snapshot.refused else "",
        " and ".join(
            f"MAVLink {version}" for version, count in ((1, totals.version_1), (2, totals.version_2)) if count
        ),
    ]
    return ", ".join(part for part in parts if part)


def message_order(rows: Sequence[MessageRow], sort: str = "name") -> list[MessageRow]:
    """Return rows sorted by name, rate or count; by name, unknown ids come last."""
    if sort == "rate":
        return sorted(rows, key=lambda row: (-row.rate.packets, *_name_order(row)))
    if sort == "count":
        return sorted(rows, key=lambda row: (-row.count, *_name_order(row)))
    return sorted(rows, key=lambda row: (row.packet.name is None, *_name_order(row)))


def _name_order(row: MessageRow) -> tuple[str, int, int, str]:
    return row.name, row.system, row.component, row.label


def _head(snapshot: Snapshot) -> Iterator[str]:
    yield snapshot.title
    if snapshot.several:
        for part in snapshot.channels:
            yield f"  {part.name}: {part.packets} packets, lost {loss_text(part.counts)}"
    yield headline(snapshot)
    yield quality(snapshot)
    if snapshot.note:
        yield snapshot.note
    if snapshot.untracked:
        yield f"{snapshot.untracked} packets exceed the number of streams that are counted separately"


def _components(snapshot: Snapshot) -> Iterator[str]:
    rows = [
        (
            row.source,
            row.identity.type_name,
            row.identity.autopilot,
            row.state,
            str(row.counts.received),
            loss_text(row.counts),
        )
        for row in snapshot.components
    ]
    return table_lines(("SYSTEM", "TYPE", "AUTOPILOT", "STATE", "PACKETS", "LOST"), rows, _LEFT)


def _messages(snapshot: Snapshot) -> Iterator[str]:
    rows = [
        (
            row.name,
            row.source,
            str(row.count),
            rate_text(row.rate.packets),
            size_text(row.rate.bytes),
            values_text(row.values()),
        )
        for row in message_order(snapshot.messages)
    ]
    return table_lines(("MESSAGE", "SOURCE", "COUNT", "HZ", "BYTES/S", "LAST VALUES"), rows, _LEFT)
