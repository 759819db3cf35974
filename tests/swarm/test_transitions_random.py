"""Random transitions of 100 vehicles with latency, loss, position errors and wind."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from mavstack.swarm.separation import Margins
from mavstack.swarm.transitions import Limits, plan_transition
from tests.swarm.flight_model import Conditions, fly

COUNT = 100
MARGINS, LIMITS = Margins(), Limits()


def places(random, spacing):
    """Return random places of a lattice that is nearly full or has much room."""
    cells = random.permutation(int(COUNT * random.uniform(1.05, 4.0)))[:COUNT]
    columns = int(np.ceil(np.sqrt(4 * COUNT)))
    north, east = cells // columns, cells % columns
    return np.column_stack((north, east, np.zeros(COUNT))) * spacing + (0.0, 0.0, 20.0)


def flown(seed, conditions=None, margins=MARGINS):
    random = np.random.default_rng(seed)
    distance = margins.planned_distance
    spacing = distance * np.sqrt(2.0) + 1e-3
    plan = plan_transition(places(random, spacing), places(random, spacing), distance, limits=LIMITS)
    return fly(plan, random, margins, LIMITS, conditions)


def check(seed):
    smallest, error = flown(seed, Conditions(feedforward=float(seed % 2)))
    assert smallest >= MARGINS.minimum
    assert error < 2.0


def test_vehicles_never_come_nearer_than_the_minimum():
    for seed in range(3):
        check(seed)


def test_the_model_finds_margins_that_are_too_small():
    """Plans without margins for errors come nearer than they plan to."""
    careless = replace(MARGINS, position=0.0, tracking=0.0, latency=0.0)
    assert flown(0, margins=careless)[0] < careless.minimum
    calm = Conditions(latency=0.0, loss=0.0, noise=0.0, wind=0.0)
    assert flown(0, calm, replace(careless, tracking=0.5))[0] >= careless.minimum


@pytest.mark.flight
def test_random_transitions(seeds):
    seeds.check(check)
