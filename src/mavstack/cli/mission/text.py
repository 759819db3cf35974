"""A plan item as text: its params with their official labels and units, its place, its altitude."""

from __future__ import annotations

from functools import cache
from math import isfinite, isnan
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.dialects import Dialect, ardupilotmega
from mavstack.files.plans.model import CMD, FRAME, params_of, plain_frame
from mavstack.services.frames import GLOBAL_FRAMES

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.dialects.model import EnumDefinition, EnumEntry, EnumParam
    from mavstack.services.mission import MissionItem

#: The reference of the altitude in each MAV_FRAME.
_ALTITUDE_REFERENCES: Final[Mapping[int, str]] = MappingProxyType(
    {
        FRAME.GLOBAL: " above sea",
        FRAME.GLOBAL_RELATIVE_ALT: " above home",
        FRAME.GLOBAL_TERRAIN_ALT: " above ground",
    }
)
_UNITS: Final[Mapping[str, str]] = MappingProxyType({"deg": "°", "": ""})


@cache
def entry_of(command: int) -> EnumEntry | None:
    """Return the definition of a command; None if it is not defined."""
    return ardupilotmega.MavCmd.definition().entry(command)


def has_place(item: MissionItem) -> bool:
    """Return whether params 5 and 6 of an item are a latitude and a longitude."""
    entry = entry_of(item.command)
    located = entry is not None and entry.has_location and item.frame in GLOBAL_FRAMES
    return located and all(map(isfinite, (item.param5, item.param6))) and bool(item.param5 or item.param6)


def flies_to_position(item: MissionItem) -> bool:
    """Return whether the vehicle flies to the place of an item."""
    entry = entry_of(item.command)
    return has_place(item) and entry is not None and entry.is_destination


def place_text(item: MissionItem) -> str:
    """Return the place of an item, in degrees or in metres of a local frame."""
    entry = entry_of(item.command)
    if entry is None or not entry.has_location or item.frame == FRAME.MISSION:
        return ""
    if item.frame not in GLOBAL_FRAMES:
        return f"{number(item.param5)} m, {number(item.param6)} m"
    if not has_place(item):
        return "here" if entry.is_destination else ""
    return f"{item.param5:.7f} {item.param6:.7f}"


def altitude_text(item: MissionItem) -> str:
    """Return the altitude of an item with its reference; empty if it has none."""
    entry = entry_of(item.command)
    frame = plain_frame(item.frame)
    if entry is None or not (entry.has_location or entry.has_altitude_only) or frame == FRAME.MISSION:
        return ""
    if isnan(item.param7) or not any(param.index == 7 and param.label for param in entry.params):
        return ""
    return f"{number(item.param7)} m{_ALTITUDE_REFERENCES.get(frame, f' ({frame_name(frame)})')}"


def frame_name(frame: int) -> str:
    """Return the official name of a frame without MAV_FRAME_."""
    return FRAME(frame).name if frame in set(FRAME) else f"frame {frame}"


def params_text(item: MissionItem, first: int = 0) -> str:
    """Return the params of an item that are not 0; `first` is the number of the first item of its plan."""
    entry = entry_of(item.command)
    shown = 4 if entry is not None and entry.has_location and item.frame != FRAME.MISSION else 7
    shown = 6 if entry is not None and entry.has_altitude_only else shown
    known = {} if entry is None else {param.index: param for param in entry.params}
    texts = []
    for index, value in enumerate(params_of(item)[:shown], 1):
        if item.command == CMD.DO_JUMP and index == 1:
            texts.append(f"to {number(value + first)}")
        elif value and not isnan(value):
            texts.append(_param_text(index, known.get(index), value))
    return ", ".join(texts)


def number(value: float) -> str:
    """Return a number without decimals if it is whole, else with six digits."""
    if not isfinite(value):
        return f"{value:g}"
    return f"{value:.0f}" if value == int(value) and abs(value) < 1e9 else f"{value:.6g}"


def length_text(metres: float) -> str:
    """Return a distance in metres or kilometres."""
    return f"{metres:.0f} m" if metres < 9999.5 else f"{metres / 1000:.1f} km"


def _param_text(index: int, param: EnumParam | None, value: float) -> str:
    if param is None or not param.label:
        return f"param{index} {number(value)}"
    name = _entry_name(param.enum, value)
    if name:
        return f"{param.label} {name}"
    unit = _UNITS.get(param.units, f" {param.units}")
    return f"{param.label} {number(value)}{unit}"


def _entry_name(enum: str, value: float) -> str:
    """Return the name of an enum's value without the prefix of the enum."""
    definition = _enum(enum) if enum else None
    entry = None if definition is None or value != int(value) else definition.entry(int(value))
    if definition is None or entry is None:
        return ""
    return entry.name.removeprefix(f"{definition.name}_")


@cache
def _enum(name: str) -> EnumDefinition | None:
    return Dialect.load("ardupilotmega").definition.enums_by_name.get(name)
