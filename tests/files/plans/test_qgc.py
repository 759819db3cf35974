"""QGroundControl's files: every version and every kind of item; parts that are not read are reported."""

from __future__ import annotations

import json
from math import isnan
from typing import Any

import pytest

from mavstack.errors import PlanFileError
from mavstack.files.plans import Home, PlanFile, fence_areas, parse_plan
from mavstack.files.plans.model import CMD, FRAME, params_of
from mavstack.services.mission import PlanType
from tests.files.plans.plans import FLIGHT, names

HOME = [47.1, 8.2, 400]


def simple(command: int, *params: float | None, jump_id: int = -1, frame: int = 3) -> dict[str, Any]:
    values = [*params, *[0] * (7 - len(params))]
    item = {"type": "SimpleItem", "command": command, "frame": frame, "params": values, "autoContinue": True}
    return item if jump_id < 0 else {**item, "doJumpId": jump_id}


def mission_of(*items: dict[str, Any], **more: Any) -> PlanFile:
    mission = {"version": 2, "items": items, "plannedHomePosition": HOME, "firmwareType": 12, **more}
    return parse_plan(json.dumps({"fileType": "Plan", "version": 1, "mission": mission}))


def test_a_whole_plan():
    plan = parse_plan(FLIGHT)
    assert plan.kinds == (PlanType.MISSION, PlanType.FENCE, PlanType.RALLY)
    assert plan.home == Home(47.3977419, 8.5455939, 488)
    assert names(plan.mission) == [
        "NAV_TAKEOFF",
        "NAV_WAYPOINT",
        "NAV_WAYPOINT",
        "DO_JUMP",
        "NAV_RETURN_TO_LAUNCH",
    ]
    takeoff, first, second, jump, _ = plan.mission.items
    assert isnan(takeoff.param4)
    assert params_of(first)[4:] == (47.398, 8.546, 30)
    assert (second.autocontinue, second.frame) == (False, FRAME.GLOBAL)
    assert (jump.param1, jump.param2) == (1, 3)  # the second item
    areas = fence_areas(plan.fence.items)
    assert [len(polygon.vertices) for polygon in areas.polygons] == [4]
    assert areas.polygons[0].inclusion
    assert (areas.circles[0].inclusion, areas.circles[0].radius) == (False, 25.5)
    assert (areas.return_points[0].place, areas.return_points[0].altitude) == ((47.3977, 8.5456), 30)
    assert [params_of(item)[4:] for item in plan.rally.items] == [(47.396, 8.544, 25), (47.395, 8.545, 15.5)]
    assert {item.frame for item in plan.rally.items} == {FRAME.GLOBAL_RELATIVE_ALT}
    others = (*plan.fence.items, *plan.rally.items)
    assert {item.autocontinue for item in others} == {False}  # as QGC and MAVProxy send them
    assert {item.frame for item in plan.fence.items[:5]} == {FRAME.GLOBAL}
    assert (plan.settings.firmware, plan.settings.cruise_speed) == (3, 15)
    assert (plan.problems, plan.notes) == ((), ())


def test_surveys_and_corridors_are_read_as_their_items():
    survey = {
        "type": "ComplexItem",
        "complexItemType": "survey",
        "version": 5,
        "TransectStyleComplexItem": {
            "version": 2,
            "Items": [
                simple(CMD.NAV_WAYPOINT, 0, 0, 0, None, 47.1, 8.1, 50, jump_id=2),
                simple(CMD.DO_SET_CAM_TRIGG_DIST, 25, 0, 1, jump_id=3, frame=2),
                simple(CMD.NAV_WAYPOINT, 0, 0, 0, None, 47.2, 8.1, 50, jump_id=4),
            ],
        },
    }
    jump = simple(CMD.DO_JUMP, 6, 1, jump_id=5, frame=2)
    into_it = simple(CMD.DO_JUMP, 3, 1, jump_id=6, frame=2)
    plan = mission_of(simple(CMD.NAV_TAKEOFF, jump_id=1), survey, jump, into_it)
    assert names(plan.mission) == ["NAV_TAKEOFF", *["NAV_WAYPOINT", "DO_SET_CAM_TRIGG_DIST", "NAV_WAYPOINT"],
                                   "DO_JUMP", "DO_JUMP"]  # fmt: skip
    assert plan.mission.items[4].param1 == 5
    assert plan.mission.items[5].param1 == 2
    assert plan.problems == ()


