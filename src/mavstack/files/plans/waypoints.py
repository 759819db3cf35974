"""Waypoint files, `QGC WPL`, of Mission Planner, MAVProxy and older QGC: one type of plan in a file.

    QGC WPL 110
    index  current  frame  command  param1 … param4  latitude  longitude  altitude  autocontinue

In 110 the first item is the home; all programs read it so, and ArduPilot replaces it by its own home. A file
whose first item cannot be a home (such as a take-off) has none, which is reported. Mission Planner writes an
empty item if it does not know the home. In 120 there is no home, and jumps count from 0. Version 100 has
other columns and seven commands of its own:

    index frame action param3 param4 param1 param2 current longitude latitude altitude (unused) autocontinue

Items are counted by their order, as all programs do; a different index is reported. A file with fence items
or rally points is a fence or rally file; MAVProxy writes these without a home, Mission Planner with one, and
it drops the first item if its index is 0. So they are written without a home, from index 1. Numbers are
written exactly; NaN as `nan`, which Mission Planner does not read.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import isinf, nan
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.errors import PlanFileError
from mavstack.files.plans.fence import FENCE_COMMANDS
from mavstack.files.plans.model import (
    CMD,
    FRAME,
    PLAN_NAMES,
    PlanFile,
    home_item,
    home_of,
    item_of,
    params_of,
    plain_frame,
    with_jumps_shifted,
)
from mavstack.files.plans.parsing import bounded, first_line, lines_of, number_text, shown
from mavstack.services.frames import GLOBAL_FRAMES
from mavstack.services.mission import PlanType

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from mavstack.files.plans.parsing import Line, Report
    from mavstack.services.mission import MissionItem

#: The MAV_CMD of each action number in files of version 100.
_OLD_ACTIONS: Final[Mapping[int, int]] = MappingProxyType(
    {
        2: CMD.NAV_TAKEOFF,
        3: CMD.NAV_RETURN_TO_LAUNCH,
        4: CMD.NAV_LAND,
        24: CMD.NAV_TAKEOFF,
        25: CMD.NAV_WAYPOINT,
        26: CMD.NAV_LAND,
        27: CMD.NAV_LOITER_UNLIM,
    }
)
_OTHER_KINDS: Final[Mapping[int, PlanType]] = MappingProxyType(
    {**dict.fromkeys(FENCE_COMMANDS, PlanType.FENCE), CMD.NAV_RALLY_POINT: PlanType.RALLY}
)


@dataclass(frozen=True, slots=True)
class _Columns:
    """The columns of a version."""

    count: int
    frame: int
    command: int
    params: tuple[int, ...]
    autocontinue: int


_NEWER: Final = _Columns(12, 2, 3, (4, 5, 6, 7, 8, 9, 10), 11)
_OLDER: Final = _Columns(13, 1, 2, (5, 6, 3, 4, 9, 8, 10), 12)
_NAMES: Final = (
    *(f"param{number}" for number in range(1, 5)),
    "the latitude",
    "the longitude",
    "the altitude",
)


def recognise(text: str) -> bool:
    """Return whether the text begins as a file of this format."""
    line = first_line(text)
    return line is not None and [word.upper() for word in line.words[:2]] == ["QGC", "WPL"]


def parse(text: str, name: str = "") -> PlanFile:
    """Read the text of a file."""
    lines = lines_of(text, name)
    header = next(lines, None)
    if header is None or not recognise(text):
        raise PlanFileError("it does not begin with QGC WPL", name)
    version = " ".join(header.words[2:])
    if version not in ("100", "110", "120"):
        raise header.wrong(f"version {shown(version)} is not supported, only 100, 110 and 120")
    notes: list[str] = []
    items = _read_items(lines, version, notes)
    home = None
    if version != "120" and _is_home(items, notes):
        home, items = home_of(items[0]), with_jumps_shifted(items[1:], -1)
    read = replace(_sorted_out(items), home=home)
    return replace(read, notes=tuple(notes))


def write(plan: PlanFile, report: Report) -> str:
    """Write one plan as text, the mission if there is one; `report` collects the losses."""
    kinds = plan.kinds or (PlanType.MISSION,)
    for kind in kinds[1:]:
        report.losses.append(f"the {PLAN_NAMES[kind]}, as this format holds one type of plan")
    items = plan.plan(kinds[0]).items
    if kinds[0] == PlanType.MISSION:
        numbered = list(enumerate((home_item(plan.home), *with_jumps_shifted(items, 1))))
        numbered = numbered if items or plan.home else []
    else:
        if plan.home is not None:
            report.notes.append(f"a file of a {PLAN_NAMES[kinds[0]]} has no home in this format")
        numbered = list(enumerate(items, 1))
    return "".join(["QGC WPL 110\n", *(_text(seq, item, report) for seq, item in numbered)])


def _read_items(lines: Iterable[Line], version: str, notes: list[str]) -> tuple[MissionItem, ...]:
    columns = _OLDER if version == "100" else _NEWER
    items: list[MissionItem] = []
    first, counted = 0, True
    for line in lines:
        if len(line.words) != columns.count:
            raise line.wrong(f"has {len(line.words)} columns instead of {columns.count}")
        index = line.integer(0, "the index", 2**31)
        first = first if items else index
        counted = counted and index == first + len(items)
        items.append(_read_item(line, columns, old=version == "100"))
        bounded(items, line.name, beside=1)  # `beside`: the home position
    if not counted:
        notes.append("the indexes of the items are not consecutive: the items are counted by their order")
    return tuple(items)


def _read_item(line: Line, columns: _Columns, *, old: bool) -> MissionItem:
    command = line.integer(columns.command, "the command", 0xFFFF)
    if old:
        if command not in _OLD_ACTIONS:
            raise line.wrong(f"version 100 has no action {command}")
        command = _OLD_ACTIONS[command]
    values = [line.number_at(at, label) for at, label in zip(columns.params, _NAMES, strict=True)]
    return item_of(
        command,
        values,
        line.integer(columns.frame, "the frame", 0xFF),
        autocontinue=line.integer(columns.autocontinue, "autocontinue", 255) != 0,
    )


def _is_home(items: tuple[MissionItem, ...], notes: list[str]) -> bool:
    """Return whether the first item is the home; a fence file need not have one."""
    if not items or items[0].command in _OTHER_KINDS:
        return False
    first = items[0]
    if first.command not in (0, CMD.NAV_WAYPOINT) or first.frame not in GLOBAL_FRAMES:
        notes.append(f"its first item is {first.name} instead of the home: it is read as an item to fly")
        return False
    if first.frame != FRAME.GLOBAL:
        notes.append("its first item is read as the home, as all programs do with this format")
    return True


def _sorted_out(items: tuple[MissionItem, ...]) -> PlanFile:
    """Return the items in the plans that they belong to."""
    kinds = {_OTHER_KINDS.get(item.command, PlanType.MISSION) for item in items}
    if len(kinds) != 1:  # a mixture of plan types is read as a mission; validation reports the wrong items
        return PlanFile.of(items)
    kind = kinds.pop()
    of_fence, of_rally = kind == PlanType.FENCE, kind == PlanType.RALLY
    if of_fence or of_rally:
        return PlanFile.of(fence=items if of_fence else (), rally=items if of_rally else ())
    return PlanFile.of(items)


def _text(seq: int, item: MissionItem, report: Report) -> str:
    head = (seq, int(seq == 0), plain_frame(item.frame), int(item.command))
    params = params_of(item)
    if any(map(isinf, params)):
        report.losses.append(f"the infinite params of item {seq}")
    values = [number_text(nan if isinf(value) else value) for value in params]
    return "\t".join([*map(str, head), *values, str(int(item.autocontinue))]) + "\n"
