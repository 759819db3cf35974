"""The live display of a link: a few lines about the link and its components, then one line per message.

The lines are fitted to the width of the terminal here, because this costs a tenth of a rich table, and the
display is rendered several times a second while a busy link is parsed.
"""

from __future__ import annotations

from time import monotonic
from typing import TYPE_CHECKING

from mavstack.cli.common.live_display import LiveDisplay, Text
from mavstack.cli.common.text import size_text
from mavstack.cli.watch.snapshot import elapsed_text, loss_text, rate_text, take_snapshot
from mavstack.cli.watch.summary import message_order

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.cli.watch.follower import Follower
    from mavstack.cli.watch.observer import SourceCounts
    from mavstack.cli.watch.snapshot import ComponentRow, MessageRow, Snapshot

_MARK_INTERVAL = 1.0
#: Columns from which the display is wide.
_WIDE = 100
_MAX_NAME_WIDTH = 28


class LiveTable(LiveDisplay["Snapshot"]):
    """The live display of a follower's link."""

    def __init__(self, title: str, follower: Follower, sort: str) -> None:
        super().__init__()
        self._title = title
        self._follower = follower
        self._sort = sort
        self._marked = monotonic()

    def snapshot(self) -> Snapshot:
        """Return a snapshot of the observer."""
        follower = self._follower
        if monotonic() - self._marked >= _MARK_INTERVAL:
            self._marked = monotonic()
            follower.observer.traffic.mark()
        return take_snapshot(follower.observer, self._title, monotonic(), follower.seconds, follower.note)

    def lines(self, snapshot: Snapshot, width: int, height: int) -> list[Text]:
        """Return the lines of a snapshot."""
        return render(snapshot, width, height, self._sort)


def render(snapshot: Snapshot, width: int, height: int, sort: str = "name") -> list[Text]:
    """Render a snapshot in at most `height` lines of at most `width` columns."""
    top = [
        *_header(snapshot, width),
        *_channels(snapshot),
        *_components(snapshot, max(2, height // 6)),
        Text(),
    ]
    bottom = _status_texts(snapshot, 4 if height >= 30 else 2)
    available = max(height - len(top) - len(bottom) - 2, 1)
    rows = message_order(snapshot.messages, sort)
    middle = _table(rows[:available], width, len(snapshot.components) > 1)
    lines = [*top, *middle, *bottom]
    lines.append(_footer(len(rows) - available, sort))
    for line in lines:
        line.no_wrap = True
        line.truncate(width, overflow="ellipsis")
    return lines[:height]


def _header(snapshot: Snapshot, width: int) -> Iterator[Text]:
    clock = "" if snapshot.seconds is None else elapsed_text(snapshot.seconds)
    title = Text(f" {snapshot.title}", style="bold reverse")
    title.truncate(width - len(clock) - 2, overflow="ellipsis")
    title.append(" " * max(width - title.cell_len - len(clock) - 1, 1) + clock + " ")
    yield title
    totals = snapshot.totals
    line = Text(" ")
    line.append(rate_text(snapshot.rate.packets), "bold").append(" msg/s  ")
    line.append(size_text(snapshot.rate.bytes), "bold").append("/s  ")
    line.append(f"{snapshot.selected} packets  ")
    line.append("lost ").append(loss_text(totals.all_sources), _loss_style(totals.all_sources))
    line.append("  bad ").append(size_text(totals.bad_bytes), "yellow" if totals.bad_bytes else "")
    line.append(f"  unknown {totals.unknown}  signed {totals.signed}")
    yield line
    if snapshot.note:
        yield Text(f" {snapshot.note}", style="yellow")


def _channels(snapshot: Snapshot) -> Iterator[Text]:
    """Yield a line per channel if there are several."""
    if len(snapshot.channels) < 2:
        return
    shown = sorted(snapshot.channels, key=lambda channel: -channel.packets)[:4]
    for channel in shown:
        line = Text(f" {channel.name}", style="blue")
        line.append(f"  {channel.packets} packets  lost ", "default")
        line.append(loss_text(channel.counts), _loss_style(channel.counts) or "default")
        line.append(f"  bad {size_text(channel.bad_bytes)}", "default")
        yield line
    if len(snapshot.channels) > len(shown):
        yield Text(f" … {len(snapshot.channels) - len(shown)} more channels", style="dim")


def _components(snapshot: Snapshot, maximum: int) -> Iterator[Text]:
    rows = sorted(snapshot.components, key=lambda row: (not row.identity.autopilot, row.system))
    shown = rows if len(rows) <= maximum else rows[: maximum - 1]
    for row in shown:
        yield _component(row)
    if len(rows) > len(shown):
        yield Text(f" … {len(rows) - len(shown)} more components", style="dim")


def _component(row: ComponentRow) -> Text:
    identity = row.identity
    line = Text(" ").append(f"{row.source:<7}", "bold magenta").append("  ")
    line.append("  ".join(word for word in (identity.type_name or "unknown", identity.autopilot) if word))
    if identity.armed is not None:
        line.append("  ARMED" if identity.armed else "  disarmed", "bold red" if identity.armed else "green")
    if identity.mode:
        line.append(f"  {identity.mode}", "bold yellow")
    if identity.state:
        line.append(f"  {identity.state}", "dim")
    if row.counts.lost:
        line.append("  lost ", "dim").append(loss_text(row.counts), _loss_style(row.counts))
    return line


def _table(rows: list[MessageRow], width: int, sources: bool) -> Iterator[Text]:
    name = min(max([len(row.name) for row in rows] + [7]), _MAX_NAME_WIDTH)
    source = 8 if sources else 0
    count = 9 if width >= _WIDE else 0
    head = Text(f" {'MESSAGE':<{name}}{'  SOURCE' if sources else ''}", style="dim")
    head.append(f"{'COUNT':>{count}}" if count else "").append(f"{'HZ':>7}{'BYTES/S':>9} LAST VALUES")
    yield head
    for row in rows:
        silent = row.rate.packets <= 0 and row.count > 1
        line = Text(f" {row.name[:name]:<{name}}", style="dim" if silent else "")
        line.stylize("" if silent else "cyan")
        line.append(f"{row.source:>{source}}" if sources else "", "magenta")
        line.append(f"{row.count:>{count}}" if count else "", "default")
        line.append(f"{rate_text(row.rate.packets):>7}{size_text(row.rate.bytes):>9} ", "default")
        yield _append_values(line, row, width)


def _append_values(line: Text, row: MessageRow, width: int) -> Text:
    separator = "  " if width >= _WIDE else " "
    for value in row.values():
        if line.cell_len >= width:
            break
        line.append(f"{value.name} ", "dim").append(value.text, "default").append(separator)
    line.rstrip()
    return line


def _status_texts(snapshot: Snapshot, maximum: int) -> list[Text]:
    if not snapshot.texts:
        return []
    return [Text(), *(Text(f" {text}", style="yellow") for text in snapshot.texts[-maximum:])]


def _footer(hidden: int, sort: str) -> Text:
    remedies = (
        "--filter NAME or a taller window"
        if sort == "rate"
        else "--sort rate, --filter NAME, a taller window"
    )
    more = f"{hidden} more: {remedies} · " if hidden > 0 else ""
    return Text(f" {more}Ctrl-C ends", style="dim")


def _loss_style(counts: SourceCounts) -> str:
    return "bold red" if counts.loss >= 0.1 else "yellow" if counts.loss >= 0.01 else ""
