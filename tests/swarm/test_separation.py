"""Distances in which height counts half."""

from __future__ import annotations

import math
import sys

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.errors import MissingExtraError
from mavstack.swarm.separation import distances, import_libraries, near_pairs, nearest_pair, pairs_below


def test_height_counts_half():
    points = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 10.0], [6.0, 0.0, 0.0]])
    assert distances(points)[0].tolist() == [math.inf, 5.0, 6.0]
    assert nearest_pair(points) == (5.0, 0, 1)
    assert nearest_pair(points[:1])[0] == math.inf
    assert pairs_below(distances(points), 6.5).tolist() == [[0, 1], [0, 2]]


# Places on a coarse grid are often equal, equally far, or exactly at the limit.
PLACES = st.lists(
    st.one_of(
        st.tuples(*[st.integers(-4, 4).map(float)] * 3),
        st.tuples(*[st.floats(-8.0, 8.0)] * 3),
        st.just((math.nan, math.nan, math.nan)),
    ),
    max_size=25,
)


@given(PLACES, st.sampled_from([0.5, 1.0, 2.0, 3.3]))
def test_near_pairs_are_those_of_all_distances(places, limit):
    points = np.array(places, dtype=float).reshape(-1, 3)
    between = distances(points)
    expected = pairs_below(between, limit)
    pairs, metres = near_pairs(points, limit)
    assert pairs.tolist() == expected.tolist()
    assert metres.tolist() == between[expected[:, 0], expected[:, 1]].tolist()


@given(PLACES)
def test_the_nearest_pair_has_the_smallest_of_all_distances(places):
    points = np.array(places, dtype=float).reshape(-1, 3)
    between = distances(points)
    smallest = float(np.where(np.isnan(between), math.inf, between).min(initial=math.inf))
    nearest, first, second = nearest_pair(points)
    assert nearest == pytest.approx(smallest, rel=1e-9, abs=1e-150)
    if nearest < math.inf:
        assert first < second
        assert between[first, second] == pytest.approx(nearest, rel=1e-9, abs=1e-150)


def test_what_swarms_need_is_imported_before_they_fly(monkeypatch):
    import_libraries()
    assert {"scipy.optimize", "scipy.spatial"} <= sys.modules.keys()
    monkeypatch.setitem(sys.modules, "scipy.spatial", None)
    with pytest.raises(MissingExtraError, match="swarms need scipy"):
        import_libraries()
