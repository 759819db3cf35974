"""Courses: places and velocities that belong together."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.swarm.courses import Following, Standing, Turn
from mavstack.swarm.leader import LeaderFrame
from mavstack.swarm.transitions import Limits

PLACES = np.array([[0.0, 0.0, 10.0], [0.0, 10.0, 12.0], [-10.0, 0.0, 10.0]])


def test_standing_has_no_end_and_no_motion():
    places, motion = Standing(PLACES).state(5.0)
    assert places is PLACES
    assert not motion.any()


@given(st.floats(10.0, 360.0), st.floats(0.5, 10.0), st.floats(0.05, 0.95))
def test_a_turn_keeps_distances_and_speed(angle, speed, share):
    turn = Turn(PLACES, (0.0, 0.0), angle, Limits(speed=speed))
    time = share * turn.duration
    places, motion = turn.state(time)
    assert np.linalg.norm(places[:, :2], axis=1) == pytest.approx([0.0, 10.0, 10.0])
    assert places[:, 2].tolist() == PLACES[:, 2].tolist()
    assert np.linalg.norm(motion, axis=1).max() <= speed * 1.001
    before, after = turn.state(time - 1e-4)[0], turn.state(time + 1e-4)[0]
    assert (after - before) / 2e-4 == pytest.approx(motion, abs=0.1)


def test_a_turn_ends_at_its_angle():
    turn = Turn(PLACES, (0.0, 0.0), 90.0, Limits())
    assert turn.state(turn.duration)[0][1] == pytest.approx([-10.0, 0.0, 12.0])


def test_following_is_the_frame_of_the_leader_and_endless():
    frame = LeaderFrame()
    frame.update(np.array([1.0, 2.0, 3.0]), np.zeros(3), 7.0)
    course = Following(frame, PLACES, begin=7.0)
    assert math.isinf(course.duration)
    assert course.state(0.5)[0][1] == pytest.approx([1.0, 12.0, 15.0])
