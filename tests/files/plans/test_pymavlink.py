"""Plan files are read and written as pymavlink's loaders read and write them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink import mavutil, mavwp

from mavstack.files.plans import (
    FenceAreas,
    PlanFile,
    Polygon,
    ReturnPoint,
    fence_areas,
    fence_items,
    read_plan,
    write_plan,
)
from mavstack.files.plans.model import CMD, FRAME, item_of, params_of
from mavstack.services.mission import PlanType
from tests.files.plans.plans import (
    FENCE,
    FLIGHT,
    HOMES,
    LATITUDES,
    LONGITUDES,
    PLACES,
    WAYPOINTS,
    missions,
    rally_points,
)

if TYPE_CHECKING:
    from pathlib import Path

#: mavwp writes six decimals.
SIX = 6e-7


@pytest.fixture(autouse=True)
def mavlink_2(monkeypatch):
    monkeypatch.setenv("MAVLINK20", "1")
    before = mavutil.mavlink
    mavutil.set_dialect("ardupilotmega")
    yield
    mavutil.mavlink = before


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    return tmp_path_factory.mktemp("plans")


def wire(loader: mavwp.MissionItemProtocol) -> list[tuple[float, ...]]:
    return [
        (each.frame, each.command, each.autocontinue, each.param1, each.param2, each.param3, each.param4,
         each.x, each.y, each.z)
        for each in (loader.wp(index) for index in range(loader.count()))
    ]  # fmt: skip


def ours(plan: PlanFile, kind: PlanType = PlanType.MISSION) -> list[tuple[float, ...]]:
    items = plan.for_vehicle(kind, home_first=True).items
    return [(item.frame, item.command, item.autocontinue, *params_of(item)) for item in items]


@given(missions(st.floats(allow_nan=False, allow_infinity=False)), st.none() | HOMES)
def test_pymavlink_reads_written_waypoints(folder, mission, home):
    plan = PlanFile.of(mission, home=home if mission else None)
    write_plan(folder / "ours.waypoints", plan)
    loader = mavwp.MAVWPLoader()
    loader.load(str(folder / "ours.waypoints"))
    assert wire(loader) == ours(plan)


@pytest.mark.parametrize("text", [WAYPOINTS, WAYPOINTS.replace("\t", "  "), WAYPOINTS + "\n# the end\n"])
def test_files_are_read_as_pymavlink_reads_them(folder, text):
    path = folder / "file.txt"
    path.write_text(text)
    loader = mavwp.MAVWPLoader()
    loader.load(str(path))
    assert wire(loader) == ours(read_plan(path))


@given(st.data())
def test_waypoints_of_pymavlink_are_read(folder, data):
    places = data.draw(st.lists(st.tuples(LATITUDES, LONGITUDES, st.floats(-100, 5000)), min_size=1))
    loader = mavwp.MAVWPLoader()
    for latitude, longitude, altitude in places:
        loader.add_latlonalt(latitude, longitude, altitude, terrain_alt=data.draw(st.booleans()))
    loader.save(str(folder / "theirs.txt"))
    plan = read_plan(folder / "theirs.txt")
    again = mavwp.MAVWPLoader()
    again.load(str(folder / "theirs.txt"))
    expected = wire(again)
    if plan.home is None:
        expected[0] = (0.0,) * 10
    assert [row[1:] for row in ours(plan)][1:] == [row[1:] for row in expected][1:]
    assert [row[7:] for row in ours(plan)] == [row[7:] for row in expected] if len(places) > 1 else True


def test_version_100_is_read_as_pymavlink_reads_it(folder):
    text = "QGC WPL 100\n0 0 25 0 0 0 0 1 8.1 47.1 400 0 1\n1 3 27 30 45 1 2 0 8.2 47.2 50 0 0\n"
    path = folder / "old.txt"
    path.write_text(text)
    loader = mavwp.MAVWPLoader()
    loader.load(str(path))
    assert wire(loader) == ours(read_plan(path))


@given(st.lists(PLACES, min_size=3, max_size=8, unique=True), PLACES)
def test_fence_lists_both_ways(folder, vertices, point):
    if point in vertices:
        return
    areas = FenceAreas(
        [Polygon(inclusion=True, vertices=tuple(vertices))], [], [ReturnPoint(point, 0, FRAME.GLOBAL)]
    )
    write_plan(folder / "ours.fen", PlanFile.of(fence=fence_items(areas)))
    loader = mavwp.MAVFenceLoader()
    assert loader.load(str(folder / "ours.fen")) == len(vertices) + 2
    points = [(loader.point(index).lat, loader.point(index).lng) for index in range(loader.count())]
    assert points == [point, *vertices, vertices[0]]
    loader.save(str(folder / "theirs.fen"))
    read = fence_areas(read_plan(folder / "theirs.fen").fence.items)
    if len(read.return_points) == 1 and len(read.polygons[0].vertices) == len(vertices):
        for mine, theirs in zip(vertices, read.polygons[0].vertices, strict=True):
            assert mine == pytest.approx(theirs, abs=SIX)


def test_an_older_fence_gives_the_same_items_as_in_pymavlink(folder):
    path = folder / "field.fen"
    path.write_text(FENCE)
    loader = mavwp.MissionItemProtocol_Fence()
    loader.load(str(path))
    theirs = {(each.command, each.param1, each.x, each.y) for each in loader.wpoints}
    plan = read_plan(path)
    mine = {
        (item.command, item.param1, int(item.param5 * 1e7), int(item.param6 * 1e7))
        for item in plan.fence.items
    }
    assert mine == theirs


def test_pymavlink_reads_written_fence_items(folder):
    path = folder / "area.waypoints"
    plan = read_plan(FLIGHT).only([PlanType.FENCE])
    write_plan(path, plan)
    loader = mavwp.MissionItemProtocol_Fence()
    loader.load(str(path))
    assert wire(loader) == ours(plan, PlanType.FENCE)
    assert {each.mission_type for each in loader.wpoints} == {PlanType.FENCE}
    loader.save(str(path))
    assert ours(read_plan(path), PlanType.FENCE) == ours(plan, PlanType.FENCE)


@given(rally_points())
def test_rally_lists_both_ways(folder, rally):
    if not rally:
        return
    rally = [
        item_of(
            CMD.NAV_RALLY_POINT, (*params_of(item)[:6], float(int(item.param7) % 1000)), 3, autocontinue=False
        )
        for item in rally
    ]
    write_plan(folder / "ours.rally", PlanFile.of(rally=rally))
    loader = mavwp.MAVRallyLoader()
    assert loader.load(str(folder / "ours.rally")) == len(rally)
    for item, point in zip(rally, loader.rally_points, strict=True):
        assert abs(point.lat - item.param5 * 1e7) < 1.01
        assert abs(point.lng - item.param6 * 1e7) < 1.01
        assert (point.alt, point.break_alt, point.land_dir, point.flags) == (int(item.param7), 0, 0, 0)
    loader.save(str(folder / "theirs.rally"))
    for mine, theirs in zip(rally, read_plan(folder / "theirs.rally").rally.items, strict=True):
        assert params_of(mine) == pytest.approx(params_of(theirs), abs=SIX)
        assert theirs.frame == mine.frame


def test_pymavlink_reads_written_rally_items(folder):
    path = folder / "rally.waypoints"
    plan = read_plan(FLIGHT).only([PlanType.RALLY])
    write_plan(path, plan)
    loader = mavwp.MissionItemProtocol_Rally()
    loader.load(str(path))
    assert wire(loader) == ours(plan, PlanType.RALLY)
