"""Random messages and actions in any order: the vehicle runs on, its numbers are finite, it answers."""

from __future__ import annotations

from random import Random
from typing import TYPE_CHECKING

import pytest

from mavstack.dialects import common
from mavstack.sim.simulation import Simulation
from mavstack.sim.vehicle_types import DEFAULT_HOME, Home
from tests.sim.robustness.hostile_peers import ALL_VEHICLES
from tests.sim.robustness.random_actions import RandomActor

if TYPE_CHECKING:
    from tests.seeds import Seeds

HOMES = [
    DEFAULT_HOME,
    DEFAULT_HOME,
    DEFAULT_HOME,
    Home(90, 0, 0, 0),
    Home(-90, 9, 8800, 359),
    Home(0, 180, -400, 0),
]


def new_actor(seed: int) -> RandomActor:
    """Return one vehicle of some kind that can be armed."""
    random = Random(seed)
    simulation = Simulation(seed=seed, rate=random.choice([10.0, 10.0, 10.0, 25.0]))
    vehicle = simulation.add(*random.choice(ALL_VEHICLES), home=random.choice(HOMES))
    simulation.advance(simulation.now + 2.1)
    return RandomActor(simulation, vehicle, random)


def step_and_check(target: RandomActor, steps: int) -> None:
    for _ in range(steps):
        target.simulation.step()
    target.check()


def random_actions(target: RandomActor) -> None:
    for _ in range(25):
        target.run_random_action()
        step_and_check(target, target.random.choice([0, 1, 3]))


def random_command(target: RandomActor) -> None:
    """Expect one answer to each command, or an answer in progress and a final one."""
    for _ in range(15):
        if target.random.random() < 0.3:
            target.random.choice([target.change_mode, target.arm_or_place_in_air])()
        step_and_check(target, 1)
        target.drain_received()
        command = target.random_command()
        target.send(command)
        step_and_check(target, 2)
        acks = [ack for ack in target.drain_received() if isinstance(ack, common.CommandAck)]
        results = [ack.result for ack in acks if ack.command == command.command]
        assert results, command
        assert sum(result != common.MavResult.IN_PROGRESS for result in results) <= 1, (command, results)
        step_and_check(target, 15 if target.vehicle.boots > 1 else 0)


def random_parameters(target: RandomActor) -> None:
    target.arm_or_place_in_air()
    for _ in range(10):
        target.set_random_parameters()
        target.random.choice(
            [target.change_mode, target.change_mode, target.place_in_air, target.vehicle.reboot]
        )()
        step_and_check(target, 4)


def random_plans(target: RandomActor) -> None:
    for kind in (1, 2, 0):
        target.upload(kind)
        for name in ("FENCE_ENABLE", "FENCE_TYPE", "GF_ACTION"):
            if name in target.vehicle.parameters:
                target.vehicle.parameters.set(name, target.random.randint(0, 5))
    for _ in range(6):
        count = len(target.vehicle.autopilot.mission.items)
        target.vehicle.autopilot.mission.go_to_item(target.random.randint(0, count))
        step_and_check(target, 4)


SCENARIOS = (random_actions, random_command, random_parameters, random_plans)


def scenario(seed: int) -> None:
    SCENARIOS[seed % len(SCENARIOS)](new_actor(seed))


@pytest.mark.flight_cases(1)
@pytest.mark.fast_cases(1)
def test_invariants_hold_under_random_input(seeds: Seeds) -> None:
    seeds.check(scenario)
