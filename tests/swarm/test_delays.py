"""Delays are learned from how far vehicles are behind, and setpoints make up for them."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.swarm.delays import MAX_DELAY, Delays

STEP = 0.1
ONE = np.array([0])


def fly(delay, speed, seconds, expected=0.0):
    """Fly a vehicle that is where its setpoint was some steps ago; return its delays and errors."""
    delays, history, found = Delays(1, expected), [], []
    motion = np.array([[speed, 0.0, 0.0]])
    for index in range(round(seconds / STEP)):
        place = index * STEP * motion
        ahead, _ = delays.lead(ONE, (place, motion, np.zeros((1, 3))))
        history.append(ahead)
        position = history[max(len(history) - 1 - round(delay / STEP), 0)]
        found.append(float(np.linalg.norm(place - position)))
        delays.learn(ONE, place - position, motion, STEP)
    return delays, found


@given(st.sampled_from([0.0, 0.1, 0.2, 0.4]), st.floats(2.0, 12.0), st.floats(0.0, 0.5))
def test_a_delay_is_learned_and_the_vehicle_is_in_its_slot(delay, speed, expected):
    delays, errors = fly(delay, speed, 30.0, expected)
    assert delays.seconds[0] == pytest.approx(delay, abs=0.02)
    assert errors[-1] < 0.02 * speed


def test_without_a_lead_the_vehicle_stays_behind():
    _, errors = fly(0.2, 5.0, 0.5)
    assert errors[-1] > 0.7


def test_a_vehicle_that_cannot_follow_moves_the_setpoint_by_the_limit_only():
    delays = Delays(1, 0.1)
    motion = np.array([[5.0, 0.0, 0.0]])
    for _ in range(100):
        delays.learn(ONE, np.array([[500.0, 0.0, 0.0]]), motion, STEP)
    assert delays.seconds[0] == MAX_DELAY
    for _ in range(100):
        delays.learn(ONE, np.array([[-500.0, 0.0, 0.0]]), motion, STEP)
    assert delays.seconds[0] == 0.0


@pytest.mark.parametrize(
    ("behind", "motion"),
    [
        ((9.0, 0.0, 0.0), (0.5, 0.0, 0.0)),
        ((np.nan, 0.0, 0.0), (5.0, 0.0, 0.0)),
        ((0.0, 9.0, 0.0), (5.0, 0.0, 0.0)),
    ],
    ids=["standing", "unknown position", "beside the course"],
)
def test_nothing_is_learned_of_other_errors(behind, motion):
    delays = Delays(2, 0.2)
    delays.learn(np.array([1]), np.array([behind]), np.array([motion]), STEP)
    assert delays.seconds.tolist() == [0.2, 0.2]


def test_a_lead_follows_a_course_that_accelerates():
    delays, now, acceleration = Delays(1, 0.5), 4.0, np.array([[2.0, 0.0, 0.0]])
    place, motion = 0.5 * now**2 * acceleration, now * acceleration
    places, velocities = delays.lead(ONE, (place, motion, acceleration))
    assert places == pytest.approx(0.5 * 4.5**2 * acceleration)
    assert velocities == pytest.approx(4.5 * acceleration)
    later, place = now + 0.3, 0.5 * (now + 0.3) ** 2 * acceleration
    places, velocities = delays.lead(ONE, (place, later * acceleration, acceleration), after=0.3)
    assert places == pytest.approx(0.5 * 4.5**2 * acceleration)
    assert velocities == pytest.approx(4.5 * acceleration)
