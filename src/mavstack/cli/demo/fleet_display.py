"""The live picture of a fleet: a map of tracks, a line a vehicle, and what the vehicles said last."""

from __future__ import annotations

from time import monotonic
from typing import TYPE_CHECKING

from mavstack.cli.common.character_map import MapObject, draw_map
from mavstack.cli.common.live_display import LiveDisplay, Text
from mavstack.cli.watch.snapshot import duration_text

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.cli.common.character_map import Cell, CharacterMap
    from mavstack.cli.demo.fleet_state import FleetWatch, Moment, Seen

_STYLES = ("cyan", "green", "yellow", "magenta", "blue", "red", "bright_white")
_LEAST_MAP, _MOST_TEXTS = 4, 6
_WIDE = 100
_SILENT = 3.0
_LOW, _CRITICAL = 30, 15
_BAR = 8


class FleetPicture(LiveDisplay["Moment"]):
    """Shows what a fleet does, on the whole terminal, and leaves the last picture behind."""

    def __init__(self, title: str, watch: FleetWatch) -> None:
        super().__init__()
        self._title, self._watch = title, watch
        self._began = monotonic()

    def take(self) -> Moment:
        return self._watch.moment(monotonic())

    def drawn(self, taken: Moment, width: int, height: int) -> list[Text]:
        return draw(taken, self._title, width, height, taken.now - self._began)


def draw(moment: Moment, title: str, width: int, height: int, seconds: float) -> list[Text]:
    """The picture in at most `height` lines of at most `width` columns."""
    top = [_title(title, width, seconds)]
    table = [*_table(moment, width)]
    texts = [*_texts(moment, min(_MOST_TEXTS, max(height // 6, 1)))]
    bottom = [*table, Text(), *texts, Text(" Ctrl-C ends", style="dim")]
    room = height - len(top) - len(bottom) - 1
    lines = [*top, *_map(moment, width, room), *bottom]
    for line in lines:
        line.no_wrap = True
        line.truncate(width, overflow="ellipsis")
    return lines[:height]


def style_of(seen: Seen) -> str:
    """The colour of a vehicle: the same on the map, in the table and in the texts."""
    return _STYLES[(seen.system - 1) % len(_STYLES)]


def _title(title: str, width: int, seconds: float) -> Text:
    clock = duration_text(seconds)
    line = Text(f" {title}", style="bold reverse")
    line.truncate(width - len(clock) - 2, overflow="ellipsis")
    return line.append(" " * max(width - line.cell_len - len(clock) - 1, 1) + clock + " ")


def _map(moment: Moment, width: int, room: int) -> Iterator[Text]:
    if room < _LEAST_MAP:
        return
    things = [
        MapObject(
            _sign(seen.system),
            style_of(seen),
            list(seen.track),
            None if seen.latitude is None or seen.longitude is None else (seen.latitude, seen.longitude),
        )
        for seen in moment.vehicles
    ]
    drawn = draw_map(things, width - 2, room - 1)
    for row in drawn.rows:
        yield _row(row)
    yield _scale(drawn, width)


def _row(cells: list[Cell]) -> Text:
    line = Text(" ")
    for cell in cells:
        line.append(cell.sign, cell.style)
    return line


def _scale(drawn: Map, width: int) -> Text:
    bar = f"├{'─' * max(drawn.bar - 2, 0)}┤ {drawn.bar_metres} m" if drawn.bar else ""
    return Text(f"{bar}   N ↑ ".rjust(width - 1), style="dim")


def _sign(system: int) -> str:
    """One character for a system id on the map: 1 to 9, then letters."""
    return "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZ"[system] if system < 36 else "*"


def _numbered(system: int) -> str:
    """A system id, with its sign on the map if that is another."""
    return str(system) if _sign(system) in (str(system), "*") else f"{_sign(system)}{system}"


def _table(moment: Moment, width: int) -> Iterator[Text]:
    wide = width >= _WIDE
    kind, mode = (26, 13) if wide else (21, 11)
    heading, battery = (f"{'HDG':>5}  ", 14) if wide else ("  ", 5)
    head = f" ID  {'VEHICLE':<{kind}}{'MODE':<{mode}}{'':<9}{'HEIGHT':>8}{'SPEED':>9}"
    yield Text(f"{head}{heading}{'BATTERY' if wide else 'BATT':<{battery}}ITEM", style="dim")
    for seen in moment.vehicles:
        yield _line(seen, moment.now, kind, mode, wide)


def _line(seen: Seen, now: float, kind: int, mode: int, wide: bool) -> Text:
    identity, style = seen.identity, style_of(seen)
    line = Text().append(f"{_numbered(seen.system):>3}  ", f"bold {style}")
    if now - seen.heard > _SILENT:
        return line.append(
            f"{identity.autopilot} {identity.type_name}  silent for {now - seen.heard:.0f} s", "dim"
        )
    line.append(f"{f'{identity.autopilot} {identity.type_name}'[: kind - 1]:<{kind}}")
    line.append(f"{identity.mode[: mode - 1]:<{mode}}", "yellow")
    line.append(f"{'ARMED' if identity.armed else 'disarmed':<9}", "bold red" if identity.armed else "green")
    line.append(f"{seen.height:>6.1f} m{seen.speed:>5.1f} m/s")
    line.append(f"{seen.heading:>4.0f}°  " if wide else "  ")
    line.append_text(_battery(seen.battery, wide))
    if seen.item is not None:
        line.append(f"{seen.item}" + (f"/{seen.items}" if seen.items else ""))
    return line


def _battery(percent: int | None, wide: bool) -> Text:
    if percent is None:
        return Text(" " * (14 if wide else 5))
    style = "red" if percent < _CRITICAL else "yellow" if percent < _LOW else "green"
    if not wide:
        return Text(f"{percent:>3}% ", style)
    full = round(percent / 100 * _BAR)
    line = Text("█" * full, style).append("░" * (_BAR - full), "dim")
    return line.append(f" {percent:>3}% ", "default")


def _texts(moment: Moment, most: int) -> Iterator[Text]:
    for _, system, text in moment.texts[-most:]:
        seen = moment.vehicle(system)
        style = f"bold {style_of(seen)}" if seen is not None else "bold"
        yield Text(" ").append(f"{_sign(system)}  ", style).append(text, "default")
