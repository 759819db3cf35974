"""Missions of iNav as plans of MAVLink, both ways.

iNav has up to 120 waypoints, each with an action; MAVLink has items with commands. Altitudes are above home,
or above mean sea level where bit 0 of p3 is set; speeds are in cm/s, 0 for the default.

    WAYPOINT         NAV_WAYPOINT             p1 speed, that of the last DO_CHANGE_SPEED
    POSHOLD_TIME     NAV_LOITER_TIME          p1 seconds, p2 speed; also NAV_WAYPOINT with a hold time
    RTH              NAV_RETURN_TO_LAUNCH     p1 1: land there, as MAVLink's command does
    SET_POI          DO_SET_ROI_LOCATION
    JUMP             DO_JUMP                  p1 number of the waypoint, p2 repetitions, -1 for ever
    SET_HEADING      CONDITION_YAW            p1 degrees; -1, as DO_SET_ROI_NONE, ends SET_POI and SET_HEADING
    LAND             NAV_LAND                 p1 speed

An item that iNav does not have is refused with its number. A change of speed has no waypoint of its own, so
that the numbers of items and waypoints differ; jumps are converted.
Source: the wiki page "MSP Navigation Messages" of iNav.
"""

from __future__ import annotations

from dataclasses import replace
from math import isfinite
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.msp.messages.navigation import LAST_WAYPOINT_FLAG, SetWp, WaypointAction, Wp
from mavstack.services.mission import MissionItem

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

_CMD: Final = common.MavCmd
_RESULT: Final = common.MavMissionResult
_RELATIVE: Final = frozenset({common.MavFrame.GLOBAL_RELATIVE_ALT, common.MavFrame.GLOBAL_RELATIVE_ALT_INT})
_ABSOLUTE: Final = frozenset({common.MavFrame.GLOBAL, common.MavFrame.GLOBAL_INT})
#: Bit 0 of the waypoint field p3: the altitude is above mean sea level.
_ABOVE_SEA: Final = 1
#: Speed in MAV_CMD_DO_CHANGE_SPEED that means the default speed of the vehicle.
_DEFAULT_SPEED: Final = -2.0
_CENTI: Final = 100
_MAX_INT16: Final = 32767


class ItemRefused(Exception):  # noqa: N818 (an outcome, which does not leave this package)
    """An item that iNav does not have: its number, a MAV_MISSION_RESULT and the reason."""

    def __init__(self, seq: int, result: int, reason: str) -> None:
        super().__init__(f"item {seq}: {reason}")
        self.seq, self.result = seq, result


def waypoints_of(items: Sequence[MissionItem]) -> list[SetWp]:
    """Convert the items of a plan; raises `ItemRefused`."""
    encoder = _Encoder(items)
    found = [wp for seq, item in enumerate(items) if (wp := encoder.encode(seq, item)) is not None]
    flags = [0] * (len(found) - 1) + [LAST_WAYPOINT_FLAG] * bool(found)
    return [replace(wp, index=index, flag=flags[index - 1]) for index, wp in enumerate(found, 1)]


def items_of(waypoints: Sequence[Wp]) -> tuple[list[MissionItem], list[int]]:
    """Convert waypoints.

    Returns:
        The items, and for each waypoint the number of its item.
    """
    items: list[MissionItem] = []
    numbers: list[int] = []
    jumps: list[tuple[int, int]] = []
    speed = 0
    for waypoint in waypoints:
        wanted = _speed_of(waypoint)
        if wanted is not None and wanted != speed:
            speed = wanted
            items.append(_change_of_speed(speed))
        if waypoint.action == WaypointAction.JUMP:
            jumps.append((len(items), waypoint.parameter_1))
        numbers.append(len(items))
        items.append(_decode(waypoint))
    for place, number in jumps:
        target = numbers[number - 1] if 0 < number <= len(numbers) else 0
        items[place] = MissionItem(_CMD.DO_JUMP, target, items[place].param2)
    return items, numbers


def item_numbers(items: Sequence[MissionItem]) -> list[int]:
    """Return the number of the item of each waypoint of a plan."""
    return [seq for seq, item in enumerate(items) if item.command != _CMD.DO_CHANGE_SPEED]


