"""Waypoint text in the forms that are about, and where the home is in each."""

from __future__ import annotations

import pytest

from mavstack.errors import PlanFileError
from mavstack.files.plans import Home, PlanFile, fence_items, format_plan, parse_plan
from mavstack.files.plans.fence import Circle, FenceAreas
from mavstack.files.plans.model import CMD, FRAME, params_of
from mavstack.services.mission import PlanType
from tests.files.plans.plans import FENCE, FLIGHT, WAYPOINTS, exactly, names


@pytest.mark.parametrize(
    "content",
    [
        WAYPOINTS.encode(),
        WAYPOINTS.replace("\t", " ").encode(),
        WAYPOINTS.replace("\t", ", ").encode(),
        WAYPOINTS.replace("\n", "\r\n").encode(),
        WAYPOINTS.replace("\n", "\r").encode(),
        b"\xef\xbb\xbf" + WAYPOINTS.encode(),
        WAYPOINTS.encode("utf-16"),
        ("# my field\n\n" + WAYPOINTS.replace("\n", " # said\n\n")).encode(),
        WAYPOINTS.replace("\n", "\n#caf\xe9\n").encode("latin-1"),
        WAYPOINTS.replace("QGC WPL", "qgc  wpl").encode(),
        WAYPOINTS.replace("\t16\t", "\t16.0\t").encode(),
        WAYPOINTS.rstrip().encode(),
    ],
)
def test_encodings_and_line_ends(content):
    assert exactly(parse_plan(content)) == exactly(parse_plan(WAYPOINTS))


def test_version_110_begins_with_the_home():
    plan = parse_plan(WAYPOINTS)
    assert plan.home == Home(47.3977419, 8.5455939, 488)
    assert len(plan.mission) == 5
    assert plan.mission.items[3].param1 == 1  # it says 2, where the home is 0
    assert plan.notes == ()


def test_version_120_has_no_home_and_counts_from_0():
    lines = ["QGC WPL 120", "0 1 3 16 0 0 0 0 47 8 20 1", "1 0 2 177 0 3 0 0 0 0 0 1"]
    plan = parse_plan("\n".join(lines))
    assert (plan.home, len(plan.mission), plan.mission.items[1].param1) == (None, 2, 0)


def test_version_100_has_columns_of_its_own():
    #        index frame action p3 p4 p1 p2 current lon lat alt - autocontinue
    lines = ["QGC WPL 100", "0 0 25 0 0 0 0 1 8.1 47.1 400 0 1", "1 3 27 30 45 1 2 0 8.2 47.2 50 0 0"]
    plan = parse_plan("\n".join(lines))
    assert plan.home == Home(47.1, 8.1, 400)
    (item,) = plan.mission.items
    assert (item.name, params_of(item)) == ("NAV_LOITER_UNLIM", (1, 2, 30, 45, 47.2, 8.2, 50))
    assert (item.frame, item.autocontinue) == (FRAME.GLOBAL_RELATIVE_ALT, False)
    with pytest.raises(Exception, match="line 2: version 100 has no action 99"):
        parse_plan("QGC WPL 100\n0 0 99 0 0 0 0 1 8.1 47.1 400 0 1")


def test_an_empty_home_is_none():
    blank = "QGC WPL 110\n0 1 0 {} 0 0 0 0 0 0 0 1\n1 0 3 16 0 0 0 0 47 8 20 1\n"
    for command in (0, 16):  # Mission Planner writes 0 where it knows no home
        plan = parse_plan(blank.format(command))
        assert (plan.home, len(plan.mission), plan.notes) == (None, 1, ())


def test_a_first_item_that_cannot_be_a_home_is_flown_and_reported():
    plan = parse_plan("QGC WPL 110\n0 1 3 22 0 0 0 0 47 8 20 1\n1 0 2 177 0 3 0 0 0 0 0 1\n")
    assert (plan.home, names(plan.mission)) == (None, ["NAV_TAKEOFF", "DO_JUMP"])
    assert "NAV_TAKEOFF instead of the home" in plan.notes[0]
    assert plan.mission.items[1].param1 == 0


def test_a_home_relative_to_home_is_reported():
    plan = parse_plan("QGC WPL 110\n0 1 3 16 0 0 0 0 47 8 20 1\n1 0 3 16 0 0 0 0 47 8 20 1\n")
    assert (plan.home, len(plan.mission)) == (Home(47, 8, 20), 1)
    assert "read as the home" in plan.notes[0]


def test_indexes_with_gaps_are_reported():
    plan = parse_plan(WAYPOINTS.replace("\n4\t", "\n7\t"))
    assert exactly(plan) == exactly(parse_plan(WAYPOINTS))
    assert "not consecutive" in plan.notes[0]


