"""The live picture: a few lines on the link and who is on it, then a line a message.

Lines are made to the width of the terminal by hand: a table of this size costs a tenth of what a general
one does, and it is drawn several times a second beside a busy link.
"""

from __future__ import annotations

from time import monotonic
from typing import TYPE_CHECKING

from mavstack.cli.common.live_display import LiveDisplay, Text
from mavstack.cli.watch.snapshot import duration_text, loss_text, rate_text, size_text, take
from mavstack.cli.watch.summary import message_order

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.cli.watch.follower import Follower
    from mavstack.cli.watch.observer import Heard
    from mavstack.cli.watch.snapshot import Member, Picture, Row

_MARK = 1.0
_WIDE = 100
_LONGEST_NAME = 28


class LiveTable(LiveDisplay["Picture"]):
    """Shows what a follower hears, on the whole terminal, and leaves the last picture behind."""

    def __init__(self, title: str, follower: Follower, sort: str) -> None:
        super().__init__()
        self._title = title
        self._follower = follower
        self._sort = sort
        self._marked = monotonic()

    def take(self) -> Picture:
        follower = self._follower
        if monotonic() - self._marked >= _MARK:
            self._marked = monotonic()
            follower.observer.traffic.mark()
        return take(follower.observer, self._title, monotonic(), follower.seconds, follower.note)

    def drawn(self, picture: Picture, width: int, height: int) -> list[Text]:
        return draw(picture, width, height, self._sort)


def draw(picture: Picture, width: int, height: int, sort: str = "name") -> list[Text]:
    """The picture in at most `height` lines of at most `width` columns."""
    top = [*_header(picture, width), *_channels(picture), *_members(picture, max(2, height // 6)), Text()]
    bottom = _texts(picture, 4 if height >= 30 else 2)
    room = max(height - len(top) - len(bottom) - 2, 1)
    rows = message_order(picture.rows, sort)
    middle = _table(rows[:room], width, len(picture.members) > 1)
    lines = [*top, *middle, *bottom]
    lines.append(_footer(len(rows) - room, sort))
    for line in lines:
        line.no_wrap = True
        line.truncate(width, overflow="ellipsis")
    return lines[:height]


def _header(picture: Picture, width: int) -> Iterator[Text]:
    clock = "" if picture.seconds is None else duration_text(picture.seconds)
    title = Text(f" {picture.title}", style="bold reverse")
    title.truncate(width - len(clock) - 2, overflow="ellipsis")
    title.append(" " * max(width - title.cell_len - len(clock) - 1, 1) + clock + " ")
    yield title
    totals = picture.totals
    line = Text(" ")
    line.append(rate_text(picture.rate.packets), "bold").append(" msg/s  ")
    line.append(size_text(picture.rate.bytes), "bold").append("/s  ")
    line.append(f"{picture.selected} packets  ")
    line.append("lost ").append(loss_text(totals.heard), _loss_style(totals.heard))
    line.append("  bad ").append(size_text(totals.bad_bytes), "yellow" if totals.bad_bytes else "")
    line.append(f"  unknown {totals.unknown}  signed {totals.signed}")
    yield line
    if picture.note:
        yield Text(f" {picture.note}", style="yellow")


def _channels(picture: Picture) -> Iterator[Text]:
    """The quality of each channel, where there are several."""
    if len(picture.channels) < 2:
        return
    shown = sorted(picture.channels, key=lambda channel: -channel.packets)[:4]
    for channel in shown:
        line = Text(f" {channel.name}", style="blue")
        line.append(f"  {channel.packets} packets  lost ", "default")
        line.append(loss_text(channel.heard), _loss_style(channel.heard) or "default")
        line.append(f"  bad {size_text(channel.bad_bytes)}", "default")
        yield line
    if len(picture.channels) > len(shown):
        yield Text(f" … {len(picture.channels) - len(shown)} more channels", style="dim")


def _members(picture: Picture, most: int) -> Iterator[Text]:
    members = sorted(picture.members, key=lambda member: (not member.identity.autopilot, member.system))
    shown = members if len(members) <= most else members[: most - 1]
    for member in shown:
        yield _member(member)
    if len(members) > len(shown):
        yield Text(f" … {len(members) - len(shown)} more components", style="dim")


def _member(member: Member) -> Text:
    identity = member.identity
    line = Text(" ").append(f"{member.source:<7}", "bold magenta").append("  ")
    line.append("  ".join(word for word in (identity.type_name or "unknown", identity.autopilot) if word))
    if identity.armed is not None:
        line.append("  ARMED" if identity.armed else "  disarmed", "bold red" if identity.armed else "green")
    if identity.mode:
        line.append(f"  {identity.mode}", "bold yellow")
    if identity.state:
        line.append(f"  {identity.state}", "dim")
    if member.heard.lost:
        line.append("  lost ", "dim").append(loss_text(member.heard), _loss_style(member.heard))
    return line


def _table(rows: list[Row], width: int, sources: bool) -> Iterator[Text]:
    name = min(max([len(row.name) for row in rows] + [7]), _LONGEST_NAME)
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
        yield _with_values(line, row, width)


def _with_values(line: Text, row: Row, width: int) -> Text:
    between = "  " if width >= _WIDE else " "
    for value in row.values():
        if line.cell_len >= width:
            break
        line.append(f"{value.name} ", "dim").append(value.text, "default").append(between)
    line.rstrip()
    return line


def _texts(picture: Picture, most: int) -> list[Text]:
    if not picture.texts:
        return []
    return [Text(), *(Text(f" {text}", style="yellow") for text in picture.texts[-most:])]


def _footer(hidden: int, sort: str) -> Text:
    ways = (
        "--filter NAME or a taller window"
        if sort == "rate"
        else "--sort rate, --filter NAME, a taller window"
    )
    more = f"{hidden} more: {ways} · " if hidden > 0 else ""
    return Text(f" {more}Ctrl-C ends", style="dim")


def _loss_style(heard: Heard) -> str:
    return "bold red" if heard.loss >= 0.1 else "yellow" if heard.loss >= 0.01 else ""
