"""The live display of a fleet: a map of tracks, one line per vehicle, and the last status texts."""

from __future__ import annotations

from time import monotonic
from typing import TYPE_CHECKING

from mavstack.cli.common.character_map import MapObject, draw_map
from mavstack.cli.common.live_display import LiveDisplay, Text
from mavstack.cli.watch.snapshot import elapsed_text

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mavstack.cli.common.character_map import Cell, CharacterMap
    from mavstack.cli.demo.fleet_state import FleetSnapshot, FleetState, FleetVehicle

_STYLES = ("cyan", "green", "yellow", "magenta", "blue", "red", "bright_white")
_MIN_MAP_ROWS, _MAX_TEXTS = 4, 6
_WIDE = 100
#: Seconds without a HEARTBEAT after which a vehicle is shown as silent.
_MAX_SILENCE = 3.0
#: Battery percentages below which the bar is yellow, and red.
_LOW, _CRITICAL = 30, 15
_BAR_WIDTH = 8


class FleetDisplay(LiveDisplay["FleetSnapshot"]):
    """The live display of a fleet."""

    def __init__(self, title: str, fleet: FleetState) -> None:
        super().__init__()
        self._title, self._fleet = title, fleet
        self._started = monotonic()

    def snapshot(self) -> FleetSnapshot:
        """Return a snapshot of the fleet."""
        return self._fleet.snapshot(monotonic())

    def lines(self, snapshot: FleetSnapshot, width: int, height: int) -> list[Text]:
        """Return the lines of a snapshot."""
        title = f"{self._title}: {self._fleet.parts[-1]}" if self._fleet.parts else self._title
        return render(snapshot, title, width, height, snapshot.now - self._started)


def render(snapshot: FleetSnapshot, title: str, width: int, height: int, seconds: float) -> list[Text]:
    """Render a snapshot in at most `height` lines of at most `width` columns."""
    top = [_title(title, width, seconds)]
    table = [*_table(snapshot, width)]
    texts = [*_status_texts(snapshot, min(_MAX_TEXTS, max(height // 6, 1)))]
    bottom = [*table, Text(), *texts, Text(" Ctrl-C ends", style="dim")]
    available = height - len(top) - len(bottom) - 1
    lines = [*top, *_map(snapshot, width, available), *bottom]
    for line in lines:
        line.no_wrap = True
        line.truncate(width, overflow="ellipsis")
    return lines[:height]


def style_of(vehicle: FleetVehicle) -> str:
    """Return the colour of a vehicle on the map, in the table and in the texts."""
    return _STYLES[(vehicle.system - 1) % len(_STYLES)]


def _title(title: str, width: int, seconds: float) -> Text:
    clock = elapsed_text(seconds)
    line = Text(f" {title}", style="bold reverse")
    line.truncate(width - len(clock) - 2, overflow="ellipsis")
    return line.append(" " * max(width - line.cell_len - len(clock) - 1, 1) + clock + " ")


def _map(snapshot: FleetSnapshot, width: int, height: int) -> Iterator[Text]:
    if height < _MIN_MAP_ROWS:
        return
    objects = [
        MapObject(
            _symbol(each.system),
            style_of(each),
            list(each.track),
            None if each.latitude is None or each.longitude is None else (each.latitude, each.longitude),
        )
        for each in snapshot.vehicles
    ]
    drawn = draw_map(objects, width - 2, height - 1)
    for row in drawn.rows:
        yield _row(row)
    yield _scale(drawn, width)


def _row(cells: list[Cell]) -> Text:
    line = Text(" ")
    for cell in cells:
        line.append(cell.symbol, cell.style)
    return line


def _scale(drawn: CharacterMap, width: int) -> Text:
    bar = f"├{'─' * max(drawn.bar - 2, 0)}┤ {drawn.bar_metres} m" if drawn.bar else ""
    return Text(f"{bar}   N ↑ ".rjust(width - 1), style="dim")


def _symbol(system: int) -> str:
    """Return the character of a system id on the map: 1 to 9, then letters."""
    return "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZ"[system] if system < 36 else "*"


def _id_text(system: int) -> str:
    """Return a system id, after its symbol on the map if that is another."""
    return str(system) if _symbol(system) in (str(system), "*") else f"{_symbol(system)}{system}"


def _table(snapshot: FleetSnapshot, width: int) -> Iterator[Text]:
    wide = width >= _WIDE
    name, mode = (26, 13) if wide else (21, 11)
    heading, battery = (f"{'HDG':>5}  ", 14) if wide else ("  ", 5)
    head = f" ID  {'VEHICLE':<{name}}{'MODE':<{mode}}{'':<9}{'HEIGHT':>8}{'SPEED':>9}"
    yield Text(f"{head}{heading}{'BATTERY' if wide else 'BATT':<{battery}}ITEM", style="dim")
    for vehicle in snapshot.vehicles:
        yield _line(vehicle, snapshot.now, name, mode, wide)


def _line(vehicle: FleetVehicle, now: float, name_width: int, mode_width: int, wide: bool) -> Text:
    identity = vehicle.identity
    name = f"{identity.autopilot} {identity.type_name}"
    line = Text().append(f"{_id_text(vehicle.system):>3}  ", f"bold {style_of(vehicle)}")
    silence = now - vehicle.last_heartbeat
    if silence > _MAX_SILENCE:
        return line.append(f"{name}  silent for {silence:.0f} s", "dim")
    line.append(f"{name[: name_width - 1]:<{name_width}}")
    line.append(f"{identity.mode[: mode_width - 1]:<{mode_width}}", "yellow")
    line.append(f"{'ARMED' if identity.armed else 'disarmed':<9}", "bold red" if identity.armed else "green")
    line.append(f"{vehicle.height:>6.1f} m{vehicle.speed:>5.1f} m/s")
    line.append(f"{vehicle.heading:>4.0f}°  " if wide else "  ")
    line.append_text(_battery(vehicle.battery, wide))
    if vehicle.item is not None:
        line.append(f"{vehicle.item}" + (f"/{vehicle.items}" if vehicle.items else ""))
    return line


def _battery(percent: int | None, wide: bool) -> Text:
    if percent is None:
        return Text(" " * (14 if wide else 5))
    style = "red" if percent < _CRITICAL else "yellow" if percent < _LOW else "green"
    if not wide:
        return Text(f"{percent:>3}% ", style)
    full = round(percent / 100 * _BAR_WIDTH)
    line = Text("█" * full, style).append("░" * (_BAR_WIDTH - full), "dim")
    return line.append(f" {percent:>3}% ", "default")


def _status_texts(snapshot: FleetSnapshot, maximum: int) -> Iterator[Text]:
    for _, system, text in snapshot.texts[-maximum:]:
        vehicle = snapshot.vehicle(system)
        style = f"bold {style_of(vehicle)}" if vehicle is not None else "bold"
        yield Text(" ").append(f"{_symbol(system)}  ", style).append(text, "default")