def test_a_fence_with_and_without_a_home():
    fence = parse_plan(FENCE)
    without = format_plan(fence, "waypoints").text
    assert without.splitlines()[1].startswith("1\t0\t0\t5001\t4\t")
    header, *lines = without.splitlines()
    with_home = "\n".join([header, "0 1 0 16 0 0 0 0 47 8 400 1", *lines])
    for text in (without, with_home):
        plan = parse_plan(text)
        assert plan.kinds == (PlanType.FENCE,)
        assert exactly(plan)[1:] == exactly(fence)[1:]
    assert parse_plan(with_home).home == Home(47, 8, 400)


def test_the_home_of_a_fence_is_left_out_and_reported():
    areas = FenceAreas(circles=[Circle(inclusion=True, center=(47.0, 8.0), radius=10)])
    written = format_plan(PlanFile.of(fence=fence_items(areas), home=Home(47, 8, 400)), "waypoints")
    assert len(written.text.splitlines()) == 2
    assert written.lost == ()
    assert "no home" in written.notes[0]


def test_a_mixture_of_plan_types_stays_one_plan_with_problems():
    from mavstack.files.plans import check

    plan = parse_plan(WAYPOINTS + "6\t0\t0\t5003\t30\t0\t0\t0\t47\t8\t0\t1\n")
    assert plan.kinds == (PlanType.MISSION,)
    assert [str(problem) for problem in check(plan)] == [
        "mission item 6: NAV_FENCE_CIRCLE_INCLUSION: it belongs to a fence, not to a mission"
    ]


def test_written_as_mission_planner_and_mavproxy_read_it():
    assert format_plan(parse_plan(FLIGHT).only([PlanType.MISSION]), "waypoints").text == (
        "QGC WPL 110\n"
        "0\t1\t0\t16\t0\t0\t0\t0\t47.3977419\t8.5455939\t488\t1\n"
        "1\t0\t3\t22\t0\t0\t0\tnan\t0\t0\t20\t1\n"
        "2\t0\t3\t16\t3\t0\t0\tnan\t47.398\t8.546\t30\t1\n"
        "3\t0\t0\t16\t0\t0\t0\t90\t47.3985\t8.545\t520.25\t0\n"
        "4\t0\t2\t177\t2\t3\t0\t0\t0\t0\t0\t1\n"
        "5\t0\t2\t20\t0\t0\t0\t0\t0\t0\t0\t1\n"
    )
    assert format_plan(PlanFile(), "waypoints").text == "QGC WPL 110\n"


def test_an_older_fence_file():
    plan = parse_plan(FENCE)
    point, *vertices = sorted(plan.fence.items, key=lambda item: item.command)
    assert (point.command, point.param5, point.param6) == (CMD.NAV_FENCE_RETURN_POINT, 47.3977, 8.5456)
    assert [(item.param1, item.param5, item.param6) for item in vertices] == [
        (4, 47.4, 8.54),
        (4, 47.4, 8.55),
        (4, 47.39, 8.55),
        (4, 47.39, 8.54),
    ]
    open_polygon = parse_plan(FENCE.rsplit("\n", 2)[0])
    assert open_polygon.fence == plan.fence
    assert "not closed" in open_polygon.notes[0]


def test_a_polygon_file_has_no_return_point():
    plan = parse_plan("47.40 8.54\n47.40 8.55\n47.39 8.55\n47.40 8.54\n")
    assert {item.command for item in plan.fence.items} == {CMD.NAV_FENCE_POLYGON_VERTEX_INCLUSION}
    assert len(plan.fence) == 3
    assert "without a return point" in plan.notes[0]


def test_rally_points_of_the_older_kind():
    plan = parse_plan("RALLY 47.1 8.1 25 0 0 0\nrally 47.2 8.2 500 0 0 4\nRALLY 47.3 8.3 30 0 0 28\n")
    assert [item.frame for item in plan.rally.items] == [3, 0, 10]
    assert plan.problems == ()
    rally_plan = parse_plan("RALLY 47.1 8.1 25 40 90 2\n")
    assert rally_plan.problems == ()
    unused = "the break altitude, the landing direction, the flag to land immediately"
    assert rally_plan.notes == (f"not used of the rally points: {unused}",)


def test_a_rally_file_of_mavproxy_is_read_without_problems():
    """MAVProxy separates the values by tabs, and gives each point a break altitude."""
    plan = parse_plan("RALLY -35.363261\t149.165230\t100.000000\t40.000000\t0.000000\t0\n" * 2)
    assert len(plan.rally) == 2
    assert plan.problems == ()
    assert plan.notes == ("not used of the rally points: the break altitude",)


def test_a_rally_line_of_other_columns_is_refused_with_the_columns():
    with pytest.raises(PlanFileError) as raised:
        parse_plan("RALLY 47.1 8.1 25 0 0 0\nRALLY 47.1 8.1 25\n", "r.txt")
    columns = "latitude, longitude, altitude, break altitude, landing direction, flags"
    assert (
        str(raised.value) == f"r.txt: line 2: it is 'RALLY' and 3 values instead of RALLY and six: {columns}"
    )
