"""Random messages and actions in any order: the vehicle runs on, its numbers are finite, it answers."""

from __future__ import annotations

from random import Random
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.sim.simulation import Simulation
from mavstack.sim.vehicle_types import DEFAULT_HOME, Home
from tests.sim.robustness.hostile_peers import EVERY_KIND
from tests.sim.robustness.random_actions import Abuser

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


def abused(seed: int) -> Abuser:
    """Return one vehicle of some kind that can be armed."""
    random = Random(seed)
    simulation = Simulation(seed=seed, rate=random.choice([10.0, 10.0, 10.0, 25.0]))
    vehicle = simulation.add(*random.choice(EVERY_KIND), home=random.choice(HOMES))
    simulation.advance(simulation.now + 2.1)
    return Abuser(simulation, vehicle, random)


def resume(victim: Abuser, steps: int) -> None:
    for _ in range(steps):
        victim.simulation.step()
    victim.check()


def anything_at_all(victim: Abuser) -> None:
    for _ in range(25):
        victim.do_something()
        resume(victim, victim.random.choice([0, 1, 3]))


def any_command(victim: Abuser) -> None:
    """Expect one answer to each command, or an answer in progress and a final one."""
    for _ in range(15):
        if victim.random.random() < 0.3:
            victim.random.choice([victim.change_mode, victim.arm_somehow])()
        resume(victim, 1)
        victim.take_heard()
        asked = victim.any_command()
        victim.send(asked)
        resume(victim, 2)
        acks = [ack for ack in victim.take_heard() if isinstance(ack, common.CommandAck)]
        results = [ack.result for ack in acks if ack.command == asked.command]
        assert results, asked
        assert sum(result != common.MavResult.IN_PROGRESS for result in results) <= 1, (asked, results)
        resume(victim, 15 if victim.vehicle.boots > 1 else 0)


def any_parameter(victim: Abuser) -> None:
    victim.arm_somehow()
    for _ in range(10):
        victim.set_parameters()
        victim.random.choice(
            [victim.change_mode, victim.change_mode, victim.place_in_air, victim.vehicle.reboot]
        )()
        resume(victim, 4)


def any_plan(victim: Abuser) -> None:
    for kind in (1, 2, 0):
        victim.upload(kind)
        for name in ("FENCE_ENABLE", "FENCE_TYPE", "GF_ACTION"):
            if name in victim.vehicle.parameters:
                victim.vehicle.parameters.set(name, victim.random.randint(0, 5))
    for _ in range(6):
        count = len(victim.vehicle.autopilot.mission.items)
        victim.vehicle.autopilot.mission.go_to_item(victim.random.randint(0, count))
        resume(victim, 4)


SCENARIOS = (anything_at_all, any_command, any_parameter, any_plan)


def scenario(seed: int) -> None:
    SCENARIOS[seed % len(SCENARIOS)](abused(seed))


def test_nothing_throws_a_vehicle_off(seeds: Seeds) -> None:
    seeds.check(scenario)