class _Encoder:
    """Converts the items of one plan."""

    def __init__(self, items: Sequence[MissionItem]) -> None:
        self._items = items
        self._numbers = item_numbers(items)
        self._speed = 0

    def encode(self, seq: int, item: MissionItem) -> SetWp | None:
        """Return the waypoint of an item; None for a change of speed."""
        encode = _ENCODERS.get(item.command)
        if encode is None:
            raise ItemRefused(seq, _RESULT.UNSUPPORTED, f"iNav has no {item.name}")
        return encode(self, seq, item)

    def change_speed(self, seq: int, item: MissionItem) -> None:
        """Take the speed for the waypoints that follow."""
        if item.param2 == _DEFAULT_SPEED:
            self._speed = 0
        elif item.param2 > 0:
            self._speed = _integer(seq, item.param2 * _CENTI, _RESULT.INVALID_PARAM2)
        elif item.param2 != -1:
            raise ItemRefused(seq, _RESULT.INVALID_PARAM2, f"a speed must be positive, got {item.param2:g}")

    def waypoint(self, seq: int, item: MissionItem) -> SetWp:
        """Convert NAV_WAYPOINT."""
        if item.param1 > 0:
            return self.hold(seq, item)
        return self._located(seq, item, WaypointAction.WAYPOINT, p1=self._speed)

    def hold(self, seq: int, item: MissionItem) -> SetWp:
        """Convert NAV_LOITER_TIME, and NAV_WAYPOINT with a hold time."""
        seconds = _integer(seq, item.param1, _RESULT.INVALID_PARAM1)
        return self._located(seq, item, WaypointAction.POSHOLD_TIME, p1=seconds, p2=self._speed)

    def land(self, seq: int, item: MissionItem) -> SetWp:
        """Convert NAV_LAND."""
        return self._located(seq, item, WaypointAction.LAND, p1=self._speed)

    def point_of_interest(self, seq: int, item: MissionItem) -> SetWp:
        """Convert DO_SET_ROI_LOCATION."""
        return self._located(seq, item, WaypointAction.SET_POI)

    def return_home(self, _seq: int, _item: MissionItem) -> SetWp:
        """Convert NAV_RETURN_TO_LAUNCH."""
        return _waypoint(WaypointAction.RTH, p1=1)

    def heading(self, seq: int, item: MissionItem) -> SetWp:
        """Convert CONDITION_YAW to an absolute heading."""
        if item.param4:
            raise ItemRefused(seq, _RESULT.INVALID_PARAM4, "iNav turns to absolute headings only")
        degrees = _integer(seq, item.param1, _RESULT.INVALID_PARAM1)
        return _waypoint(WaypointAction.SET_HEADING, p1=degrees % 360)

    def no_heading(self, _seq: int, _item: MissionItem) -> SetWp:
        """Convert DO_SET_ROI_NONE."""
        return _waypoint(WaypointAction.SET_HEADING, p1=-1)

    def jump(self, seq: int, item: MissionItem) -> SetWp:
        """Convert DO_JUMP; the target is the first waypoint from its item on."""
        target = _integer(seq, item.param1, _RESULT.INVALID_PARAM1)
        number = next((place for place, found in enumerate(self._numbers, 1) if found >= target >= 0), None)
        if number is None:
            raise ItemRefused(seq, _RESULT.INVALID_PARAM1, f"it jumps to the missing item {target}")
        repetitions = _integer(seq, item.param2, _RESULT.INVALID_PARAM2)
        return _waypoint(WaypointAction.JUMP, p1=number, p2=repetitions)

    def _located(
        self, seq: int, item: MissionItem, action: WaypointAction, *, p1: int = 0, p2: int = 0
    ) -> SetWp:
        if item.frame not in _RELATIVE | _ABSOLUTE:
            raise ItemRefused(seq, _RESULT.UNSUPPORTED_FRAME, f"iNav has no frame {item.frame_name}")
        if item.location is None:
            raise ItemRefused(seq, _RESULT.INVALID_PARAM5_X, f"iNav needs a location for {item.name}")
        if not isfinite(item.param7):
            raise ItemRefused(seq, _RESULT.INVALID_PARAM7, f"iNav needs an altitude for {item.name}")
        p3 = _ABOVE_SEA if item.frame in _ABSOLUTE else 0
        return _waypoint(action, *item.location, item.param7, p1=p1, p2=p2, p3=p3)


