"""The frame of a formation: courses, turns and extrapolation."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.errors import InvalidArgumentError
from mavstack.swarm.leader import LeaderFrame, turn_rate_for

BEHIND = np.array([[-10.0, 0.0, 0.0]])


def test_slots_are_behind_the_course_not_the_heading():
    frame = LeaderFrame(course=90.0)
    frame.update(np.array([5.0, 5.0, 30.0]), np.array([0.0, 3.0, 0.0]), 0.0)
    places, velocities = frame.slots(BEHIND, 0.0)
    assert places[0] == pytest.approx([5.0, -5.0, 30.0])
    assert velocities[0] == pytest.approx([0.0, 3.0, 0.0])


def test_a_position_is_carried_on_for_a_second():
    frame = LeaderFrame()
    frame.update(np.zeros(3), np.array([2.0, 0.0, 0.0]), 0.0)
    assert frame.slots(BEHIND, 0.5)[0][0][0] == pytest.approx(-9.0)
    assert frame.slots(BEHIND, 9.0)[0][0][0] == pytest.approx(-8.0)


def test_a_leader_that_stands_keeps_its_course():
    frame = LeaderFrame(course=45.0)
    frame.update(np.zeros(3), np.array([-0.1, 0.1, 0.0]), 0.0)
    for step in range(20):
        frame.slots(BEHIND, step * 0.1)
    assert frame.course == 45.0


@pytest.mark.parametrize(("speed", "turns"), [(0.49, False), (0.51, True)])
def test_a_velocity_gives_a_course_from_half_a_metre_per_second_on(speed, turns):
    frame = LeaderFrame(course=0.0)
    frame.update(np.zeros(3), np.array([0.0, speed, 0.0]), 0.0)
    for step in range(100):
        frame.slots(BEHIND, step * 0.1)
    assert frame.course == pytest.approx(90.0 if turns else 0.0, abs=0.1)


@given(st.floats(1.0, 60.0), st.floats(0.0, 359.0))
def test_the_frame_turns_at_a_limited_rate_and_its_velocity_is_its_motion(rate, course):
    frame = LeaderFrame(course=course, turn_rate=rate)
    velocity = np.array([0.0, 4.0, 0.0])
    frame.slots(BEHIND, 0.0)
    before = None
    for step in range(1, 60):
        now = 0.05 * step
        frame.update(velocity * now, velocity, now)
        place, motion = frame.slots(BEHIND, now)
        if before is not None:
            assert np.linalg.norm(motion[0] - velocity) <= 10.0 * math.radians(rate) + 1e-9
            moved = (place[0] - before) / 0.05
            assert np.linalg.norm(moved - motion[0]) < 0.5 + math.radians(rate)
        before = place[0]


def test_the_turning_rate_leaves_the_outermost_slot_its_speed():
    offsets = np.array([[0.0, 0.0, 0.0], [-3.0, 4.0, 0.0]])
    assert math.radians(turn_rate_for(offsets, 3.0, 5.0)) * 5.0 == pytest.approx(2.0)
    assert turn_rate_for(offsets[:1], 3.0, 5.0) == 360.0
    with pytest.raises(InvalidArgumentError, match="max_speed must be more than the leader's 5 m/s"):
        turn_rate_for(offsets, 5.0, 5.0)
    with pytest.raises(InvalidArgumentError, match="turn_rate must be more than 0"):
        LeaderFrame(turn_rate=0.0)
