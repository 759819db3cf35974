"""A written plan is read back exactly, or the writer reports what the format cannot hold."""

from __future__ import annotations

from dataclasses import replace
from math import inf, isnan, nan

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.errors import PlanFileError
from mavstack.files.plans import (
    FORMATS,
    Circle,
    FenceAreas,
    Home,
    PlanFile,
    Polygon,
    ReturnPoint,
    Settings,
    fence_items,
    format_plan,
    parse_plan,
    read_plan,
    write_plan,
)
from mavstack.files.plans.model import CMD, FRAME
from mavstack.services.mission import MissionItem, PlanType
from tests.files.plans.plans import (
    FENCE,
    FENCES,
    FLIGHT,
    HOMES,
    POLYGONS,
    RALLY,
    RETURNS,
    WAYPOINTS,
    exactly,
    missions,
    rally_points,
)

SQUARE = ((47.0, 8.0), (47.0, 8.1), (47.1, 8.1), (47.1, 8.0))
FRAMES_OF_RALLY = st.sampled_from([FRAME.GLOBAL, FRAME.GLOBAL_RELATIVE_ALT, FRAME.GLOBAL_TERRAIN_ALT])


def returned(plan: PlanFile, name: str) -> PlanFile:
    written = format_plan(plan, name)
    assert written.lost == ()
    read = parse_plan(written.text)
    assert read.problems == ()
    return read


@given(missions(st.floats()), FENCES, rally_points(FRAMES_OF_RALLY), st.none() | HOMES)
def test_mavstack_json_is_lossless(mission, fence, rally, home):
    plan = PlanFile.of(mission, fence, rally, home)
    assert exactly(returned(plan, "json")) == exactly(plan)


@given(missions(), FENCES, rally_points(), HOMES)
def test_qgc_plans_come_back_exactly(mission, fence, rally, home):
    plan = PlanFile.of(mission, fence, rally, home)
    assert exactly(returned(plan, "plan")) == exactly(plan)


@given(missions(st.floats(allow_infinity=False)), st.none() | HOMES)
def test_missions_as_waypoints_come_back_exactly(mission, home):
    plan = PlanFile.of(mission, home=home)
    assert exactly(returned(plan, "waypoints")) == exactly(plan)


@given(FENCES)
def test_fences_as_waypoints_come_back_exactly(fence):
    plan = PlanFile.of(fence=fence)
    assert exactly(returned(plan, "waypoints")) == exactly(plan)


@given(rally_points(FRAMES_OF_RALLY))
def test_rally_points_as_waypoints_come_back_exactly(rally):
    plan = PlanFile.of(rally=rally)
    assert exactly(returned(plan, "waypoints")) == exactly(plan)


@given(rally_points(FRAMES_OF_RALLY).filter(bool))
def test_rally_lists_come_back_exactly(rally):
    plan = PlanFile.of(rally=rally)
    assert exactly(returned(plan, "rally")) == exactly(plan)


@given(POLYGONS.map(lambda polygon: replace(polygon, inclusion=True)), RETURNS)
def test_fence_lists_come_back_exactly(polygon, point):
    point = replace(point, altitude=0.0, frame=FRAME.GLOBAL)
    vertices = tuple(dict.fromkeys(place for place in polygon.vertices if place != point.place))
    if len(vertices) < 3:
        return
    areas = FenceAreas([replace(polygon, vertices=vertices)], [], [point])
    plan = PlanFile.of(fence=fence_items(areas))
    read = returned(plan, "fence")
    assert exactly(read) == exactly(plan)
    assert read.notes == ()


@pytest.mark.parametrize("text", [FLIGHT, WAYPOINTS, FENCE, RALLY])
def test_writing_and_reading_again_changes_nothing(text):
    plan = parse_plan(text)
    assert not plan.problems
    assert exactly(returned(plan, "json")) == exactly(plan)


@pytest.mark.parametrize(
    ("name", "suffix"), [(name, suffix) for name, each in FORMATS.items() for suffix in each.suffixes]
)
def test_files_are_written_by_suffix_and_read_by_content(tmp_path, name, suffix):
    kinds = {"fence": [PlanType.FENCE], "rally": [PlanType.RALLY]}.get(name, [PlanType.MISSION])
    plan = parse_plan(FLIGHT).only(kinds)
    path = tmp_path / f"plan{suffix.upper()}"
    write_plan(path, plan)
    other = tmp_path / "renamed.bin"
    path.rename(other)
    assert read_plan(other).kinds == tuple(kinds)
    assert read_plan(str(other)) == read_plan(other)


def test_a_named_format_wins_over_the_suffix(tmp_path):
    write_plan(tmp_path / "flight.txt", parse_plan(FLIGHT), "plan")
    assert (tmp_path / "flight.txt").read_text().startswith("{")


def lost(name: str, **plans: object) -> str:
    return "; ".join(format_plan(PlanFile.of(**plans), name).lost)