def test_jumps_refer_to_ids_not_indexes():
    first = simple(CMD.NAV_WAYPOINT, 0, 0, 0, 0, 47.1, 8.1, 50, jump_id=17)
    second = simple(CMD.NAV_WAYPOINT, 0, 0, 0, 0, 47.2, 8.1, 50, jump_id=4)
    plan = mission_of(first, second, simple(CMD.DO_JUMP, 4, -1, jump_id=5, frame=2))
    assert plan.mission.items[2].param1 == 1


def test_a_jump_to_an_unknown_id_is_a_problem():
    plan = mission_of(simple(CMD.NAV_WAYPOINT, jump_id=1), simple(CMD.DO_JUMP, 9, 1, jump_id=2, frame=2))
    assert plan.problems == ("item 2 jumps to doJumpId 9, which no item has",)
    assert plan.mission.items[1].param1 == -1


def test_jumps_of_a_file_without_ids_count_from_1():
    plan = mission_of(simple(CMD.NAV_WAYPOINT), simple(CMD.NAV_WAYPOINT), simple(CMD.DO_JUMP, 2, 1))
    assert plan.mission.items[2].param1 == 1


def landing(kind: str, **more: Any) -> dict[str, Any]:
    return {
        "type": "ComplexItem",
        "complexItemType": kind,
        "version": 2,
        "altitudesAreRelative": True,
        "landCoordinate": [47.1, 8.1, 0],
        "landingApproachCoordinate": [47.11, 8.12, 40],
        "loiterClockwise": False,
        "loiterRadius": 75,
        "useLoiterToAlt": True,
        **more,
    }


def test_a_landing_pattern_of_a_plane():
    plan = mission_of(landing("fwLandingPattern"))
    start, approach, land = plan.mission.items
    assert (start.name, start.frame) == ("DO_LAND_START", FRAME.MISSION)
    assert (approach.name, params_of(approach)) == ("NAV_LOITER_TO_ALT", (1, -75, 0, 1, 47.11, 8.12, 40))
    assert (land.name, params_of(land), land.frame) == ("NAV_LAND", (0, 0, 0, 0, 47.1, 8.1, 0), 3)
    assert plan.problems == ()
    clockwise = mission_of(landing("fwLandingPattern", loiterClockwise=True))
    assert clockwise.mission.items[1].param2 == 75


def test_a_landing_pattern_of_a_quadplane_that_stops_its_camera():
    more = {"useLoiterToAlt": False, "altitudesAreRelative": False}
    plan = mission_of(landing("vtolLandingPattern", stopTakingPhotos=True, stopVideoPhotos=True, **more))
    assert names(plan.mission) == [
        "DO_LAND_START",
        "DO_SET_CAM_TRIGG_DIST",
        "IMAGE_STOP_CAPTURE",
        "VIDEO_STOP_CAPTURE",
        "NAV_WAYPOINT",
        "NAV_VTOL_LAND",
    ]
    assert plan.mission.items[4].frame == plan.mission.items[5].frame == FRAME.GLOBAL
    assert isnan(plan.mission.items[5].param4)


def test_an_older_landing_pattern():
    old = landing("fwLandingPattern", version=1, loiterCoordinate=[47.3, 8.3, 40])
    old |= {"loiterAltitudeRelative": False, "landAltitudeRelative": True}
    del old["altitudesAreRelative"], old["landingApproachCoordinate"], old["useLoiterToAlt"]
    _, approach, land = mission_of(old).mission.items
    assert (approach.name, approach.param5, approach.frame) == ("NAV_LOITER_TO_ALT", 47.3, FRAME.GLOBAL)
    assert land.frame == FRAME.GLOBAL_RELATIVE_ALT


@pytest.mark.parametrize(
    ("item", "problem"),
    [
        ({"complexItemType": "StructureScan", "version": 3}, "mission.items[1]: the StructureScan was not"),
        ({"complexItemType": "survey", "version": 3, "polygon": []}, "mission.items[1]: the survey was not"),
        ({}, "mission.items[1]: the pattern was not read, since the file holds no items of it"),
        (landing("fwLandingPattern", loiterRadius="big"), "loiterRadius is 'big' where a number must be"),
        (landing("fwLandingPattern", useDoChangeSpeed=True), "the approach speed was not read"),
    ],
)
def test_a_pattern_that_cannot_be_read_is_reported_and_the_rest_is_read(item, problem):
    plan = mission_of(simple(CMD.NAV_TAKEOFF), {**item, "type": "ComplexItem"}, simple(CMD.NAV_LAND))
    assert len(plan.problems) == 1
    assert problem in plan.problems[0]
    assert plan.mission.items[0].command == CMD.NAV_TAKEOFF
    assert plan.mission.items[-1].command == CMD.NAV_LAND


