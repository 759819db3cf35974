"""Transitions: no two vehicles come nearer than planned, by any of the three ways."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.errors import InvalidArgumentError
from mavstack.swarm.formations import Formation
from mavstack.swarm.separation import Margins, closest_approaches, nearest_pair
from mavstack.swarm.transitions import Limits, plan_transition, straight_transition


def sampled_separation(plan, rate=25):
    times = np.arange(0.0, plan.duration + 1.0 / rate, 1.0 / rate)
    return min(nearest_pair(plan.state(time)[0])[0] for time in times)


def scattered(random, count, spacing):
    """Return random places on a lattice with more room than the spacing."""
    cells = random.permutation(4 * count)[:count]
    columns = int(np.ceil(np.sqrt(4 * count)))
    places = np.column_stack((cells // columns, cells % columns, np.zeros(count))) * spacing
    return places + random.uniform(0.0, 0.01, places.shape) * (1, 1, 0)


@given(st.integers(0, 10**6), st.integers(2, 25))
def test_straight_lines_of_the_best_assignment_keep_the_distance(seed, count):
    random = np.random.default_rng(seed)
    distance = 6.0
    spacing = distance * np.sqrt(2.0) + 0.01
    starts, goals = scattered(random, count, spacing), scattered(random, count, spacing)
    plan = plan_transition(starts, goals, distance)
    assert plan.method == "straight"
    assert sampled_separation(plan, 5) >= distance - 1e-6
    assert plan.state(plan.duration)[0] == pytest.approx(goals[plan.slots])


@given(st.integers(0, 10**6), st.integers(2, 7))
def test_given_slots_keep_the_distance_too(seed, count):
    random = np.random.default_rng(seed)
    starts, goals = scattered(random, count, 9.0), scattered(random, count, 9.0)
    plan = plan_transition(starts, goals, 6.0, slots=random.permutation(count))
    assert sampled_separation(plan, 5) >= 6.0 - 1e-6


def test_two_vehicles_exchange_places_in_layers():
    places = np.array([[0.0, 0.0, 10.0], [20.0, 0.0, 10.0]])
    plan = plan_transition(places, places, 5.0, slots=[1, 0])
    assert plan.method == "layers"
    assert sampled_separation(plan) >= 5.0 - 1e-6
    assert max(plan.state(time)[0][:, 2].max() for time in np.arange(0, plan.duration, 0.5)) >= 20.0


def test_vehicles_above_each_other_keep_their_order():
    starts = np.array([[0.0, 0.1 * index, 10.0 + 12.0 * index] for index in range(4)])
    plan = plan_transition(starts, Formation("wedge", spacing=10.0).offsets(4) + np.array((0, 0, 10.0)), 5.0)
    assert sampled_separation(plan) >= 5.0 - 1e-6


def test_vehicles_that_are_near_at_the_start_do_not_come_nearer():
    starts = np.array([[0.0, 0.0, 0.0], [3.0, 0.0, 0.0]])
    goals = np.array([[0.0, 10.0, 0.0], [20.0, 10.0, 0.0]])
    with pytest.raises(
        InvalidArgumentError, match=r"starts must be at least 6\.0 m apart .* 0 and 1 are 3\.0 m"
    ):
        plan_transition(starts, goals, 6.0)
    plan = plan_transition(starts, goals, 6.0, closest_start=2.0)
    assert sampled_separation(plan) >= 3.0 - 1e-6


def test_goals_that_are_too_near_are_refused():
    starts = np.array([[0.0, 0.0, 0.0], [30.0, 0.0, 0.0]])
    with pytest.raises(InvalidArgumentError, match=r"goals must be at least 6\.0 m apart"):
        plan_transition(starts, starts * 0.1, 6.0)
    with pytest.raises(InvalidArgumentError, match="starts must be finite"):
        plan_transition(starts * np.nan, starts, 6.0)


@given(st.floats(0.5, 10), st.floats(0.5, 5), st.floats(0.5, 5), st.floats(1, 200), st.floats(-50, 50))
def test_limits_are_kept(speed, climb, acceleration, north, up):
    limits = Limits(speed=speed, climb=climb, acceleration=acceleration)
    plan = straight_transition(np.zeros((1, 3)), np.array([[north, 0.0, up]]), limits)
    times = np.linspace(0.0, plan.duration, 400)
    velocities = np.array([plan.state(time)[1][0] for time in times])
    assert np.abs(velocities[:, 0]).max() <= speed * 1.001
    assert np.abs(velocities[:, 2]).max() <= climb * 1.001
    accelerations = np.diff(velocities, axis=0) / np.diff(times)[:, None]
    assert np.linalg.norm(accelerations, axis=1).max() <= acceleration * 1.01


def test_closest_approaches_are_those_of_sampled_lines():
    random = np.random.default_rng(4)
    starts, ends = random.uniform(0, 50, (2, 6, 3))
    sampled = min(nearest_pair(starts + share * (ends - starts))[0] for share in np.linspace(0, 1, 2001))
    assert closest_approaches(starts, ends).min() == pytest.approx(sampled, abs=0.05)


def test_the_planned_distance_contains_all_errors():
    assert Margins(minimum=2, position=0, tracking=0, latency=0).planned_distance == 2.0
    assert Margins(
        minimum=2, position=0.5, tracking=0.5, latency=0.2, speed=5
    ).planned_distance == pytest.approx(6.83, abs=0.01)
    with pytest.raises(InvalidArgumentError, match="latency must be finite"):
        Margins(latency=float("inf"))