def test_losses_in_qgc_plans_are_reported():
    group = MissionItem(CMD.NAV_FENCE_CIRCLE_INCLUSION, 10, 2, param5=1, param6=2)
    vertex = MissionItem(CMD.NAV_FENCE_POLYGON_VERTEX_INCLUSION, 4, param5=1, param6=2)
    rally = MissionItem(CMD.NAV_RALLY_POINT, 1, param5=1, param6=2, param7=3, frame=FRAME.GLOBAL)
    two = [ReturnPoint((1.0, 2.0)), ReturnPoint((3.0, 4.0), 5.0, FRAME.GLOBAL)]
    assert lost("plan", fence=[group]) == "the inclusion group of fence item 0"
    assert "1 vertex in a row" in lost("plan", fence=[vertex])
    assert lost("plan", fence=fence_items(FenceAreas(return_points=two))) == "return points but the first"
    assert "altitude of the return point" in lost(
        "plan", fence=fence_items(FenceAreas(return_points=two[1:]))
    )
    assert "params 1 to 4 of rally point 0" in lost("plan", rally=[rally])
    assert "altitude of rally point 0" in lost("plan", rally=[rally])
    assert "infinite params of mission item 1" in lost("plan", mission=[MissionItem(CMD.NAV_WAYPOINT, inf)])


def test_waypoint_files_hold_no_infinities():
    plan = PlanFile.of([MissionItem(CMD.NAV_WAYPOINT, inf, param5=1, param6=2, param7=3)])
    written = format_plan(plan, "waypoints")
    assert "the infinite params of item 1" in written.lost
    assert isnan(parse_plan(written.text).mission.items[0].param1)
    for word in ("inf", "-Infinity", "1e999"):
        with pytest.raises(PlanFileError, match=f"line 3: param1 is '{word}', which is infinite"):
            parse_plan(written.text.replace("nan", word))


def test_losses_in_waypoint_files_are_reported():
    lost_parts = format_plan(parse_plan(FLIGHT), "waypoints").lost
    assert len(lost_parts) == 2
    assert lost_parts[0].startswith("the fence")
    assert lost_parts[1].startswith("the rally points")


def test_losses_in_fence_lists_are_reported():
    areas = FenceAreas(
        [Polygon(inclusion=True, vertices=SQUARE, group=1), Polygon(inclusion=False, vertices=SQUARE)],
        [Circle(inclusion=True, center=(1.0, 2.0), radius=3)],
        [ReturnPoint((47.05, 8.05), 30.0)],
    )
    lost_parts = lost("fence", fence=fence_items(areas), mission=[MissionItem(CMD.NAV_WAYPOINT)])
    for part in ("the mission", "polygons to stay out of (1)", "circles (1)", "groups (1)", "altitude"):
        assert part in lost_parts
    written = format_plan(PlanFile.of(fence=fence_items(FenceAreas(areas.polygons[:1]))), "fence")
    assert written.text.splitlines()[0] == "47.05 8.05"
    assert "no return point" in written.notes[0]


def test_losses_in_rally_lists_are_reported():
    strange = MissionItem(CMD.NAV_RALLY_POINT, 1, param5=1, param6=2, frame=FRAME.LOCAL_NED)
    usual = MissionItem(CMD.NAV_RALLY_POINT, 1, param5=1, param6=2)
    lost_parts = lost("rally", rally=[strange, usual], fence=fence_items(FenceAreas([Polygon(True, SQUARE)])))
    assert (
        lost_parts == "the fence; rally point 0, a NAV_RALLY_POINT in frame 1; params 1 to 4 of rally point 1"
    )


@pytest.mark.parametrize("name", ["fence", "rally"])
def test_a_format_refuses_plans_that_it_cannot_hold(name):
    with pytest.raises(PlanFileError, match="the plan has none"):
        format_plan(PlanFile.of([MissionItem(CMD.NAV_WAYPOINT)]), name)


def test_qgc_plans_without_a_home_get_the_first_position():
    items = [MissionItem(CMD.NAV_TAKEOFF), MissionItem(CMD.NAV_WAYPOINT, param5=47.5, param6=8.5)]
    written = format_plan(PlanFile.of(items), "plan")
    assert "no home" in written.notes[0]
    assert parse_plan(written.text).home == Home(47.5, 8.5, 0.0)


def test_the_settings_of_a_plan_are_kept():
    settings = Settings(12, 1, 18.5, 4.25)
    plan = replace(parse_plan(FLIGHT), settings=settings)
    assert returned(plan, "plan").settings == settings
    assert returned(plan, "json").settings == settings


def test_a_path_that_names_no_format_and_one_that_does_not_exist(tmp_path):
    with pytest.raises(PlanFileError, match=r"flight\.docx: its suffix names no format: use one of \.json"):
        write_plan(tmp_path / "flight.docx", PlanFile())
    with pytest.raises(PlanFileError, match="there is no format 'kml'"):
        write_plan(tmp_path / "flight.plan", PlanFile(), "kml")
    with pytest.raises(PlanFileError, match=r"missing\.plan: No such file"):
        read_plan(tmp_path / "missing.plan")
    with pytest.raises(PlanFileError, match="No such file"):
        write_plan(tmp_path / "nowhere" / "flight.plan", PlanFile())


def test_nan_is_null_and_nan():
    plan = PlanFile.of([MissionItem(CMD.NAV_WAYPOINT, param4=nan, param5=47.0, param6=8.0)], home=Home(1, 2))
    assert "null" in format_plan(plan, "plan").text
    assert "\tnan\t" in format_plan(plan, "waypoints").text
