"""Ways around obstacles, with shapely as the judge."""

from __future__ import annotations

import numpy as np
from shapely.geometry import LineString, Polygon

from mavstack.swarm.search.areas import Area
from mavstack.swarm.search.detours import detour
from tests.swarm.search.test_areas import TRIANGLE, U_SHAPE

AREA = Area(U_SHAPE, [TRIANGLE])


def test_a_free_way_is_straight():
    assert detour(AREA, (10.0, 100.0), (70.0, 100.0)) == []


def test_a_way_along_an_edge_within_the_smallest_numbers():
    assert detour(AREA, (-2.38198603827e-312, 10.0), (-2.381986038273e-312, 100.0)) is not None


def test_the_way_between_the_arms_goes_around_both_corners():
    assert detour(AREA, (190.0, 30.0), (190.0, 170.0)) == [(80.0, 60.0), (80.0, 140.0)]


def test_random_ways_stay_inside_and_are_not_longer_than_around_everything():
    random = np.random.default_rng(11)
    whole = Polygon(U_SHAPE, [TRIANGLE])
    inside = [
        tuple(place)
        for place in random.uniform(0.0, 200.0, (60, 2))
        if whole.contains(LineString([place, place + 0.01]))
    ]
    for start, end in zip(inside[::2], inside[1::2], strict=False):
        way = LineString([start, *detour(AREA, start, end), end])
        assert whole.buffer(1e-6).contains(way)
        assert way.length < 700.0