_ENCODERS: Final[dict[int, Callable[[_Encoder, int, MissionItem], SetWp | None]]] = {
    _CMD.NAV_WAYPOINT: _Encoder.waypoint,
    _CMD.NAV_LOITER_TIME: _Encoder.hold,
    _CMD.NAV_RETURN_TO_LAUNCH: _Encoder.return_home,
    _CMD.NAV_LAND: _Encoder.land,
    _CMD.DO_SET_ROI_LOCATION: _Encoder.point_of_interest,
    _CMD.DO_SET_ROI_NONE: _Encoder.no_heading,
    _CMD.CONDITION_YAW: _Encoder.heading,
    _CMD.DO_JUMP: _Encoder.jump,
    _CMD.DO_CHANGE_SPEED: _Encoder.change_speed,
}
_LOCATED: Final[dict[int, int]] = {
    WaypointAction.WAYPOINT: _CMD.NAV_WAYPOINT,
    WaypointAction.POSHOLD_UNLIMITED: _CMD.NAV_LOITER_UNLIM,
    WaypointAction.POSHOLD_TIME: _CMD.NAV_LOITER_TIME,
    WaypointAction.SET_POI: _CMD.DO_SET_ROI_LOCATION,
    WaypointAction.LAND: _CMD.NAV_LAND,
}


def _decode(waypoint: Wp) -> MissionItem:
    command = _LOCATED.get(waypoint.action)
    if command is not None:
        above_sea = waypoint.parameter_3 & _ABOVE_SEA
        frame = common.MavFrame.GLOBAL if above_sea else common.MavFrame.GLOBAL_RELATIVE_ALT
        seconds = float(waypoint.parameter_1) if waypoint.action == WaypointAction.POSHOLD_TIME else 0.0
        return MissionItem(
            command, seconds, 0.0, 0.0, 0.0,
            waypoint.latitude, waypoint.longitude, waypoint.altitude, frame=frame,
        )  # fmt: skip
    if waypoint.action == WaypointAction.JUMP:
        return MissionItem(_CMD.DO_JUMP, waypoint.parameter_1, waypoint.parameter_2)
    if waypoint.action == WaypointAction.SET_HEADING and waypoint.parameter_1 >= 0:
        return MissionItem(_CMD.CONDITION_YAW, waypoint.parameter_1)
    if waypoint.action == WaypointAction.SET_HEADING:
        return MissionItem(_CMD.DO_SET_ROI_NONE)
    return MissionItem(_CMD.NAV_RETURN_TO_LAUNCH)


def _speed_of(waypoint: Wp) -> int | None:
    """Return the speed to a waypoint in cm/s; None if the waypoint has none."""
    if waypoint.action in (WaypointAction.WAYPOINT, WaypointAction.LAND):
        return waypoint.parameter_1
    return waypoint.parameter_2 if waypoint.action == WaypointAction.POSHOLD_TIME else None


def _change_of_speed(speed: int) -> MissionItem:
    return MissionItem(_CMD.DO_CHANGE_SPEED, 1, speed / _CENTI if speed else _DEFAULT_SPEED, -1)


def _waypoint(
    action: WaypointAction,
    latitude: float = 0.0,
    longitude: float = 0.0,
    altitude: float = 0.0,
    *,
    p1: int = 0,
    p2: int = 0,
    p3: int = 0,
) -> SetWp:
    """Return a waypoint whose number and flag are not known yet."""
    return SetWp(0, action, latitude, longitude, altitude, p1, p2, p3, 0)


def _integer(seq: int, value: float, result: int) -> int:
    if not isfinite(value) or abs(value) > _MAX_INT16:
        raise ItemRefused(seq, result, f"the value {value:g} is out of range")
    return round(value)
