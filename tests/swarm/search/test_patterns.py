"""Search patterns of the IAMSAR manual."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.errors import InvalidArgumentError
from mavstack.swarm.search.patterns import (
    creeping_line,
    expanding_square,
    parallel_track,
    probability_of_detection,
    sector,
    spacing_for,
    track_line,
)


def legs(points):
    return np.linalg.norm(np.diff(points, axis=0), axis=1)


def turns(points):
    steps = np.diff(points, axis=0)
    return np.degrees(np.diff(np.unwrap(np.arctan2(steps[:, 1], steps[:, 0]))))


def test_an_expanding_square_turns_right_with_legs_of_1_1_2_2_3_3():
    square = expanding_square(50.0, 6)
    assert legs(square) == pytest.approx([50, 50, 100, 100, 150, 150])
    assert turns(square) == pytest.approx([90.0] * 5)
    assert square[0].tolist() == [0.0, 0.0]
    assert square[1] == pytest.approx([50.0, 0.0])
    assert expanding_square(50.0, 2, bearing=90.0)[1] == pytest.approx([0.0, 50.0])


def test_a_sector_search_has_nine_legs_of_the_radius_and_turns_120_degrees_right():
    corners = sector(200.0, bearing=30.0)
    assert legs(corners) == pytest.approx([200.0] * 9)
    assert np.linalg.norm(corners[[0, 3, 6, 9]], axis=1) == pytest.approx(np.zeros(4), abs=1e-9)
    assert turns(corners)[[0, 1, 3, 4, 6, 7]] == pytest.approx([120.0] * 6)
    assert turns(corners)[[2, 5]] == pytest.approx([0.0, 0.0], abs=1e-6)  # straight through the datum


def test_parallel_tracks_are_half_a_spacing_inside():
    tracks = parallel_track(400.0, 200.0, 50.0)
    assert len(tracks) == 8
    assert tracks[:2].tolist() == [[25.0, 25.0], [375.0, 25.0]]
    assert sorted(set(tracks[:, 1])) == [25.0, 75.0, 125.0, 175.0]
    creeping = creeping_line(400.0, 200.0, 50.0)
    assert creeping[:2].tolist() == [[25.0, 25.0], [25.0, 175.0]]
    assert sorted(set(creeping[:, 0])) == [25.0 + 50.0 * index for index in range(8)]


def test_a_track_line_returns_beside_the_route():
    there_and_back = track_line([(0, 0), (100, 0), (100, 100)], 20.0)
    assert there_and_back[0] == pytest.approx([0.0, 10.0])
    assert there_and_back[-1] == pytest.approx([0.0, -10.0])
    assert there_and_back[1] == pytest.approx([90.0, 10.0])
    assert len(track_line([(0, 0), (9, 0)], 2.0, sides=2)) == 8
    with pytest.raises(InvalidArgumentError, match="a corner twice"):
        track_line([(0, 0), (0, 0)], 2.0)


@given(st.floats(1.0, 500.0), st.floats(0.05, 0.99))
def test_the_spacing_gives_the_probability(width, probability):
    assert probability_of_detection(width, spacing_for(width, probability)) == pytest.approx(probability)


def test_probabilities():
    assert probability_of_detection(100.0, 100.0) == pytest.approx(0.632, abs=0.001)
    assert probability_of_detection(100.0, 100.0, searches=2) == pytest.approx(0.865, abs=0.001)
    with pytest.raises(InvalidArgumentError, match="probability must be more than 0"):
        spacing_for(100.0, 1.0)
    with pytest.raises(InvalidArgumentError, match="spacing must be finite and more than 0"):
        expanding_square(0.0, 3)
