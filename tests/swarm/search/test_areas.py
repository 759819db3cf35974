"""Areas are covered, with shapely as the judge."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from shapely.geometry import LineString, Polygon
from shapely.ops import unary_union

from mavstack.errors import InvalidArgumentError
from mavstack.swarm.search.areas import Area, cover

U_SHAPE = [(0, 0), (200, 0), (200, 60), (80, 60), (80, 140), (200, 140), (200, 200), (0, 200)]
TRIANGLE = [(20, 20), (50, 30), (40, 60)]


def coverage(area, cells, spacing):
    """Return the covered part of an area."""
    strips = [
        LineString([track.start, track.end]).buffer(spacing / 2, cap_style="flat")
        for cell in cells
        for track in cell
    ]
    whole = Polygon(area.outline, area.obstacles)
    return whole.intersection(unary_union(strips)).area / whole.area


@pytest.mark.parametrize("bearing", [None, 0.0, 33.0, 90.0, 135.0])
@pytest.mark.parametrize("obstacles", [[], [TRIANGLE]])
def test_concave_areas_with_obstacles_are_covered(bearing, obstacles):
    area = Area(U_SHAPE, obstacles)
    assert coverage(area, cover(area, 12.0, bearing=bearing), 12.0) >= 0.995


def test_the_tip_of_an_oblique_corner_is_covered():
    outline = [
        (78, 3),
        (155, 68),
        (59, 45),
        (53, 52),
        (-125, -24),
        (35, -78),
        (94, -37),
        (71, -27),
        (160, -21),
    ]
    area = Area(outline)
    assert coverage(area, cover(area, 36.0, bearing=1.0), 36.0) >= 0.999


@given(st.integers(0, 10**6), st.integers(3, 11), st.floats(4.0, 40.0), st.floats(0.0, 180.0))
def test_random_areas_are_covered(seed, corners, spacing, bearing):
    random = np.random.default_rng(seed)
    angles = np.sort(random.uniform(0.0, 2.0 * np.pi, corners))
    radius = random.uniform(60.0, 200.0, corners)
    outline = list(zip(radius * np.cos(angles), radius * np.sin(angles), strict=True))
    assume(Polygon(outline).is_valid and Polygon(outline).area > 2000.0)
    area = Area(outline)
    assert coverage(area, cover(area, spacing, bearing=bearing), spacing) >= 0.995


def test_a_rectangle_is_one_cell_of_tracks_along_its_long_side():
    area = Area([(0, 0), (400, 0), (400, 100), (0, 100)])
    (cell,) = cover(area, 25.0)
    assert len(cell) == 4
    assert cell[0].start == pytest.approx((0.0, 12.5))
    assert cell[0].end == pytest.approx((400.0, 12.5))
    assert cell[0].length == pytest.approx(400.0)
    assert area.size == 40_000.0


def test_an_obstacle_divides_the_area_into_four_cells():
    area = Area([(0, 0), (100, 0), (100, 100), (0, 100)], [[(40, 40), (60, 40), (60, 60), (40, 60)]])
    assert len(cover(area, 10.0, bearing=0.0)) == 4


@pytest.mark.parametrize(
    ("outline", "text"),
    [
        ([(0, 0), (1, 1)], "at least three corners"),
        ([(0, 0), (1, 1), (2, 2)], "must enclose an area"),
        ([(0, 0), (1, float("nan")), (2, 2)], "must have finite corners"),
    ],
)
def test_wrong_outlines_are_refused(outline, text):
    with pytest.raises(InvalidArgumentError, match=text):
        Area(outline)


def test_too_many_tracks_are_refused():
    with pytest.raises(InvalidArgumentError, match="at most 10000 are allowed"):
        cover(Area([(0, 0), (1e6, 0), (1e6, 1e6), (0, 1e6)]), 1.0)
    with pytest.raises(InvalidArgumentError, match="spacing must be finite and more than 0 m"):
        cover(Area(U_SHAPE), 0.0)
