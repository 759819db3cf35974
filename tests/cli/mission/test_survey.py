"""`mav mission survey`."""

from __future__ import annotations

import json

import pytest

from mavstack.files.plans import PlanFile, format_plan, read_plan
from mavstack.files.plans.fence import FenceAreas, Polygon, fence_items
from mavstack.sim.vehicle_types import Firmware, VehicleType
from tests.cli.harness import COPTER, PX4_COPTER

CORNERS = ("47.3970,8.5450", "47.3970,8.5463", "47.3988,8.5463", "47.3988,8.5450")


def test_a_survey_is_planned_without_a_vehicle(mav):
    result = mav("mission", "survey", *CORNERS, "--spacing", 20, "--dry-run", "--json")
    assert (result.code, result.err) == (0, "")
    plan = json.loads(result.out)
    assert (plan["spacing_m"], plan["bearing_deg"], plan["uploaded"]) == (20.0, 0.0, False)
    assert plan["vehicles"][0]["length_m"] == pytest.approx(5 * 200.2, abs=1.0)


def test_a_survey_is_divided_by_regions(mav):
    words = ("--count", 3, "--division", "grid", "--spacing", 10, "--dry-run", "--json")
    plan = json.loads(mav("mission", "survey", *CORNERS, *words).out)
    lengths = [each["length_m"] for each in plan["vehicles"]]
    assert max(lengths) < 1.05 * min(lengths)


def test_vehicles_at_one_height_start_one_after_the_other(mav, tmp_path):
    words = ("--count", 2, "--layer-spacing", 0, "--start-delay", 40, "--out", tmp_path / "part.plan")
    assert mav("mission", "survey", *CORNERS, *words).code == 0
    first, second = (list(read_plan(tmp_path / f"part-{n}.plan").mission.items) for n in (1, 2))
    assert {each.param7 for each in (*first, *second) if each.name == "NAV_WAYPOINT"} == {30.0}
    delays = [[each.param1 for each in items if each.name == "NAV_DELAY"] for items in (first, second)]
    assert delays == [[], [40.0]]


def test_a_camera_takes_pictures_and_a_corridor_is_written(mav, tmp_path):
    out = tmp_path / "corridor.plan"
    words = ("--corridor", 60, "--camera", "73.7,53.1", "--overlap", "60,80", "--out", out)
    result = mav("mission", "survey", *CORNERS[:3], *words)
    assert (result.code, result.err) == (0, "")
    plan = read_plan(out)
    assert not plan.problems
    assert "DO_SET_CAM_TRIGG_DIST" in {item.name for item in plan.mission.items}


def test_the_area_is_the_fence_of_a_file(mav, tmp_path):
    corners = [tuple(map(float, each.split(","))) for each in CORNERS]
    pond = ((47.3975, 8.5453), (47.3975, 8.5458), (47.3980, 8.5458), (47.3980, 8.5453))
    areas = FenceAreas([Polygon(True, tuple(corners)), Polygon(False, pond)])
    path = tmp_path / "field.plan"
    path.write_text(format_plan(PlanFile.of(fence=fence_items(areas)), "plan").text)
    with_pond = json.loads(mav("mission", "survey", "--area", path, "--dry-run", "--json").out)
    without = json.loads(mav("mission", "survey", *CORNERS, "--dry-run", "--json").out)
    assert with_pond["area_m2"] < without["area_m2"] - 2000


def test_a_survey_is_uploaded_to_two_vehicles(simulate, mav):
    simulate(COPTER, PX4_COPTER, apart=True)
    result = mav("mission", "survey", *CORNERS, "--spacing", 40, "--all")
    assert (result.code, result.err) == (0, "")
    assert [line.partition(":")[0] for line in result.out.splitlines()] == ["vehicle 1", "vehicle 2"]
    assert mav("mission", "download", "-", "--system", 2).out.count("\n") > 4


def test_shares_and_durations_are_those_of_the_speeds_of_vehicle_types(simulate, mav):
    simulate(COPTER, (VehicleType.ROVER, Firmware.ARDUPILOT), apart=True)
    words = (
        "mission",
        "survey",
        *CORNERS,
        "--url",
        "udp://:1",
        "--all",
        "--spacing",
        20,
        "--dry-run",
        "--json",
    )
    copter, rover = json.loads(mav(*words).out)["vehicles"]
    assert copter["length_m"] == pytest.approx(2.5 * rover["length_m"], rel=0.05)
    assert copter["duration_s"] == pytest.approx(rover["duration_s"], rel=0.2)
    copter, rover = json.loads(mav(*words, "--speed", 3).out)["vehicles"]
    assert copter["length_m"] == pytest.approx(rover["length_m"], rel=0.05)


def test_vehicles_that_are_named_are_waited_for_without_a_url(simulate, mav):
    simulate(COPTER, PX4_COPTER, apart=True)
    words = ("mission", "survey", *CORNERS, "--dry-run", "--json")
    systems = [
        [each["system"] for each in json.loads(mav(*words, *choice).out)["vehicles"]]
        for choice in (("--all",), ("--system", 2), ("--systems", "2,1"))
    ]
    assert systems == [[1, 2], [2], [2, 1]]


def test_a_search_of_one_vehicle_is_a_mission(mav, tmp_path):
    out = tmp_path / "search.plan"
    result = mav("mission", "search", "sector", "--center", "47.3977,8.5456", "--out", out)
    assert (result.code, result.err) == (0, "")
    assert len(read_plan(out).mission) > 8


@pytest.mark.parametrize(
    ("words", "code", "text"),
    [
        ((), 2, "give the corners of the area, or --area FILE"),
        ((*CORNERS, "--area", "x.plan"), 2, "give the corners"),
        ((*CORNERS, "--camera", "73.7"), 2, "is not a list of numbers"),
        ((*CORNERS, "--camera", "0,50"), 2, "angles of view"),
        ((*CORNERS, "--overlap", "100,0"), 2, "overlaps are"),
        ((*CORNERS[:2], "--dry-run"), 1, "there must be 3 to 1000 corners"),
        ((*CORNERS, "--spacing", "0", "--dry-run"), 1, "spacing must be"),
        (
            (*CORNERS, "--start-delay=-1", "--dry-run"),
            1,
            "start_delay must be finite and at least 0 s, got -1",
        ),
        ((*CORNERS, "--count", 2), 2, "add --dry-run or --out FILE"),
        ((*CORNERS, "--count", 2, "--all", "--dry-run"), 2, "--count cannot be used"),
    ],
)
def test_wrong_usage_is_refused(mav, words, code, text):
    result = mav("mission", "survey", *words)
    assert result.code == code
    assert text in result.err
