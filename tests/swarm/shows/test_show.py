"""Trajectories over time."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.errors import InvalidArgumentError
from mavstack.swarm.shows.reading import parse_show
from mavstack.swarm.shows.show import Curve, Show, ShowCourse, Trajectory, placed
from tests.swarm.shows.samples import skyc

coordinates = st.tuples(*[st.floats(-100.0, 100.0)] * 3)


@given(st.lists(coordinates, min_size=2, max_size=8), st.floats(0.1, 20.0), st.floats(0.01, 0.99))
def test_positions_are_those_of_bezier_curves(points, duration, share):
    row = np.array(points)
    while len(row) > 1:
        row = row[:-1] * (1.0 - share) + row[1:] * share
    trajectory = Trajectory([Curve(1.0, duration, points)])
    times = np.array([0.0, 1.0 + share * duration, 2.0 + duration])
    assert trajectory.positions(times) == pytest.approx(np.array([points[0], row[0], points[-1]]), abs=1e-6)
    step = 1e-5 * duration
    before, after = trajectory.positions(times[1] + np.array([-step, step]))
    speed = trajectory.velocities(times)
    assert speed[1] == pytest.approx((after - before) / (2 * step), abs=0.05, rel=1e-3)
    assert not speed[0].any()
    assert not speed[2].any()


def test_the_y_axis_of_a_show_is_on_the_left():
    ahead_left = np.array([[1.0, 0.0, 5.0], [0.0, 1.0, 5.0]])
    assert placed(ahead_left, 0.0) == pytest.approx(np.array([[1.0, 0.0, 5.0], [0.0, -1.0, 5.0]]))
    assert placed(ahead_left, 90.0) == pytest.approx(np.array([[0.0, 1.0, 5.0], [1.0, 0.0, 5.0]]))


def test_a_course_is_the_part_in_the_air():
    show = parse_show(skyc(4))
    first, last = show.airborne(2.0)
    assert (first, last) == pytest.approx((2.9, 57.1), abs=0.15)
    course = ShowCourse(show, first, last, (100.0, 0.0, 0.0), 0.0, (3, 2, 1, 0))
    places, motion = course.state(0.0)
    assert places[0] == pytest.approx((100.0, 15.0, 2.0), abs=0.2)
    assert motion[:, 2] == pytest.approx([1.23] * 4, abs=0.05)
    assert not course.state(course.duration + 1.0)[1].any()
    with pytest.raises(InvalidArgumentError, match="never 50 m high"):
        show.airborne(50.0)


@pytest.mark.parametrize(
    "make",
    [
        lambda: Show("empty", ()),
        lambda: Trajectory([]),
        lambda: Trajectory([Curve(0.0, 0.0, [(0, 0, 0), (0, 0, 1)])]),
        lambda: Trajectory([Curve(0.0, 1.0, [(0, 0, 0)])]),
        lambda: Trajectory(
            [Curve(0.0, 1.0, [(0, 0, 0), (0, 0, 1)]), Curve(2.0, 1.0, [(0, 0, 1), (0, 0, 0)])]
        ),
        lambda: Trajectory([Curve(-1.0, 1.0, [(0, 0, 0), (0, 0, 1)])]),
    ],
)
def test_impossible_shows_are_refused(make):
    with pytest.raises(InvalidArgumentError):
        make()
