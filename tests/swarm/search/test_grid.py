"""Connected shares of a grid."""

from __future__ import annotations

import pytest

from mavstack.errors import InvalidArgumentError
from mavstack.swarm.search.areas import Area, cover
from mavstack.swarm.search.division import Searcher
from mavstack.swarm.search.grid import divide_by_grid

L_SHAPE = Area([(0, 0), (0, 400), (300, 400), (300, 200), (150, 200), (150, 0)])


def lengths(shares):
    return [sum(track.length for cell in share for track in cell) for share in shares]


@pytest.mark.parametrize("starts", [[(0, 0)] * 4, [(0, 0), (300, 400), (0, 400)], [None] * 5])
def test_shares_are_equal_wherever_the_vehicles_start(starts):
    searchers = [Searcher(start=each) for each in starts]
    found = lengths(divide_by_grid(cover(L_SHAPE, 10.0), searchers, 10.0))
    assert max(found) - min(found) <= 20.0  # two cells
    assert sum(found) == pytest.approx(9000.0)


def test_shares_follow_speed_and_endurance():
    searchers = [Searcher(), Searcher(speed=10.0), Searcher(endurance=3.0)]
    found = lengths(divide_by_grid(cover(L_SHAPE, 10.0), searchers, 10.0))
    assert found == pytest.approx([1500.0, 3000.0, 4500.0], abs=20.0)


def test_parts_of_an_area_without_a_vehicle_are_searched_too():
    two = [*cover(Area([(0, 0), (0, 50), (50, 50), (50, 0)]), 10.0)]
    other = cover(Area([(500, 0), (500, 50), (550, 50), (550, 0)]), 10.0)
    shares = divide_by_grid([*two, *other], [Searcher(start=(0, 0)), Searcher(start=(10, 0))], 10.0)
    assert sum(lengths(shares)) == pytest.approx(500.0)


@pytest.mark.parametrize("count", [0, 4])
def test_impossible_numbers_of_vehicles_are_refused(count):
    cells = cover(Area([(0, 0), (0, 20), (20, 20), (20, 0)]), 10.0)
    with pytest.raises(InvalidArgumentError, match=r"at least one"):
        divide_by_grid(cells, [Searcher()] * (count + (1 if count else 0)), 10.0)
