"""Shares of an area: equal times, all tracks, wings that can turn."""

from __future__ import annotations

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.errors import InvalidArgumentError
from mavstack.swarm.search.areas import Area, Track, cover
from mavstack.swarm.search.division import Searcher, divide, order_tracks
from tests.swarm.search.test_areas import TRIANGLE, U_SHAPE

AREA = Area(U_SHAPE, [TRIANGLE])


def length(tracks):
    return sum(track.length for track in tracks)


@given(st.lists(st.tuples(st.floats(1.0, 20.0), st.floats(0.2, 3.0)), min_size=1, max_size=8))
def test_shares_are_in_proportion_and_nothing_is_lost(measures):
    tracks = order_tracks(cover(AREA, 12.0))
    searchers = [Searcher(speed, endurance) for speed, endurance in measures]
    shares = divide(tracks, searchers)
    assert sum(map(length, shares)) == pytest.approx(length(tracks))
    weights = [each.speed * each.endurance for each in searchers]
    for share, weight in zip(shares, weights, strict=True):
        fair = length(tracks) * weight / sum(weights)
        assert length(share) == pytest.approx(fair, rel=0.05, abs=1.0)


def test_a_vehicle_takes_the_part_near_its_start():
    tracks = order_tracks(cover(Area([(0, 0), (400, 0), (400, 100), (0, 100)]), 25.0), (0.0, 0.0))
    far, near = divide(tracks, [Searcher(start=(0.0, 100.0)), Searcher(start=(0.0, 0.0))])
    assert near[0].start == pytest.approx((0.0, 12.5))
    assert far[-1].start[1] == pytest.approx(87.5)


def test_tracks_are_flown_back_and_forth_from_the_near_corner():
    (cell,) = cover(Area([(0, 0), (400, 0), (400, 100), (0, 100)]), 25.0)
    ordered = order_tracks([cell], (400.0, 100.0))
    assert ordered[0].start == pytest.approx((400.0, 87.5))
    assert ordered[1].start == pytest.approx((0.0, 62.5))


@given(st.integers(3, 40), st.floats(1.0, 60.0))
def test_a_wing_has_room_to_turn(count, radius):
    rows = [Track((0.0, 10.0 * index), (500.0, 10.0 * index), 0) for index in range(count)]
    ordered = order_tracks([rows], turn_radius=radius)
    assert sorted(track.start[1] for track in ordered) == [10.0 * index for index in range(count)]
    gaps = [abs(after.start[1] - before.start[1]) for before, after in pairwise(ordered)]
    narrow = sum(gap < min(2.0 * radius, 10.0 * (count // 2 - 1)) - 1e-6 for gap in gaps)
    assert narrow <= max(2, count // 3)  # where a block of rows ends


def test_an_area_needs_a_vehicle():
    with pytest.raises(InvalidArgumentError, match="at least one vehicle"):
        divide([], [])
    with pytest.raises(InvalidArgumentError, match="speed must be finite"):
        Searcher(speed=0.0)
