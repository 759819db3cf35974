"""Steering without a leader: offsets converge although each member receives two neighbours only."""

from __future__ import annotations

import numpy as np

from mavstack.swarm.consensus import Neighbour, steer
from mavstack.swarm.formations import Formation


def test_a_ring_of_members_converges_to_the_formation_and_moves_on():
    random = np.random.default_rng(2)
    slots = Formation("wedge", spacing=10.0).offsets(7)
    positions, velocities = random.uniform(-40, 40, (7, 3)), np.zeros((7, 3))
    mission = np.array([2.0, 0.0, 0.0])
    for _ in range(900):
        members = [Neighbour(*each) for each in zip(positions, velocities, slots, strict=True)]
        velocities = np.array(
            [
                steer(members[index], [members[index - 1], members[(index + 1) % 7]], mission)
                for index in range(7)
            ]
        )
        positions = positions + 0.1 * velocities
    errors = positions - slots
    assert np.ptp(errors, axis=0).max() < 0.05
    assert velocities[:, 0].min() > 1.9


def test_speed_is_limited_and_a_lonely_member_flies_its_mission():
    own = Neighbour(np.zeros(3), np.zeros(3), np.zeros(3))
    far = Neighbour(np.array([1000.0, 0.0, 0.0]), np.zeros(3), np.zeros(3))
    assert np.linalg.norm(steer(own, [far], np.zeros(3), speed=4.0)) <= 4.0 + 1e-9
    assert steer(own, [], np.array([1.0, 2.0, 0.0])).tolist() == [1.0, 2.0, 0.0]
