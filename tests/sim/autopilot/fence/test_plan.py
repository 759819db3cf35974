"""Which fences are taken."""

from __future__ import annotations

from math import inf, isnan, nan

import pytest
from hypothesis import given
from hypothesis import strategies as some

from mavstack.services.mission import MissionItem, Plan, PlanType
from mavstack.sim.autopilot.fence.plan import check_fence_item, check_fence_plan, read_fence
from mavstack.sim.autopilot.fence_shapes import Circle, Fence, Polygon
from mavstack.sim.motion import LocalFrame
from mavstack.sim.vehicle_types import DEFAULT_HOME
from tests.sim.autopilot.mission.harness import CMD, FRAME, RESULT, item

IN, OUT = CMD.NAV_FENCE_POLYGON_VERTEX_INCLUSION, CMD.NAV_FENCE_POLYGON_VERTEX_EXCLUSION
CORNERS = [(0.0, 0.0), (0.0, 50.0), (50.0, 50.0), (50.0, 0.0)]
FRAME_HERE = LocalFrame(DEFAULT_HOME.latitude, DEFAULT_HOME.longitude, DEFAULT_HOME.altitude)


def corner(
    north: float, east: float, count: float = 4, command: int = IN, frame: int = FRAME.GLOBAL
) -> MissionItem:
    return item(command, count, at=(north, east, 0.0), frame=frame)


def polygon(command: int = IN, corners: list[tuple[float, float]] = CORNERS) -> list[MissionItem]:
    return [corner(*place, len(corners), command) for place in corners]


def circle(radius: float, command: int = CMD.NAV_FENCE_CIRCLE_INCLUSION) -> MissionItem:
    return item(command, radius, at=(10.0, 20.0, 0.0), frame=FRAME.GLOBAL)


RETURN = item(CMD.NAV_FENCE_RETURN_POINT, at=(5.0, 6.0, 30.0), frame=FRAME.GLOBAL_RELATIVE_ALT)


def judged(*items: MissionItem) -> int:
    return check_fence_plan(Plan.of(items, PlanType.FENCE))


@pytest.mark.parametrize(
    ("wanted", "result"),
    [
        (corner(0, 0), RESULT.ACCEPTED),
        (corner(0, 0, 2), RESULT.INVALID_PARAM1),
        (corner(0, 0, 3.5), RESULT.INVALID_PARAM1),
        (corner(0, 0, nan), RESULT.INVALID_PARAM1),
        (corner(0, 0, inf), RESULT.INVALID_PARAM1),
        (corner(0, 0, frame=FRAME.LOCAL_NED), RESULT.UNSUPPORTED_FRAME),
        (corner(0, 0, frame=FRAME.GLOBAL_TERRAIN_ALT), RESULT.UNSUPPORTED_FRAME),
        (circle(0), RESULT.INVALID_PARAM1),
        (circle(-5), RESULT.INVALID_PARAM1),
        (circle(nan), RESULT.INVALID_PARAM1),
        (item(IN, 3, 0, 0, 0, 95.0, 8.0, frame=FRAME.GLOBAL), RESULT.INVALID_PARAM5_X),
        (item(IN, 3, 0, 0, 0, 45.0, nan, frame=FRAME.GLOBAL), RESULT.INVALID_PARAM6_Y),
        (item(CMD.NAV_RALLY_POINT, at=(1.0, 1.0, 1.0)), RESULT.UNSUPPORTED),
        (RETURN, RESULT.ACCEPTED),
    ],
)
def test_items(wanted: MissionItem, result: int) -> None:
    assert check_fence_item(wanted) == result


@pytest.mark.parametrize(
    ("items", "result"),
    [
        ([], RESULT.ACCEPTED),
        (polygon(), RESULT.ACCEPTED),
        ([*polygon(), *polygon(OUT), circle(5), RETURN], RESULT.ACCEPTED),
        ([RETURN, circle(5), *polygon()], RESULT.ACCEPTED),
        (polygon()[:3], RESULT.INVALID),
        ([*polygon()[:3], circle(5)], RESULT.INVALID),
        ([*polygon()[:2], *polygon(OUT)[:2]], RESULT.INVALID),
        ([*polygon()[:3], corner(1, 1, 5)], RESULT.INVALID),
        ([*polygon()[:2], RETURN, *polygon()[2:]], RESULT.INVALID),
        ([corner(0, 0, 70000)], RESULT.INVALID),
        ([RETURN, RETURN], RESULT.INVALID),
    ],
)
def test_plans(items: list[MissionItem], result: int) -> None:
    assert judged(*items) == result


def test_what_it_means() -> None:
    items = [
        *polygon(),
        *polygon(OUT, CORNERS[:3]),
        circle(7),
        circle(8, CMD.NAV_FENCE_CIRCLE_EXCLUSION),
        RETURN,
    ]
    fence = read_fence(items, FRAME_HERE)
    first, second, third, fourth = fence.shapes
    assert isinstance(first, Polygon)
    assert isinstance(second, Polygon)
    assert [first.inclusion, second.inclusion] == [True, False]
    for found, wanted in zip(first.corners, CORNERS, strict=True):
        assert found == pytest.approx(wanted, abs=0.05)
    assert len(second.corners) == 3
    assert isinstance(third, Circle)
    assert isinstance(fourth, Circle)
    assert [third.radius, fourth.radius] == [7, 8]
    assert [third.inclusion, fourth.inclusion] == [True, False]
    assert fence.return_point == pytest.approx((5, 6, -30), abs=0.05)


def test_a_return_point_without_altitude() -> None:
    fence = read_fence([item(CMD.NAV_FENCE_RETURN_POINT, at=(5.0, 6.0, 0.0))], FRAME_HERE)
    assert fence.return_point is not None
    assert isnan(fence.return_point[2])


def test_across_the_antimeridian() -> None:
    here = LocalFrame(0.0, 179.9999, 0.0)
    places = [(-0.001, 179.999), (-0.001, -179.999), (0.001, -179.999), (0.001, 179.999)]
    items = [item(IN, 4, 0, 0, 0, *place, frame=FRAME.GLOBAL) for place in places]
    fence = read_fence(items, here)
    assert fence.permits((0.0, 0.0))
    assert fence.permits((0.0, 100.0))
    assert not fence.permits((0.0, 200.0))
    assert not fence.permits((0.0, -150.0))


def test_what_is_not_consistent_fences_nothing() -> None:
    assert read_fence(polygon()[:3], FRAME_HERE) == Fence()


@given(
    some.lists(some.sampled_from([*polygon(), *polygon(OUT, CORNERS[:3]), circle(5), RETURN]), max_size=10)
)
def test_what_is_taken_has_all_its_corners(items: list[MissionItem]) -> None:
    if judged(*items) != RESULT.ACCEPTED:
        return
    shapes = read_fence(items, FRAME_HERE).shapes
    corners = sum(len(shape.corners) if isinstance(shape, Polygon) else 1 for shape in shapes)
    assert corners == sum(item.command != CMD.NAV_FENCE_RETURN_POINT for item in items)
