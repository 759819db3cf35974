"""Surveys of areas and corridors, with shapely as the judge of coverage."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from shapely.geometry import LineString, Polygon
from shapely.ops import unary_union

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.files.plans.model import params_of
from mavstack.swarm.search.camera import Camera
from mavstack.swarm.search.division import Searcher
from mavstack.swarm.search.missions import MissionOptions
from mavstack.swarm.search.surveys import Survey, frame_of, plan_area, plan_corridor, to_degrees, to_metres

FIELD = [(47.3970, 8.5450), (47.3970, 8.5476), (47.3982, 8.5476), (47.3982, 8.5460), (47.3990, 8.5450)]
POND = [(47.3974, 8.5456), (47.3974, 8.5462), (47.3979, 8.5462), (47.3979, 8.5456)]
FRAME = frame_of(FIELD)


def covered(tracks, spacing):
    return unary_union(
        [LineString([each.start, each.end]).buffer(spacing / 2 + 1e-6, cap_style="flat") for each in tracks]
    )


@pytest.mark.parametrize("division", ["strips", "grid"])
@pytest.mark.parametrize("count", [1, 3, 7])
def test_vehicles_cover_an_area_in_equal_shares(division, count):
    searchers = [Searcher(start=(20.0 * index, 0.0)) for index in range(count)]
    survey = Survey(spacing=8.0, division=division)
    plan = plan_area(FIELD, searchers, survey, obstacles=[POND])
    area = Polygon(to_metres(FRAME, FIELD), [to_metres(FRAME, POND)])
    tracks = [track for share in plan.shares for track in share.tracks]
    assert area.intersection(covered(tracks, 8.0)).area / area.area >= 0.995
    assert plan.size == pytest.approx(area.area, rel=1e-6)
    lengths = [share.length for share in plan.shares]
    assert max(lengths) - min(lengths) <= 0.05 * sum(lengths) / count


def test_regions_of_a_grid_are_connected_and_near_their_vehicles():
    starts = [(0.0, 0.0), (0.0, 190.0), (220.0, 0.0)]
    plan = plan_area(FIELD, [Searcher(start=each) for each in starts], Survey(spacing=8.0, division="grid"))
    for share, start in zip(plan.shares, starts, strict=True):
        region = covered(share.tracks, 8.0).buffer(0.01)
        assert region.geom_type == "Polygon"
        centre = region.centroid
        assert min(starts, key=lambda each: math.dist(each, (centre.x, centre.y))) == start


@given(
    st.lists(st.tuples(st.floats(0, 220), st.floats(0, 190)), min_size=1, max_size=6),
    st.floats(12.0, 30.0),
    st.floats(0.0, 180.0),
)
def test_regions_cover_the_area_once(starts, spacing, bearing):
    survey = Survey(spacing=spacing, division="grid", bearing=bearing)
    plan = plan_area(FIELD, [Searcher(start=each) for each in starts], survey)
    alone = plan_area(FIELD, [Searcher()], Survey(spacing=spacing, bearing=bearing))
    total = sum(share.length for share in plan.shares)
    assert total == pytest.approx(alone.shares[0].length, rel=1e-6)
    assert all(share.tracks for share in plan.shares)


def test_a_crosshatch_flies_the_area_twice():
    single = plan_area(FIELD, [Searcher()], Survey(bearing=0.0))
    double = plan_area(FIELD, [Searcher()], Survey(bearing=0.0, crosshatch=True))
    assert double.shares[0].length == pytest.approx(2 * single.shares[0].length, rel=0.15)
    ends = double.shares[0].tracks[-1]
    assert abs(ends.end[0] - ends.start[0]) < 1.0  # east or west


def test_a_camera_decides_on_spacing_and_pictures():
    survey = Survey(camera=Camera(), side_overlap=0.5, mission=MissionOptions(altitude=40.0))
    plan = plan_area(FIELD, [Searcher()], survey)
    assert plan.spacing == pytest.approx(0.5 * Camera().footprint(40.0)[0])
    triggers = [
        item
        for item in plan.shares[0].items
        if item.command == common.MavCmd.DO_SET_CAM_TRIGG_DIST and item.param1
    ]
    assert triggers[0].param1 == pytest.approx(0.25 * Camera().footprint(40.0)[1])
    assert Survey().track_spacing == 20.0


def test_a_corridor_is_covered_along_its_route():
    route = [(47.3970, 8.5450), (47.3990, 8.5460), (47.3992, 8.5490)]
    plan = plan_corridor(route, 60.0, [Searcher(), Searcher()], Survey(spacing=20.0))
    middle = LineString(to_metres(frame_of(route), route))
    tracks = [track for share in plan.shares for track in share.tracks]
    corridor = middle.buffer(30.0, cap_style="flat", join_style="mitre")
    assert corridor.intersection(covered(tracks, 20.0).buffer(0.1)).area / corridor.area >= 0.98
    assert plan.bearing is None
    one, other = (share.length for share in plan.shares)
    assert one == pytest.approx(other, rel=0.01)


def test_missions_begin_and_end_as_asked():
    mission = MissionOptions(altitude=50.0, take_off=False, return_home=False)
    items = plan_area(FIELD, [Searcher()], Survey(mission=mission)).shares[0].items
    assert {item.command for item in items} == {common.MavCmd.NAV_WAYPOINT}
    assert {params_of(item)[6] for item in items} == {50.0}


def test_places_are_converted_both_ways():
    for place in FIELD:
        assert to_degrees(FRAME, to_metres(FRAME, [place])[0]) == pytest.approx(place, abs=1e-9)


@pytest.mark.parametrize(
    "call",
    [
        lambda: plan_area(FIELD[:2], [Searcher()], Survey()),
        lambda: plan_area([(91.0, 8.0), *FIELD], [Searcher()], Survey()),
        lambda: plan_area(FIELD, [], Survey()),
        lambda: plan_area(FIELD, [], Survey(division="grid")),
        lambda: plan_area(FIELD, [Searcher()] * 60, Survey(spacing=100.0, division="grid")),
        lambda: plan_corridor(FIELD[:1], 20.0, [Searcher()], Survey()),
        lambda: plan_corridor(FIELD, -1.0, [Searcher()], Survey()),
        lambda: plan_corridor(FIELD, 1e6, [Searcher()], Survey(spacing=1.0)),
        lambda: Survey(division="halves"),
        lambda: Survey(turn_radius=-1.0),
        lambda: Survey(bearing=math.nan),
    ],
)
def test_impossible_surveys_are_refused(call):
    with pytest.raises(InvalidArgumentError):
        call()