def test_items_with_a_separate_coordinate():
    old = {**simple(CMD.NAV_WAYPOINT), "params": [1, 2, 3, None], "coordinate": [47.1, 8.1, 60]}
    (item,) = mission_of(old).mission.items
    assert params_of(item)[4:] == (47.1, 8.1, 60)
    assert params_of(item)[:3] == (1, 2, 3)


def test_a_mission_file_of_version_1():
    first = {"autoContinue": True, "command": 16, "coordinate": [47.1, 8.1, 60], "frame": 3, "id": 1}
    first |= {"param1": 0, "param2": 0, "param3": 0, "param4": 0, "type": "missionItem"}
    jump = {**first, "command": 177, "id": 2, "frame": 2, "param1": 1, "param2": 5, "coordinate": [0, 0, 0]}
    home = {**first, "id": 0, "coordinate": [47.0, 8.0, 400], "frame": 0}
    survey = {"type": "survey", "id": 3, "polygon": []}
    root = {"MAV_AUTOPILOT": 3, "version": "1.0", "items": [first, jump], "plannedHomePosition": home}
    plan = parse_plan(json.dumps({**root, "complexItems": [], "groundStation": "QGroundControl"}))
    assert plan.home == Home(47.0, 8.0, 400)
    assert plan.settings.firmware == 3
    assert params_of(plan.mission.items[0]) == (0, 0, 0, 0, 47.1, 8.1, 60)
    assert plan.mission.items[1].param1 == 0
    assert plan.problems == ()
    other = parse_plan(json.dumps({**root, "complexItems": [survey]}))
    assert "complexItems[0]: the survey was not read" in other.problems[0]


@pytest.mark.parametrize(
    ("kind", "part", "expected"),
    [
        ("Mission", "mission", PlanType.MISSION),
        ("GeoFence", "geoFence", PlanType.FENCE),
        ("RallyPoints", "rallyPoints", PlanType.RALLY),
    ],
)
def test_a_file_of_one_part(kind, part, expected):
    whole = json.loads(FLIGHT)
    plan = parse_plan(json.dumps({**whole[part], "fileType": kind}))
    assert plan.kinds == (expected,)
    assert plan.plan(expected) == parse_plan(FLIGHT).plan(expected)


@pytest.mark.parametrize("part", ["mission", "geoFence", "rallyPoints"])
def test_a_part_may_be_missing(part):
    whole = json.loads(FLIGHT)
    del whole[part], whole["fileType"]
    plan = parse_plan(json.dumps(whole))
    assert len(plan.kinds) == 2


def test_a_fence_of_version_1_is_one_polygon_to_stay_in():
    fence = {"version": 1, "polygon": [[47, 8], [47, 9], [48, 9]], "breachReturn": [47.1, 8.2]}
    plan = parse_plan(json.dumps({"fileType": "Plan", "version": 1, "geoFence": fence}))
    areas = fence_areas(plan.fence.items)
    assert (len(areas.polygons), areas.polygons[0].inclusion, areas.leftovers) == (1, True, [])
    assert areas.return_points[0].altitude == 0


def test_altitude_limits_of_a_polygon_are_reported():
    whole = json.loads(FLIGHT)
    whole["geoFence"]["polygons"][0]["altitudeMax"] = 120
    plan = parse_plan(json.dumps(whole))
    assert plan.problems == (
        "geoFence.polygons[0].altitudeMax: altitude limits of a polygon are not supported",
    )


def test_a_home_of_zeros_is_none():
    assert mission_of(simple(CMD.NAV_TAKEOFF), plannedHomePosition=[0, 0, 0]).home is None
    assert mission_of(simple(CMD.NAV_TAKEOFF), plannedHomePosition=[0, 0, None]).home is None
    assert mission_of(simple(CMD.NAV_TAKEOFF), plannedHomePosition=[0, 8, None]).home == Home(0, 8, 0)
    with pytest.raises(PlanFileError, match=r"mission\.plannedHomePosition: the home position is not finite"):
        mission_of(simple(CMD.NAV_TAKEOFF), plannedHomePosition=[None, 8, 0])


def test_frames_are_those_without_int():
    plan = mission_of(simple(CMD.NAV_WAYPOINT, frame=6), simple(CMD.NAV_WAYPOINT, frame=11))
    assert [item.frame for item in plan.mission.items] == [3, 10]
