"""The live display of a link: a few lines about the link and its components, then one line per message.

The lines are fitted to the width of the terminal here, because this costs a tenth of a rich table, and the
display is rendered several times a second while a busy link is parsed.
"""

from __future__ import annotations

from dataclasses import replace
from time import monotonic
from typing import TYPE_CHECKING

from mavstack.cli.common.live_display import LiveDisplay, Text
from mavstack.cli.common.text import size_text
from mavstack.cli.watch.snapshot import elapsed_text, loss_text, rate_text, shorten
from mavstack.cli.watch.sources import take_picture
from mavstack.cli.watch.summary import message_order
from mavstack.cli.watch.trend import MAX_SAMPLES, sparkline

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from mavstack.cli.watch.observer import SourceCounts
    from mavstack.cli.watch.snapshot import ComponentRow, MessageRow, Snapshot
    from mavstack.cli.watch.sources import WatchedSource
    from mavstack.cli.watch.trend import TrendRow, Trends

_MARK_INTERVAL = 1.0
#: Minimum width of the wide display in characters.
_WIDE = 100
_MAX_NAME_WIDTH = 28


class LiveTable(LiveDisplay["Snapshot"]):
    """The live display of the sources that are watched.

    Args:
        sources: The sources.
        sort: The order of the messages: name, rate or count.
        trends: The fields whose trends are shown; None: none.
        activity: Returns what is recorded or replayed, in words.
    """

    def __init__(
        self,
        sources: Sequence[WatchedSource],
        sort: str,
        trends: Trends | None = None,
        activity: Callable[[], str] = str,
    ) -> None:
        super().__init__()
        self._sources = sources
        self._sort = sort
        self._trends = trends
        self._activity = activity
        self._marked = monotonic()

    def snapshot(self) -> Snapshot:
        """Return a snapshot of the observers."""
        now = monotonic()
        if now - self._marked >= _MARK_INTERVAL:
            self._marked = now
            for source in self._sources:
                source.observer.traffic.mark()
        rows: list[TrendRow] = []
        if self._trends is not None:
            self._trends.sample({source.label: source.observer for source in self._sources}, now)
            rows = self._trends.rows()
        return replace(take_picture(self._sources), trends=rows, activity=self._activity())

    def lines(self, snapshot: Snapshot, width: int, height: int) -> list[Text]:
        """Return the lines of a snapshot."""
        return render(snapshot, width, height, self._sort)


def render(snapshot: Snapshot, width: int, height: int, sort: str = "name") -> list[Text]:
    """Render a snapshot in at most `height` lines of at most `width` columns."""
    top = [
        *_header(snapshot, width),
        *_channels(snapshot, max(4, height // 6)),
        *_components(snapshot, max(2, height // 6)),
        *_trends(snapshot, width, height // 2),
        Text(),
    ]
    bottom = _status_texts(snapshot, 4 if height >= 30 else 2)
    available = max(height - len(top) - len(bottom) - 2, 1)
    rows = message_order(snapshot.messages, sort)
    middle = _table(rows[:available], width, _source_width(snapshot))
    lines = [*top, *middle, *bottom]
    lines.append(_footer(len(rows) - available, sort, snapshot.activity))
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
    if snapshot.refused:
        line.append(f"  refused {snapshot.refused}", "yellow")
    yield line
    if snapshot.note:
        yield Text(f" {snapshot.note}", style="yellow")


def _channels(snapshot: Snapshot, maximum: int) -> Iterator[Text]:
    """Yield a line per channel, or per link, if there are several."""
    if len(snapshot.channels) < 2:
        return
    shown = snapshot.channels
    if not snapshot.several:
        shown = sorted(shown, key=lambda channel: -channel.packets)
    shown = shown[:maximum]
    for channel in shown:
        line = Text(f" {channel.name}", style="blue")
        line.append(f"  {channel.packets} packets  lost ", "default")
        line.append(loss_text(channel.counts), _loss_style(channel.counts) or "default")
        line.append(f"  bad {size_text(channel.bad_bytes)}", "default")
        yield line
    if len(snapshot.channels) > len(shown):
        yield Text(f" … {len(snapshot.channels) - len(shown)} more", style="dim")


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


def _trends(snapshot: Snapshot, width: int, maximum: int) -> Iterator[Text]:
    """Yield a line per field: its name, its course and its newest value."""
    if not snapshot.trends:
        return
    yield Text()
    shown = snapshot.trends[: max(maximum, 1)]
    name = min(max(len(row.name) for row in shown), width // 3)
    value = max(len(row.text) for row in shown)
    source = _source_width(snapshot)
    bars = min(width - name - value - source - 4, MAX_SAMPLES)
    for row in shown:
        line = Text(f" {row.name[-name:]:<{name}}", style="cyan")
        line.append(f"{row.source:>{source}}" if source else "", "magenta")
        line.append(f" {sparkline(row.samples, bars)} ", "green").append(f"{row.text:>{value}}", "default")
        yield line
    if len(snapshot.trends) > len(shown):
        yield Text(f" … {len(snapshot.trends) - len(shown)} more trends", style="dim")


def _source_width(snapshot: Snapshot) -> int:
    """Return the width of the column of sources; 0 if there is only one component."""
    return 10 if snapshot.several else 8 if len(snapshot.components) > 1 else 0


def _table(rows: list[MessageRow], width: int, source: int) -> Iterator[Text]:
    name = min(max([len(row.name) for row in rows] + [7]), _MAX_NAME_WIDTH)
    count = 9 if width >= _WIDE else 0
    head = Text(f" {'MESSAGE':<{name}}", style="dim").append(f"{'SOURCE':>{source}}" if source else "")
    head.append(f"{'COUNT':>{count}}" if count else "").append(f"{'HZ':>7}{'BYTES/S':>9} LAST VALUES")
    yield head
    for row in rows:
        silent = row.rate.packets <= 0 and row.count > 1
        line = Text(f" {shorten(row.name, name):<{name}}", style="dim" if silent else "")
        line.stylize("" if silent else "cyan")
        line.append(f"{row.source:>{source}}" if source else "", "magenta")
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


def _footer(hidden: int, sort: str, activity: str) -> Text:
    remedies = (
        "--filter NAME or a taller window"
        if sort == "rate"
        else "--sort rate, --filter NAME, a taller window"
    )
    more = f"{hidden} more: {remedies} · " if hidden > 0 else ""
    line = Text(f" {activity} · " if activity else " ", style="yellow")
    return line.append(f"{more}Ctrl-C ends", "dim")


def _loss_style(counts: SourceCounts) -> str:
    return "bold red" if counts.loss >= 0.1 else "yellow" if counts.loss >= 0.01 else ""
