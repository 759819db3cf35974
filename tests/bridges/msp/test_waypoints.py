"""Conversion of plans to waypoints of iNav and back."""

from __future__ import annotations

from dataclasses import astuple

import pytest

from mavstack.bridges.msp.waypoints import ItemRefused, item_numbers, items_of, waypoints_of
from mavstack.dialects import common
from mavstack.msp.messages.navigation import LAST_WAYPOINT_FLAG, SetWp, WaypointAction
from mavstack.services.mission import MissionItem

_CMD, _FRAME, _RESULT = common.MavCmd, common.MavFrame, common.MavMissionResult


def located(command: int, *params: float, frame: int = _FRAME.GLOBAL_RELATIVE_ALT) -> MissionItem:
    return MissionItem(command, *(*params, 0, 0, 0, 0)[:4], 47.0, 8.0, 20.0, frame=frame)  # type: ignore[call-arg]


PLAN = [
    located(_CMD.NAV_WAYPOINT),
    MissionItem(_CMD.DO_CHANGE_SPEED, 1, 7.5, -1),
    located(_CMD.NAV_WAYPOINT, frame=_FRAME.GLOBAL),
    located(_CMD.NAV_LOITER_TIME, 30),
    MissionItem(_CMD.CONDITION_YAW, 270),
    located(_CMD.DO_SET_ROI_LOCATION),
    MissionItem(_CMD.DO_SET_ROI_NONE),
    MissionItem(_CMD.DO_JUMP, 2, -1),
    MissionItem(_CMD.DO_CHANGE_SPEED, 1, -2, -1),
    located(_CMD.NAV_WAYPOINT),
    located(_CMD.NAV_LAND),
    MissionItem(_CMD.NAV_RETURN_TO_LAUNCH),
]


def test_every_action_both_ways() -> None:
    waypoints = waypoints_of(PLAN)
    assert [each.action for each in waypoints] == [1, 1, 3, 7, 5, 7, 6, 1, 8, 4]
    assert [each.index for each in waypoints] == list(range(1, 11))
    assert [each.flag for each in waypoints] == [0] * 9 + [LAST_WAYPOINT_FLAG]
    items, numbers = items_of(waypoints)
    assert items == PLAN
    assert numbers == item_numbers(PLAN) == [0, 2, 3, 4, 5, 6, 7, 9, 10, 11]


def test_parameters() -> None:
    waypoints = waypoints_of(PLAN)
    parameters = {each.index: astuple(each)[5:8] for each in waypoints}
    assert parameters[2] == (750, 0, 1)  # a speed in cm/s; the altitude is above mean sea level
    assert parameters[3] == (30, 750, 0)
    assert parameters[4] == (270, 0, 0)
    assert parameters[6] == (-1, 0, 0)
    assert parameters[7] == (2, -1, 0)  # the second waypoint, for ever
    assert parameters[8] == (0, 0, 0)
    assert parameters[10] == (1, 0, 0)


def test_a_waypoint_with_a_hold_time_is_a_hold() -> None:
    (waypoint,) = waypoints_of([located(_CMD.NAV_WAYPOINT, 5)])
    assert (waypoint.action, waypoint.parameter_1) == (WaypointAction.POSHOLD_TIME, 5)


def test_an_empty_plan() -> None:
    assert waypoints_of([]) == []
    assert items_of([]) == ([], [])


def test_a_jump_of_the_controller_to_a_missing_waypoint() -> None:
    items, _ = items_of([SetWp(1, WaypointAction.JUMP, 0.0, 0.0, 0.0, 9, 1, 0, LAST_WAYPOINT_FLAG)])
    assert items == [MissionItem(_CMD.DO_JUMP, 0, 1)]


@pytest.mark.parametrize(
    ("item", "result", "reason"),
    [
        (MissionItem(_CMD.NAV_TAKEOFF), _RESULT.UNSUPPORTED, "iNav has no NAV_TAKEOFF"),
        (located(_CMD.NAV_LOITER_UNLIM), _RESULT.UNSUPPORTED, "iNav has no NAV_LOITER_UNLIM"),
        (located(_CMD.NAV_WAYPOINT, frame=_FRAME.GLOBAL_TERRAIN_ALT), _RESULT.UNSUPPORTED_FRAME, "no frame"),
        (MissionItem(_CMD.NAV_WAYPOINT), _RESULT.INVALID_PARAM5_X, "needs a location"),
        (MissionItem(_CMD.NAV_WAYPOINT, 0, 0, 0, 0, 47, 8, float("nan")), _RESULT.INVALID_PARAM7, "altitude"),
        (located(_CMD.NAV_LOITER_TIME, 1e6), _RESULT.INVALID_PARAM1, "out of range"),
        (MissionItem(_CMD.DO_CHANGE_SPEED, 1, 0), _RESULT.INVALID_PARAM2, "must be positive"),
        (MissionItem(_CMD.CONDITION_YAW, 90, param4=1), _RESULT.INVALID_PARAM4, "absolute"),
        (MissionItem(_CMD.DO_JUMP, 7, 1), _RESULT.INVALID_PARAM1, "missing item 7"),
    ],
)
def test_refused_items(item: MissionItem, result: int, reason: str) -> None:
    with pytest.raises(ItemRefused, match=f"item 1: .*{reason}") as refused:
        waypoints_of([located(_CMD.NAV_WAYPOINT), item])
    assert (refused.value.seq, refused.value.result) == (1, result)
