"""Avoidance: distances are kept, and velocities are those of pyrvo in the plane."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.errors import InvalidArgumentError
from mavstack.swarm import avoidance as module
from mavstack.swarm.avoidance import Avoidance
from mavstack.swarm.separation import nearest_pair


def exchange(count, radius, **options):
    """Return the smallest distance of vehicles that exchange places over a circle, and the way left."""
    avoidance = Avoidance(**options)
    angle = np.arange(count) * 2.0 * np.pi / count
    positions = np.column_stack((radius * np.cos(angle), radius * np.sin(angle), np.zeros(count)))
    goals, velocities, nearest = -positions, np.zeros((count, 3)), np.inf
    for _ in range(600):
        way = goals - positions
        length = np.maximum(np.linalg.norm(way, axis=1), 1e-9)[:, None]
        velocities = avoidance.velocities(positions, velocities, way * np.minimum(1.0, 4.0 / length))
        positions = positions + 0.1 * velocities
        nearest = min(nearest, nearest_pair(positions)[0])
        if np.abs(goals - positions).max() < 0.3:
            break
    return nearest, np.abs(goals - positions).max()


@pytest.mark.parametrize(("count", "radius"), [(2, 10.0), (8, 12.0), (20, 20.0)])
def test_vehicles_on_a_circle_exchange_places(count, radius):
    nearest, left = exchange(count, radius, distance=2.0)
    assert nearest > 1.9
    assert left < 0.3


def test_a_larger_distance_is_kept():
    nearest, _ = exchange(6, 30.0, distance=6.0)
    assert nearest > 5.7


def test_velocities_are_those_of_pyrvo_in_the_plane(monkeypatch):
    pyrvo = pytest.importorskip("pyrvo")
    monkeypatch.setattr(module, "_without_symmetry", lambda velocities: velocities)
    random = np.random.default_rng(8)
    compared = 0
    for _ in range(40):
        positions = np.column_stack((random.uniform(-8, 8, (6, 2)), np.zeros(6)))
        velocities = np.column_stack((random.uniform(-1.5, 1.5, (6, 2)), np.zeros(6)))
        preferred = np.column_stack((random.uniform(-2, 2, (6, 2)), np.zeros(6)))
        if nearest_pair(positions)[0] < 2.5:
            continue
        simulator = pyrvo.RVOSimulator()
        simulator.set_time_step(0.1)
        simulator.set_agent_defaults(100.0, 10, 4.0, 4.0, 1.0, 3.0)
        for index in range(6):
            simulator.add_agent(positions[index, :2].tolist())
            simulator.set_agent_velocity(index, velocities[index, :2].tolist())
            simulator.set_agent_pref_velocity(index, preferred[index, :2].tolist())
        simulator.do_step()
        theirs = [simulator.get_agent_velocity(index) for index in range(6)]
        avoidance = Avoidance(distance=2.0, horizon=4.0, speed=3.0, acceleration=1e6, neighbours=10)
        ours = avoidance.velocities(positions, velocities, preferred)
        for index in range(6):
            assert ours[index, :2] == pytest.approx([theirs[index].x, theirs[index].y], abs=1e-3)
            compared += 1
    assert compared > 60


@given(st.integers(0, 10**6), st.integers(0, 12))
def test_limits_are_kept(seed, count):
    random = np.random.default_rng(seed)
    positions, velocities, preferred = random.normal(0.0, 5.0, (3, count, 3))
    velocities = np.clip(velocities, -2.0, 2.0)
    avoidance = Avoidance(distance=3.0, acceleration=2.0, step=0.1)
    chosen = avoidance.velocities(positions, velocities, preferred)
    assert chosen.shape == (count, 3)
    change = (chosen - velocities) / (1.0, 1.0, 2.0)
    assert (np.linalg.norm(change, axis=1) <= 0.2 + 1e-9).all()


def test_wrong_arguments_are_refused():
    with pytest.raises(InvalidArgumentError, match="horizon must be finite and more than 0"):
        Avoidance(horizon=0.0)
    with pytest.raises(InvalidArgumentError, match="must be finite"):
        Avoidance().velocities(np.full((1, 3), np.nan), np.zeros((1, 3)), np.zeros((1, 3)))
    with pytest.raises(InvalidArgumentError, match="must have one shape"):
        Avoidance().velocities(np.zeros((2, 3)), np.zeros((1, 3)), np.zeros((2, 3)))
