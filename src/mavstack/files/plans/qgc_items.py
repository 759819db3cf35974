"""The items of a mission in QGroundControl's JSON.

A SimpleItem is one MAV_CMD: {"command", "frame", "params": [7 numbers, null for NaN], "autoContinue",
"doJumpId"}. A DO_JUMP names the doJumpId of its target. Older forms have four params and a "coordinate", and
before that "param1" to "param4" and an "id".

A ComplexItem is a pattern that QGC draws. For surveys and corridor scans the file holds the items to fly,
and they are read. For a landing pattern it holds positions; the items are DO_LAND_START, commands that stop
photos and videos, the approach, and the landing. For a structure scan, and surveys of older versions, it
holds only a polygon, from which QGC computes the items each time; they cannot be read. Every pattern that
was not read, or only in part, is reported as a problem, since the mission without it is a different one.
"""

from __future__ import annotations

from dataclasses import replace
from math import isfinite, isinf, nan
from typing import TYPE_CHECKING, Any, Final

from mavstack.errors import PlanFileError
from mavstack.files.plans.json_tree import JsonValue, as_json
from mavstack.files.plans.model import CMD, FRAME, item_of, params_of, plain_frame
from mavstack.services.mission import MissionItem

if TYPE_CHECKING:
    from collections.abc import Iterable

    from mavstack.files.plans.parsing import Report

_LANDINGS: Final = ("fwLandingPattern", "vtolLandingPattern")


class _Items:
    """The items read so far, and the ids by which jumps refer to them."""

    def __init__(self, problems: list[str], notes: list[str]) -> None:
        self.problems, self.notes = problems, notes
        self.items: list[MissionItem] = []
        self._ids: dict[int, int] = {}
        self._inner_ids: dict[int, int] = {}

    def add(self, item: MissionItem, jump_id: int | None, *, inner: bool = False) -> None:
        """Add an item; ids inside a pattern (`inner`) count only where no other item has the same id."""
        if jump_id is not None:
            (self._inner_ids if inner else self._ids).setdefault(jump_id, len(self.items))
        self.items.append(item)

    def finished(self) -> list[MissionItem]:
        """Return the items, with indexes in the list as the targets of jumps."""
        return [self._resolved(index, item) for index, item in enumerate(self.items)]

    def _resolved(self, index: int, item: MissionItem) -> MissionItem:
        wanted = item.param1
        if item.command != CMD.DO_JUMP or not isfinite(wanted):
            return item
        known = {**self._inner_ids, **self._ids}
        if not known:  # a file written by hand, whose items have no doJumpId
            return replace(item, param1=wanted - 1)
        target = known.get(int(wanted)) if wanted == int(wanted) else None
        if target is None:
            self.problems.append(f"item {index + 1} jumps to doJumpId {wanted:g}, which no item has")
            return replace(item, param1=-1.0)
        return replace(item, param1=float(target))


def read_items(mission: JsonValue, version: int, problems: list[str], notes: list[str]) -> list[MissionItem]:
    """Return the items of a mission, with patterns resolved."""
    found = _Items(problems, notes)
    for tree in mission.get("items").elements():
        kind = tree.find("type")
        name = "SimpleItem" if kind is None else kind.text()
        if name in ("SimpleItem", "missionItem"):
            found.add(_simple(tree), _jump_id(tree))
        elif name == "ComplexItem":
            _read_pattern(tree, found)
        else:
            raise tree.wrong(f"has the unknown item type {name[:40]!a}")
    apart = mission.find("complexItems") if version == 1 else None
    if apart is not None:
        for tree in apart.elements():
            _skip(tree, "survey", found)
    return found.finished()


def mission_json(items: Iterable[MissionItem], report: Report) -> list[dict[str, Any]]:
    """Return the items as SimpleItems."""
    return [_simple_json(index + 1, item, report) for index, item in enumerate(items)]


def _simple(tree: JsonValue) -> MissionItem:
    params = tree.find("params")
    if params is None:
        values = [tree.get(f"param{number}").number() for number in range(1, 5)]
    else:
        values = [element.number() for element in params.elements()]
    if len(values) == 4:
        values += tree.get("coordinate").numbers(3)
    if len(values) != 7:
        raise (params or tree).wrong(f"has {len(values)} params instead of 7")
    proceeds = tree.find("autoContinue")
    return item_of(
        tree.get("command").integer(0, 0xFFFF),
        values,
        tree.get("frame").integer(0, 0xFF),
        autocontinue=True if proceeds is None else proceeds.flag(),
    )


