"""The position of a mission item: its params 5 to 7 in local metres.

A latitude and longitude that are NaN or both 0 mean the current position, an altitude of NaN the current
altitude. A position in the frame MISSION is as it was in the message.
"""

from __future__ import annotations

from dataclasses import replace
from math import hypot, isfinite
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.frames import GLOBAL_FRAMES
from mavstack.sim.autopilot.command_positions import down_of

if TYPE_CHECKING:
    from mavstack.services.mission import MissionItem
    from mavstack.sim.autopilot.autopilot import SimulatedAutopilot
    from mavstack.sim.autopilot.maneuvers import Point

_F = common.MavFrame
LATITUDE, LONGITUDE = 90.0, 180.0
_OFFSETS = frozenset({_F.LOCAL_OFFSET_NED, _F.BODY_OFFSET_NED})
#: Maximum horizontal distance and altitude of an item's position, in metres.
_FAR, _HIGH = 2.0e6, 1.0e5


def has_place(item: MissionItem) -> bool:
    """Return whether an item has a latitude and longitude, or x and y."""
    return isfinite(item.param5) and isfinite(item.param6) and bool(item.param5 or item.param6)


def place_of(autopilot: SimulatedAutopilot, item: MissionItem, *, zero_is_here: bool = False) -> Point:
    """Return the position of an item; `zero_is_here`: an altitude of 0 above home means the current one."""
    item = as_global(item)
    here = autopilot.maneuvers.place
    if item.frame not in GLOBAL_FRAMES:
        point = _local(item, here)
    else:
        north, east = here[:2]
        if has_place(item):
            north, east, _ = autopilot.body.frame.to_local(item.param5, item.param6, 0.0)
        left_out = zero_is_here and item.param7 == 0 and item.frame not in {_F.GLOBAL, _F.GLOBAL_INT}
        down = here[2] if left_out else down_of(autopilot, item.param7, item.frame, (north, east))
        point = north, east, down
    reachable = all(map(isfinite, point)) and hypot(*point[:2]) <= _FAR and abs(point[2]) <= _HIGH
    return point if reachable else here


def as_global(item: MissionItem) -> MissionItem:
    """Return an item in the frame MISSION as one in GLOBAL."""
    if item.frame != _F.MISSION:
        return item
    raw = abs(item.param5) > LATITUDE or abs(item.param6) > LONGITUDE
    scale = 1e-7 if raw else 1.0
    return replace(item, param5=item.param5 * scale, param6=item.param6 * scale, frame=_F.GLOBAL)


def _local(item: MissionItem, here: Point) -> Point:
    given = (item.param5, item.param6, item.param7)
    north, east, down = (value if isfinite(value) else 0.0 for value in given)
    if item.frame == _F.LOCAL_ENU:
        north, east, down = east, north, -down
    if item.frame in _OFFSETS:
        return here[0] + north, here[1] + east, here[2] + down
    return north, east, down
