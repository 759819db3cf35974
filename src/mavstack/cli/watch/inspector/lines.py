"""The lines of the inspector's lists: headings and rows, fitted to the width of their list."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from rich.text import Text

from mavstack.cli.common.field_values import HIDDEN, UNKNOWN, raw_hex
from mavstack.cli.common.text import size_text
from mavstack.cli.watch.packet_lines import clock_text
from mavstack.cli.watch.snapshot import elapsed_text, loss_text, rate_text, shorten
from mavstack.cli.watch.trend import sparkline

if TYPE_CHECKING:
    from mavstack.cli.watch.inspector.comparison import ComparisonRow
    from mavstack.cli.watch.inspector.field_table import FieldRow
    from mavstack.cli.watch.inspector.model import Inspector
    from mavstack.cli.watch.inspector.packet_store import StoredPacket
    from mavstack.cli.watch.inspector.source_rows import SourceRow
    from mavstack.cli.watch.observer import SourceCounts
    from mavstack.cli.watch.snapshot import MessageRow
    from mavstack.wire import Packet

#: Minimum width at which each list shows additional columns.
_WIDE_MESSAGES: Final = 52
_WIDE_SOURCES: Final = 52
_WIDE_FIELDS: Final = 70
_MIN_COURSE: Final = 8
_MAX_COURSE: Final = 24
_MIN_COMPARED_WIDTH: Final = 13
_MAX_COMPARED_WIDTH: Final = 22
#: Width of the text with the number of sources for which there is no room.
_MORE_WIDTH: Final = 5
#: Bytes of a packet before its payload, by MAVLink version, and bytes after its payload.
_HEAD_SIZES: Final = MappingProxyType({1: 6, 2: 10})
_CHECKSUM_SIZE: Final = 2
_SIGNATURE_SIZE: Final = 13
#: Width of the offset at the beginning of a line of the hex dump.
_OFFSET_WIDTH: Final = 5


# The line at the top


def status_line(inspector: Inspector, width: int) -> Text:
    """Return the line at the top: what is watched, for how long, rate, loss, recording."""
    whole = inspector.picture.whole
    clock = "" if whole.seconds is None else elapsed_text(whole.seconds)
    line = Text(" ").append(shorten(whole.title, max(width - 50, 12)), "bold")
    line.append(f"  {clock}  ").append(rate_text(whole.rate.packets), "bold").append(" msg/s  ")
    line.append(size_text(whole.rate.bytes), "bold").append("/s  lost ")
    line.append(loss_text(whole.totals.all_sources), loss_style(whole.totals.all_sources))
    if inspector.is_paused:
        line.append("  PAUSED ", "bold reverse")
    return line.append(f"  {inspector.activity}", "yellow") if inspector.activity else line


def loss_style(counts: SourceCounts) -> str:
    """Return the style of a loss: red from 10 %, yellow from 1 %."""
    return "bold red" if counts.loss >= 0.1 else "yellow" if counts.loss >= 0.01 else ""


# sources


def source_heading(width: int) -> Text:
    """Return the heading of the sources."""
    bad = f"{'BAD':>8}" if width >= _WIDE_SOURCES else ""
    return Text(f"{'SOURCE':<{_name_width(width, len(bad) + 15)}}{'HZ':>7}{'LOST':>8}{bad}")


def source_line(row: SourceRow, width: int) -> Text:
    """Return the line of a link, a channel or a component."""
    bad = 8 if width >= _WIDE_SOURCES else 0
    name = _name_width(width, bad + 15)
    line = Text()
    if row.is_component:
        line.append(f"  {row.name}  ", "magenta").append(row.detail)
    else:
        line.append(f"  {row.name}" if row.channel else row.name, "" if row.channel else "bold")
        line.append(f"  {row.detail}", "yellow")
    line.truncate(name, overflow="ellipsis", pad=True)
    line.append(f"{'' if row.rate is None else rate_text(row.rate):>7}")
    line.append(f"{loss_text(row.counts):>8}", loss_style(row.counts))
    if bad:
        text = "" if row.bad_bytes is None else size_text(row.bad_bytes)
        line.append(f"{text:>8}", "yellow" if row.bad_bytes else "")
    return line


# messages


def message_heading(width: int, source: int) -> Text:
    """Return the heading of the messages; `source` is the width of the column of sources."""
    more = f"{'COUNT':>8}{'BYTES/S':>9}" if width >= _WIDE_MESSAGES else ""
    name = _name_width(width, len(more) + source + 7)
    return Text(f"{'MESSAGE':<{name}}{'SOURCE':>{source}}{'HZ':>7}{more}")


def message_line(row: MessageRow, width: int, source: int) -> Text:
    """Return the line of a message; a silent one is dim."""
    silent = row.rate.packets <= 0 and row.count > 1
    more = 17 if width >= _WIDE_MESSAGES else 0
    line = Text(style="dim" if silent else "").append(row.name, "" if silent else "cyan")
    line.truncate(_name_width(width, more + source + 7), overflow="ellipsis", pad=True)
    line.append(f"{row.source:>{source}}", "magenta").append(f"{rate_text(row.rate.packets):>7}", "default")
    if more:
        line.append(f"{row.count:>8}{size_text(row.rate.bytes):>9}", "default")
    return line


# fields


def field_heading(width: int) -> Text:
    """Return the heading of the fields."""
    name, value, raw, course = _field_widths(width)
    line = f"  {'FIELD':<{name}}{'VALUE':<{value}}"
    line += f"{'RAW':<{raw}}" if raw else ""
    return Text(line + ("COURSE" if course else ""))


def field_line(row: FieldRow, width: int, plot_colour: str | None) -> Text:
    """Return the line of a field; `plot_colour` is the colour of its plot, None without one."""
    name, value, raw, course = _field_widths(width)
    line = Text().append("━ " if plot_colour else "  ", plot_colour or "")
    line.append(_cell(str(row.name), name), "cyan").append(
        _cell(row.text, value), "bold" if row.changed else ""
    )
    if raw:
        line.append(_cell(row.raw, raw), "dim")
    if course and row.course:
        line.append(sparkline(row.course, course), plot_colour or "green")
    return line


def _field_widths(width: int) -> tuple[int, int, int, int]:
    """Return the widths of name, value, raw value and course."""
    course = min(max(width // 4, _MIN_COURSE), _MAX_COURSE) if width >= 40 else 0
    raw = 20 if width >= _WIDE_FIELDS else 0
    rest = max(width - 2 - raw - course, 10)
    name = min(rest // 2, 26)
    return name, rest - name, raw, course


# comparison


def comparison_heading(sources: list[str], width: int, first: int) -> Text:
    """Return the heading of a comparison: the sources from the column `first`."""
    name, column, shown = _compared_columns(len(sources), width, first)
    line = Text("FIELD".ljust(name))
    for source in sources[first : first + shown]:
        line.append(_cell(source, column), "magenta")
    hidden = len(sources) - first - shown
    return line.append(f"+{hidden} →") if hidden > 0 else line


def comparison_line(row: ComparisonRow, width: int, first: int) -> Text:
    """Return the line of a field; the name of a field whose values differ is bold."""
    name, column, shown = _compared_columns(len(row.values), width, first)
    line = Text(_cell(str(row.name), name), "bold cyan" if row.differs else "cyan")
    for value in row.values[first : first + shown]:
        text = UNKNOWN if value is None else value.text
        style = "bold" if value is not None and value.changed else "default"
        line.append(_cell(text, column), style)
    return line


def _compared_columns(sources: int, width: int, first: int) -> tuple[int, int, int]:
    """Return the width of the names and of a source, and the number of sources that fit."""
    name = min(max(width // 4, 14), 26)
    rest, wanted = width - name, max(sources - first, 1)
    if wanted * _MIN_COMPARED_WIDTH <= rest:
        return name, min(rest // wanted, _MAX_COMPARED_WIDTH), wanted
    return name, _MIN_COMPARED_WIDTH, max((rest - _MORE_WIDTH) // _MIN_COMPARED_WIDTH, 1)


# packets


def packet_heading(width: int) -> Text:
    """Return the heading of the packets."""
    return Text(f"{'TIME':<13}{'SOURCE':>8} {'SEQ':>3} {'LEN':>3} V  MESSAGE AND BYTES")


def packet_line(entry: StoredPacket, width: int) -> Text:
    """Return the line of a packet: time, source, sequence, length, version, signed or not, bytes."""
    packet = entry.packet
    line = (
        Text().append(f"{clock_text(entry.time):<13}", "dim").append(f"{entry.stream.source:>8}", "magenta")
    )
    line.append(f" {packet.sequence:>3} {len(packet):>3} {packet.version}", "default")
    line.append("s " if packet.signed else "  ", "green")
    line.append(packet.name or f"id {packet.message_id}", "cyan")
    return line.append(f"  {raw_hex(packet)}", "default")


def byte_lines(packet: Packet, width: int) -> Text:
    """Return all bytes of a packet in hexadecimal: head, payload, checksum and signature in colours.

    A packet that holds a secret is not shown.
    """
    data = raw_hex(packet)
    if data == HIDDEN:
        return Text(data)
    values = [data[index : index + 2] for index in range(0, len(data), 2)]
    signature = _SIGNATURE_SIZE if packet.signed else 0
    head = _HEAD_SIZES[packet.version]
    checksum = len(values) - signature - _CHECKSUM_SIZE
    row = max((width - _OFFSET_WIDTH) // 3 // 8 * 8, 4)
    text = Text()
    for index, value in enumerate(values):
        if index % row == 0:
            text.append(("\n" if index else "") + f"{index:>{_OFFSET_WIDTH - 2}}  ", "dim")
        part = "cyan" if index < head else "" if index < checksum else "yellow"
        text.append(f"{value} ", "green" if index >= checksum + _CHECKSUM_SIZE else part)
    return text


def _name_width(width: int, others: int) -> int:
    return max(width - others, 6)


def _cell(text: str, width: int) -> str:
    """Return a text of a width, with a space after it."""
    return f"{shorten(text, width - 1):<{width}}"
