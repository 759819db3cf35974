"""Problems for every vehicle are found, item by item; problems for some vehicles are not."""

from __future__ import annotations

from dataclasses import replace
from math import inf, nan

import pytest

from mavstack.files.plans import Circle, FenceAreas, Home, PlanFile, Polygon, check, fence_items, parse_plan
from mavstack.files.plans.model import CMD, FRAME
from mavstack.services.mission import MissionItem
from tests.files.plans.plans import FENCE, FLIGHT, RALLY, WAYPOINTS

GOOD = MissionItem(CMD.NAV_WAYPOINT, param5=47.0, param6=8.0, param7=20.0)
SQUARE = ((47.0, 8.0), (47.0, 8.1), (47.1, 8.1), (47.1, 8.0))


def problems_of(plan: PlanFile) -> list[str]:
    return [str(problem) for problem in check(plan)]


@pytest.mark.parametrize("text", [FLIGHT, WAYPOINTS, FENCE, RALLY])
def test_valid_plans(text):
    assert problems_of(parse_plan(text)) == []


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({"param5": 95.0}, "latitude 95 is not between -90 and 90"),
        ({"param6": -181.5}, "longitude -181.5 is not between -180 and 180"),
        ({"param5": inf}, "latitude inf is not between -90 and 90"),
        ({"param5": nan}, "it has no latitude"),
        ({"param7": inf}, "altitude inf is not a number"),
        ({"param7": nan}, "altitude nan is not a number"),
        ({"frame": 77}, "there is no frame 77"),
    ],
)
def test_invalid_positions(change, expected):
    plan = PlanFile.of([GOOD, replace(GOOD, **change)])
    assert problems_of(plan) == [f"mission item 1: NAV_WAYPOINT: {expected}"]
    assert problems_of(replace(plan, home=Home(47, 8))) == [f"mission item 2: NAV_WAYPOINT: {expected}"]


@pytest.mark.parametrize(
    "item",
    [
        MissionItem(CMD.NAV_TAKEOFF, param5=nan, param6=nan, param7=20),
        MissionItem(CMD.NAV_LAND, param5=nan, param6=nan, param7=nan),
        replace(GOOD, param5=500.0, param6=-500.0, frame=FRAME.LOCAL_NED),
        MissionItem(CMD.DO_SET_ROI, param5=400.0, frame=FRAME.MISSION),
        MissionItem(60000, param5=400.0),
    ],
)
def test_problems_of_some_vehicles_only_are_not_reported(item):
    assert problems_of(PlanFile.of([item])) == []


@pytest.mark.parametrize("target", [-1.0, 2.0, 0.5, nan, inf, 1.0])
def test_jumps_to_nowhere(target):
    jump = MissionItem(CMD.DO_JUMP, target, 2, frame=FRAME.MISSION)
    (text,) = problems_of(PlanFile.of([GOOD, jump]))
    assert text.startswith("mission item 1: DO_JUMP: it jumps to ")


def test_items_of_another_plan_type():
    vertex = MissionItem(CMD.NAV_FENCE_POLYGON_VERTEX_INCLUSION, 3, param5=1, param6=2)
    rally = MissionItem(CMD.NAV_RALLY_POINT, param5=1, param6=2)
    plan = PlanFile.of([vertex, rally], [GOOD], [GOOD])
    assert problems_of(plan) == [
        "mission item 0: NAV_FENCE_POLYGON_VERTEX_INCLUSION: it belongs to a fence, not to a mission",
        "mission item 1: NAV_RALLY_POINT: it belongs to the rally points, not to a mission",
        "fence item 0: NAV_WAYPOINT: it belongs to a mission, not to a fence",
        "rally point 0: NAV_WAYPOINT: it belongs to a mission, not to the rally points",
    ]


def test_invalid_fences():
    square = fence_items(FenceAreas([Polygon(inclusion=True, vertices=SQUARE)]))
    circle = fence_items(FenceAreas(circles=[Circle(inclusion=False, center=(47.0, 8.0), radius=-3)]))
    assert problems_of(PlanFile.of(fence=[*square[:3], *circle])) == [
        "fence item 3: NAV_FENCE_CIRCLE_EXCLUSION: its radius is -3, which is not a positive number",
        "fence item 0: 3 vertices in a row, but param 1 says that the polygon has 4",
    ]
    far = fence_items(FenceAreas(circles=[Circle(inclusion=False, center=(97.0, 8.0), radius=3)]))
    assert "latitude 97 is not between" in problems_of(PlanFile.of(fence=far))[0]


def test_a_problem_names_its_item():
    (problem,) = check(PlanFile.of([GOOD, replace(GOOD, param5=99.0)], home=Home(1, 2)))
    assert (problem.kind, problem.item, problem.number) == (0, 1, 2)