def _jump_id(tree: JsonValue) -> int | None:
    found = tree.find("doJumpId") or tree.find("id")
    jump_id = None if found is None else found.integer(-(2**31), 2**31)
    return jump_id if jump_id is not None and jump_id >= 0 else None


def _read_pattern(tree: JsonValue, found: _Items) -> None:
    kind_tree = tree.find("complexItemType")
    kind = "pattern" if kind_tree is None else kind_tree.text()[:40]
    style = tree.find("TransectStyleComplexItem")
    flown = None if style is None else style.find("Items")
    if flown is not None:
        for inner in flown.elements():
            found.add(_simple(inner), _jump_id(inner), inner=True)
    elif kind in _LANDINGS:
        try:
            items = _landing(tree, kind, found)
        except PlanFileError as error:
            _skip(tree, kind, found, f": {error.where} {error.problem}")
            return
        for item in items:
            found.add(item, None)
    else:
        _skip(tree, kind, found)


def _skip(tree: JsonValue, kind: str, found: _Items, why: str = "") -> None:
    reason = why or ", since the file holds no items of it: plan it again, or save the plan from the vehicle"
    found.problems.append(f"{tree.path}: the {ascii(kind)[1:-1]} was not read{reason}")


def _landing(tree: JsonValue, kind: str, found: _Items) -> list[MissionItem]:
    """Return the items of a landing pattern."""
    approach = tree.find("landingApproachCoordinate") or tree.get("loiterCoordinate")
    land = tree.get("landCoordinate")
    both = tree.find("altitudesAreRelative")
    relative = [
        (both or tree.get(older)).flag() for older in ("loiterAltitudeRelative", "landAltitudeRelative")
    ]
    frames = [int(FRAME.GLOBAL_RELATIVE_ALT if each else FRAME.GLOBAL) for each in relative]
    items = [MissionItem(CMD.DO_LAND_START, frame=FRAME.MISSION)]
    if _flag(tree, "stopTakingPhotos"):
        items.append(MissionItem(CMD.DO_SET_CAM_TRIGG_DIST, frame=FRAME.MISSION))
        items.append(_reserved(CMD.IMAGE_STOP_CAPTURE, 1))
    if _flag(tree, "stopVideoPhotos"):
        items.append(_reserved(CMD.VIDEO_STOP_CAPTURE, 1))
    items.append(_approach(tree, [element.finite() for element in approach.elements(3)], frames[0]))
    place = [element.finite() for element in land.elements(3)]
    if kind == "vtolLandingPattern":
        items.append(item_of(CMD.NAV_VTOL_LAND, (0.0, 0.0, 0.0, nan, *place), frames[1]))
    else:
        items.append(item_of(CMD.NAV_LAND, (0.0, 0.0, 0.0, 0.0, *place), frames[1]))
    if _flag(tree, "useDoChangeSpeed"):
        found.problems.append(f"{tree.path}: the approach speed was not read")
    return items


def _approach(tree: JsonValue, place: list[float], frame: int) -> MissionItem:
    if not _flag(tree, "useLoiterToAlt", default=True):
        return item_of(CMD.NAV_WAYPOINT, (0.0, 0.0, 0.0, nan, *place), frame)
    radius = tree.get("loiterRadius").finite() * (1 if tree.get("loiterClockwise").flag() else -1)
    return item_of(CMD.NAV_LOITER_TO_ALT, (1.0, radius, 0.0, 1.0, *place), frame)


def _reserved(command: int, used: int) -> MissionItem:
    """Return a camera command, whose params after the used ones are reserved."""
    return item_of(command, [0.0] * used + [nan] * (7 - used), FRAME.MISSION)


def _flag(tree: JsonValue, key: str, *, default: bool = False) -> bool:
    found = tree.find(key)
    return default if found is None else found.flag()


def _simple_json(jump_id: int, item: MissionItem, report: Report) -> dict[str, Any]:
    first = item.param1 + 1 if item.command == CMD.DO_JUMP else item.param1
    values = (first, *params_of(item)[1:])
    if any(map(isinf, values)):
        report.losses.append(f"the infinite params of mission item {jump_id}")
    return {
        "autoContinue": item.autocontinue,
        "command": int(item.command),
        "doJumpId": jump_id,
        "frame": plain_frame(item.frame),
        "params": [None if isinf(value) else as_json(value) for value in values],
        "type": "SimpleItem",
    }
