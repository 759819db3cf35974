"""Shapes: against a slower way to say the same."""

from __future__ import annotations

from math import atan2, cos, hypot, inf, pi, remainder, sin

import pytest
from hypothesis import assume, given
from hypothesis import strategies as some

from mavstack.sim.autopilot.fence_shapes import Circle, Fence, Polygon, segment_distance

METRES = some.integers(-1000, 1000).map(float)
PLACES = some.tuples(METRES, METRES)
SQUARE = Polygon(((0, 0), (0, 10), (10, 10), (10, 0)))
#: A star-shaped polygon around a centre: some are concave, none crosses itself.
STARS = some.lists(some.floats(5, 500), min_size=3, max_size=12)


def star(radii: list[float], inclusion: bool = True) -> Polygon:
    turn = 2 * pi / len(radii)
    return Polygon(
        tuple((cos(at * turn) * radius, sin(at * turn) * radius) for at, radius in enumerate(radii)),
        inclusion,
    )


def winds_around(polygon: Polygon, place: tuple[float, float]) -> bool:
    """Return whether the corners go round a place once, as seen from it."""
    total = 0.0
    for begin, end in polygon.edges:
        first = atan2(begin[1] - place[1], begin[0] - place[0])
        second = atan2(end[1] - place[1], end[0] - place[0])
        total += remainder(second - first, 2 * pi)
    return abs(total) > pi


@pytest.mark.flight
@given(STARS, PLACES)
def test_inside_is_what_the_corners_go_round(radii: list[float], place: tuple[float, float]) -> None:
    polygon = star(radii)
    assume(polygon.edge_distance(place) > 1e-6)
    assert polygon.contains(place) == winds_around(polygon, place)


@pytest.mark.flight
@given(STARS, PLACES, METRES, METRES)
def test_a_polygon_can_be_moved(
    radii: list[float], place: tuple[float, float], north: float, east: float
) -> None:
    polygon = star(radii)
    assume(polygon.edge_distance(place) > 1e-3)
    moved = Polygon(tuple((corner[0] + north, corner[1] + east) for corner in polygon.corners))
    assert moved.contains((place[0] + north, place[1] + east)) == polygon.contains(place)


@pytest.mark.flight
@given(STARS, some.integers(0, 11), some.booleans(), PLACES)
def test_where_the_corners_begin_and_which_way_they_go_does_not_matter(
    radii: list[float], first: int, backwards: bool, place: tuple[float, float]
) -> None:
    polygon = star(radii)
    assume(polygon.edge_distance(place) > 1e-6)
    corners = polygon.corners[first:] + polygon.corners[:first]
    turned = Polygon(corners[::-1] if backwards else corners)
    assert turned.contains(place) == polygon.contains(place)
    assert turned.edge_distance(place) == pytest.approx(polygon.edge_distance(place))


@pytest.mark.flight
@given(PLACES, PLACES, PLACES)
def test_the_distance_to_a_line_against_many_points_of_it(
    place: tuple[float, float], begin: tuple[float, float], end: tuple[float, float]
) -> None:
    steps = 400
    points = (
        (begin[0] + (end[0] - begin[0]) * n / steps, begin[1] + (end[1] - begin[1]) * n / steps)
        for n in range(steps + 1)
    )
    nearest = min(hypot(place[0] - north, place[1] - east) for north, east in points)
    exact = segment_distance(place, begin, end)
    length = hypot(end[0] - begin[0], end[1] - begin[1])
    assert exact - 1e-6 <= nearest <= exact + length / steps


@given(PLACES, some.floats(1, 500), PLACES)
def test_circles(centre: tuple[float, float], radius: float, place: tuple[float, float]) -> None:
    circle, away = Circle(centre, radius), hypot(place[0] - centre[0], place[1] - centre[1])
    assert circle.contains(place) == (away < radius)
    assert circle.edge_distance(place) == pytest.approx(abs(away - radius))


def test_many_sides_are_a_circle() -> None:
    polygon, circle = star([100.0] * 360), Circle((0.0, 0.0), 100.0)
    for place in [(99.9, 0.0), (0.0, -99.9), (70.6, 70.6), (100.1, 0.0), (71.0, 71.0), (-300.0, 0.5)]:
        assert polygon.contains(place) == circle.contains(place)


def test_a_polygon_that_crosses_itself_has_a_hole() -> None:
    hourglass = Polygon(((0, 0), (10, 10), (10, 0), (0, 10)))
    assert hourglass.contains((1, 5)) != hourglass.contains((5, 1))


@pytest.mark.parametrize(
    ("shapes", "place", "every", "any_one"),
    [
        ((), (5, 5), True, True),
        ((SQUARE,), (5, 5), True, True),
        ((SQUARE,), (15, 5), False, False),
        ((SQUARE, Circle((0, 0), 3, inclusion=False)), (1, 1), False, False),
        ((SQUARE, Circle((0, 0), 3, inclusion=False)), (5, 5), True, True),
        ((SQUARE, Circle((30, 30), 5)), (5, 5), False, True),
        ((SQUARE, Circle((5, 5), 2)), (5, 5), True, True),
        ((Polygon(SQUARE.corners, inclusion=False),), (5, 5), False, False),
        ((Polygon(SQUARE.corners, inclusion=False),), (50, 5), True, True),
    ],
)
def test_several_shapes(
    shapes: tuple[Polygon | Circle, ...], place: tuple[float, float], every: bool, any_one: bool
) -> None:
    fence = Fence(shapes)
    assert fence.permits(place) == every
    assert fence.permits(place, union=True) == any_one


def test_how_far_beyond() -> None:
    fence = Fence((SQUARE, Circle((0, 0), 3, inclusion=False)))
    assert fence.breach_distance((5, 5)) == 0
    assert fence.breach_distance((17, 5)) == pytest.approx(7)
    assert fence.breach_distance((2, 0)) == pytest.approx(1)
    assert Fence().breach_distance((2, 0)) == 0
    assert Fence().edge_distance((2, 0)) == inf


@pytest.mark.flight
@given(STARS, STARS, PLACES)
def test_what_is_permitted_is_no_breach(
    first: list[float], second: list[float], place: tuple[float, float]
) -> None:
    fence = Fence((star(first), star(second, inclusion=False)))
    assume(fence.edge_distance(place) > 1e-6)
    assert fence.permits(place) == (fence.breach_distance(place) == 0)
