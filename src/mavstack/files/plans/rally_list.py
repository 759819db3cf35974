"""The older rally files of ArduPilot's ground stations.

    RALLY latitude longitude altitude break_altitude landing_direction flags

Altitudes are relative to home, unless flag 4 (ALT_FRAME_VALID) marks flags 8 and 16 as the frame: 0 above
mean sea level, 1 above home, 3 above the terrain. The break altitude, the landing direction and the other
flags have no param in a rally point item; a note tells that they are not used. MAVProxy writes a break
altitude into every point.
"""

from __future__ import annotations

from dataclasses import replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.errors import PlanFileError
from mavstack.files.plans.model import CMD, FRAME, PLAN_NAMES, PlanFile, item_of, plain_frame
from mavstack.files.plans.parsing import bounded, first_line, lines_of, number_text, shown

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mavstack.files.plans.parsing import Line, Report
    from mavstack.services.mission import MissionItem

_COLUMNS: Final = "latitude, longitude, altitude, break altitude, landing direction, flags"
_FRAME_VALID: Final = 4
_FRAME_BITS: Final = 24
_FRAME_SHIFT: Final = 3
#: The MAV_FRAME of each frame number in the flags.
_FRAMES: Final[Mapping[int, int]] = MappingProxyType(
    {0: FRAME.GLOBAL, 1: FRAME.GLOBAL_RELATIVE_ALT, 3: FRAME.GLOBAL_TERRAIN_ALT}
)


def recognise(text: str) -> bool:
    """Return whether the text begins as a file of this format."""
    line = first_line(text)
    return line is not None and line.words[0].upper() == "RALLY"


def parse(text: str, name: str = "") -> PlanFile:
    """Read the text of a file."""
    unused: dict[str, None] = {}
    items = [_read_point(line, unused) for line in lines_of(text, name)]
    if not items:
        raise PlanFileError("it holds no rally points", name)
    notes = (f"not used of the rally points: {', '.join(unused)}",) if unused else ()
    return replace(PlanFile.of(rally=bounded(items, name)), notes=notes)


def write(plan: PlanFile, report: Report) -> str:
    """Write the rally points as text; `report` collects the losses."""
    for kind in plan.kinds:
        if kind != plan.rally.type:
            report.losses.append(f"the {PLAN_NAMES[kind]}")
    if not len(plan.rally):
        raise PlanFileError("this format holds rally points, and the plan has none")
    return "".join(_text(index, item, report) for index, item in enumerate(plan.rally.items))


def _read_point(line: Line, unused: dict[str, None]) -> MissionItem:
    """Return the item of a line; the names of its values that an item cannot hold are added to `unused`."""
    if line.words[0].upper() != "RALLY" or len(line.words) != 7:
        found = f"{shown(line.words[0])} and {len(line.words) - 1} values"
        raise line.wrong(f"it is {found} instead of RALLY and six: {_COLUMNS}")
    place = [line.number_at(at, label) for at, label in ((1, "the latitude"), (2, "the longitude"))]
    altitude = line.number_at(3, "the altitude")
    flags = line.integer(6, "flags", 255)
    for value, label in (
        (line.number_at(4, "the break altitude"), "the break altitude"),
        (line.number_at(5, "the landing direction"), "the landing direction"),
        (flags & 1, "the flag for a favourable wind"),
        (flags & 2, "the flag to land immediately"),
    ):
        if value:
            unused[label] = None
    frame = int(FRAME.GLOBAL_RELATIVE_ALT)
    if flags & _FRAME_VALID:
        named = (flags & _FRAME_BITS) >> _FRAME_SHIFT
        if named not in _FRAMES:
            raise line.wrong(f"flags {flags} mean an altitude above the origin, which no item can hold")
        frame = int(_FRAMES[named])
    params = (0.0, 0.0, 0.0, 0.0, *place, altitude)
    return item_of(CMD.NAV_RALLY_POINT, params, frame, autocontinue=False)


def _text(index: int, item: MissionItem, report: Report) -> str:
    frame = plain_frame(item.frame)
    named = next((name for name, known in _FRAMES.items() if known == frame), None)
    if item.command != CMD.NAV_RALLY_POINT or named is None:
        report.losses.append(f"rally point {index}, a {item.name} in frame {frame}")
        return ""
    if any((item.param1, item.param2, item.param3, item.param4)):
        report.losses.append(f"params 1 to 4 of rally point {index}")
    flags = 0 if frame == FRAME.GLOBAL_RELATIVE_ALT else _FRAME_VALID | named << _FRAME_SHIFT
    place = " ".join(number_text(value) for value in (item.param5, item.param6, item.param7))
    return f"RALLY {place} 0 0 {flags}\n"
