"""Random transitions of 100 vehicles with latency, loss, position errors and wind."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest

from mavstack.swarm.separation import Margins
from mavstack.swarm.transitions import Limits, plan_transition
from tests.swarm.flight_model import Conditions, fly

COUNT = 100
MARGINS, LIMITS = Margins(), Limits()
#: Swarms that fly at once; the batch of a seed is always the same, so that each seed replays exactly.
BATCH = 20


def places(random, spacing):
    """Return random places of a lattice that is nearly full or has much room."""
    cells = random.permutation(int(COUNT * random.uniform(1.05, 4.0)))[:COUNT]
    columns = int(np.ceil(np.sqrt(4 * COUNT)))
    north, east = cells // columns, cells % columns
    return np.column_stack((north, east, np.zeros(COUNT))) * spacing + (0.0, 0.0, 20.0)


def plan(seed, distance):
    random, spacing = np.random.default_rng(seed), distance * np.sqrt(2.0) + 1e-3
    return plan_transition(places(random, spacing), places(random, spacing), distance, limits=LIMITS)


def flown(seeds, conditions=None, margins=MARGINS):
    """Return for each seed the smallest separation, and the largest error of a slot."""
    plans = [plan(seed, margins.planned_distance) for seed in seeds]
    return fly(plans, np.random.default_rng([1, seeds[0]]), margins, LIMITS, conditions)


@lru_cache(maxsize=1)
def batch_flown(batch):
    """Fly a batch: of every second one, vehicles add the acceleration of a setpoint to their own."""
    return flown(range(batch * BATCH, (batch + 1) * BATCH), Conditions(feedforward=float(batch % 2)))


def check(seed):
    batch, index = divmod(seed, BATCH)
    smallest, error = batch_flown(batch)
    assert smallest[index] >= MARGINS.minimum
    assert error[index] < 2.0


@pytest.mark.parametrize("feedforward", [0.0, 1.0])
def test_vehicles_never_come_nearer_than_the_minimum(feedforward):
    smallest, error = flown(range(3), Conditions(feedforward=feedforward))
    assert smallest.min() >= MARGINS.minimum
    assert error.max() < 2.0


def test_the_model_finds_margins_that_are_too_small():
    """Plans without margins for errors come nearer than they plan to."""
    careless = replace(MARGINS, position=0.0, tracking=0.0, latency=0.0)
    assert flown(range(1), margins=careless)[0] < careless.minimum
    calm = Conditions(latency=0.0, loss=0.0, noise=0.0, wind=0.0)
    assert flown(range(1), calm, replace(careless, tracking=0.5))[0] >= careless.minimum


def test_swarms_that_fly_at_once_do_not_disturb_each_other():
    calm = Conditions(loss=0.0, noise=0.0, gusts=0.0)
    together = flown(range(3), calm)
    for seed in range(3):
        alone = flown(range(seed, seed + 1), calm)
        assert together[0][seed] == pytest.approx(alone[0][0], abs=0.05)
        assert together[1][seed] == pytest.approx(alone[1][0], abs=0.05)


@pytest.mark.flight
def test_random_transitions(seeds):
    seeds.check(check)
