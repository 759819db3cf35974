"""Setpoints follow the course, and leave it to avoid others."""

from __future__ import annotations

import numpy as np

from mavstack.swarm.avoidance import Avoidance
from mavstack.swarm.steering import steer_members

AVOIDANCE = Avoidance(distance=4.0)
APART = np.array([[0.0, 0.0, 10.0], [30.0, 0.0, 10.0]])
STILL = np.zeros((2, 3))


def test_undisturbed_members_get_the_course_itself():
    motion = np.array([[1.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    steering = steer_members(APART, motion, (APART + 0.3, motion), AVOIDANCE)
    assert not steering.deviates.any()
    assert (steering.places == APART + 0.3).all()
    assert (steering.velocities == motion).all()


def test_members_on_a_collision_course_turn_away():
    positions = APART * (0.3, 1.0, 1.0)
    towards = np.array([[2.0, 0.0, 0.0], [-2.0, 0.0, 0.0]])
    steering = steer_members(positions, towards, (positions[::-1], towards), AVOIDANCE)
    assert steering.deviates.all()
    alone = AVOIDANCE.undisturbed(towards + 0.8 * (positions[::-1] - positions))
    assert (np.linalg.norm(steering.velocities - alone, axis=1) > 0.3).all()
    assert np.isnan(steering.places).all()


def test_members_avoid_vehicles_that_are_not_members():
    alone, motion = APART[:1], np.array([[2.0, 0.0, 0.0]])
    others = APART[1:] * (0.3, 1.0, 1.0), -motion
    steering = steer_members(alone, motion, (alone, motion), AVOIDANCE, others)
    assert steering.deviates.tolist() == [True]
