"""What was found, once and for all: one JSON object, or one page of plain text."""

from __future__ import annotations

import json
from collections import Counter
from typing import TYPE_CHECKING, Any

from mavstack.cli.watch.snapshot import (
    cut,
    duration_text,
    loss_text,
    rate_text,
    size_text,
    values_text,
)

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Sequence

    from mavstack.cli.watch.observer import Observer
    from mavstack.cli.watch.snapshot import Picture, Row

_PIPE_WIDTH = 160
_LEFT = frozenset({"MESSAGE", "SOURCE", "SYSTEM", "TYPE", "AUTOPILOT", "STATE", "LAST VALUES"})


def summary_object(observer: Observer, seconds: float | None) -> dict[str, Any]:
    """The counts, for programs."""
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
        "mavlink_1": totals.version_1,
        "mavlink_2": totals.version_2,
        "lost": totals.heard.lost,
        "sources": [f"{system}/{component}" for system, component in sources],
        "duration_s": None if seconds is None else round(seconds, 6),
    }


def summary_json(observer: Observer, seconds: float | None) -> str:
    """The counts as one line of JSON."""
    return json.dumps(summary_object(observer, seconds), allow_nan=False)


def summary_text(picture: Picture, width: int | None = None) -> str:
    """One page; lines are cut at `width` columns."""
    width = width or _PIPE_WIDTH
    lines = [*_head(picture), "", *_members(picture), "", *_messages(picture)]
    if picture.texts:
        lines += ["", "last texts:", *(f"  {text}" for text in picture.texts)]
    return "\n".join(cut(line, width).rstrip() for line in lines)


def headline(picture: Picture) -> str:
    """How much came, and how fast."""
    speed = f"{rate_text(picture.rate.packets)} msg/s, {size_text(picture.rate.bytes)}/s"
    known = "" if picture.seconds is None else f" in {duration_text(picture.seconds)}: {speed}"
    return f"{picture.selected} packets{known}"


def health(picture: Picture) -> str:
    """What was lost or wrong."""
    totals, heard = picture.totals, picture.totals.heard
    parts = [
        f"lost {heard.lost} ({loss_text(heard)})",
        f"bad {size_text(totals.bad_bytes)}",
        f"unknown {totals.unknown}",
        f"signed {totals.signed}",
        " and ".join(
            f"MAVLink {version}" for version, count in ((1, totals.version_1), (2, totals.version_2)) if count
        ),
    ]
    return ", ".join(part for part in parts if part)


def message_order(rows: Sequence[Row], sort: str = "name") -> list[Row]:
    """Rows in the order asked for; unknown ids come last by name."""
    if sort == "rate":
        return sorted(rows, key=lambda row: (-row.rate.packets, row.name, row.system, row.component))
    if sort == "count":
        return sorted(rows, key=lambda row: (-row.count, row.name, row.system, row.component))
    return sorted(rows, key=lambda row: (row.packet.name is None, row.name, row.system, row.component))


def columns(
    head: Sequence[str], rows: Sequence[Sequence[str]], left: Collection[str] = _LEFT
) -> Iterator[str]:
    """Lines of a table, columns as wide as needed; those in `left` begin at the left."""
    widths = [max(map(len, column)) for column in zip(head, *rows, strict=True)]
    for row in (head, *rows):
        cells = (
            f"{cell:<{width}}" if name in left else f"{cell:>{width}}"
            for name, cell, width in zip(head, row, widths, strict=True)
        )
        yield "  ".join(cells).rstrip()


def _head(picture: Picture) -> Iterator[str]:
    yield picture.title
    yield headline(picture)
    yield health(picture)
    if picture.note:
        yield picture.note
    if picture.untracked:
        yield f"{picture.untracked} packets had more different ids than are kept apart"


def _members(picture: Picture) -> Iterator[str]:
    rows = [
        (
            member.source,
            member.identity.type_name,
            member.identity.autopilot,
            member.state,
            str(member.heard.received),
            loss_text(member.heard),
        )
        for member in picture.members
    ]
    return columns(("SYSTEM", "TYPE", "AUTOPILOT", "STATE", "PACKETS", "LOST"), rows)


def _messages(picture: Picture) -> Iterator[str]:
    rows = [
        (
            row.name,
            row.source,
            str(row.count),
            rate_text(row.rate.packets),
            size_text(row.rate.bytes),
            values_text(row.values()),
        )
        for row in message_order(picture.rows)
    ]
    return columns(("MESSAGE", "SOURCE", "COUNT", "HZ", "BYTES/S", "LAST VALUES"), rows)
