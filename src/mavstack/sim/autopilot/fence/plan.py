"""Fence plans: validation, and conversion into shapes.

A polygon of n corners is n consecutive items of one command, each with n in param 1; a circle is one item
with its radius in param 1. An inconsistent plan is refused as a whole.
"""

from __future__ import annotations

from math import isfinite, nan
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.sim.autopilot.fence_shapes import Circle, Fence, Polygon, Shape

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from mavstack.services.mission import MissionItem, Plan
    from mavstack.sim.motion import LocalFrame

_CMD = common.MavCmd
_F = common.MavFrame
_RESULT = common.MavMissionResult

_POLYGONS = {_CMD.NAV_FENCE_POLYGON_VERTEX_INCLUSION: True, _CMD.NAV_FENCE_POLYGON_VERTEX_EXCLUSION: False}
_CIRCLES = {_CMD.NAV_FENCE_CIRCLE_INCLUSION: True, _CMD.NAV_FENCE_CIRCLE_EXCLUSION: False}
_COMMANDS = frozenset({*_POLYGONS, *_CIRCLES, _CMD.NAV_FENCE_RETURN_POINT})
_FRAMES = frozenset({_F.GLOBAL, _F.GLOBAL_INT, _F.GLOBAL_RELATIVE_ALT, _F.GLOBAL_RELATIVE_ALT_INT})
MIN_CORNERS = 3
_LATITUDE, _LONGITUDE = 90.0, 180.0
_MAX_RADIUS = 1.0e6


def check_fence_item(item: MissionItem) -> int:
    """Validate one item of a fence: MAV_MISSION_RESULT."""
    if item.command not in _COMMANDS:
        return _RESULT.UNSUPPORTED
    if item.frame not in _FRAMES:
        return _RESULT.UNSUPPORTED_FRAME
    if item.command in _POLYGONS and not (item.param1 >= MIN_CORNERS and item.param1 == item.param1 // 1):
        return _RESULT.INVALID_PARAM1
    if item.command in _CIRCLES and not 0 < item.param1 <= _MAX_RADIUS:
        return _RESULT.INVALID_PARAM1
    if not abs(item.param5) <= _LATITUDE:
        return _RESULT.INVALID_PARAM5_X
    return _RESULT.ACCEPTED if abs(item.param6) <= _LONGITUDE else _RESULT.INVALID_PARAM6_Y


def check_fence_plan(plan: Plan) -> int:
    """Validate a whole fence: MAV_MISSION_RESULT."""
    if any(check_fence_item(item) != _RESULT.ACCEPTED for item in plan.items):
        return _RESULT.INVALID
    returns = sum(item.command == _CMD.NAV_FENCE_RETURN_POINT for item in plan.items)
    return _RESULT.INVALID if returns > 1 or _groups(plan.items) is None else _RESULT.ACCEPTED


def read_fence(items: Sequence[MissionItem], frame: LocalFrame) -> Fence:
    """Return the shapes of a plan in local metres; none if the plan is inconsistent."""
    groups = _groups(items)
    if groups is None:
        return Fence()
    returns = (group[0] for group in groups if group[0].command == _CMD.NAV_FENCE_RETURN_POINT)
    point = next(returns, None)
    return Fence(tuple(_shapes(groups, frame)), None if point is None else _return_point(point, frame))


def _return_point(item: MissionItem, frame: LocalFrame) -> tuple[float, float, float]:
    north, east = _place(item, frame)
    return north, east, -item.param7 if isfinite(item.param7) and item.param7 > 0 else nan


def _shapes(groups: Sequence[Sequence[MissionItem]], frame: LocalFrame) -> Iterator[Shape]:
    for group in groups:
        first = group[0]
        if first.command in _POLYGONS:
            yield Polygon(tuple(_place(item, frame) for item in group), _POLYGONS[_CMD(first.command)])
        elif first.command in _CIRCLES:
            yield Circle(_place(first, frame), first.param1, _CIRCLES[_CMD(first.command)])


def _place(item: MissionItem, frame: LocalFrame) -> tuple[float, float]:
    north, east, _ = frame.to_local(item.param5, item.param6, 0.0)
    return north, east


def _groups(items: Sequence[MissionItem]) -> list[Sequence[MissionItem]] | None:
    """Return the items of each shape; None if a polygon is incomplete."""
    groups, at = [], 0
    while at < len(items):
        first = items[at]
        polygon = first.command in _POLYGONS
        size = int(first.param1) if polygon and first.param1 <= len(items) else 0 if polygon else 1
        group = items[at : at + size]
        same = all(item.command == first.command and item.param1 == first.param1 for item in group)
        if len(group) != size or not same or (polygon and size < MIN_CORNERS):
            return None
        groups.append(group)
        at += size
    return groups
