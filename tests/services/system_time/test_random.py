"""Over random networks every reboot is detected, and nothing else."""

from __future__ import annotations

from random import Random
from typing import TYPE_CHECKING

from mavstack.services.system_time import Rebooted, SystemTimeBroadcaster, SystemTimeObserver
from tests.services.network import GROUND, VEHICLE, Network, random_impairment, with_cuts

if TYPE_CHECKING:
    from tests.seeds import Seeds


def scenario(seed: int) -> None:
    network, random = Network(seed), Random(seed)

    def setup(engine) -> None:
        engine.add(SystemTimeBroadcaster(VEHICLE, network.now, rate=5))

    vehicle, ground = network.node(VEHICLE, setup), network.node(GROUND)
    ground.engine.add(SystemTimeObserver(GROUND))
    with_cuts(network, network.connect(ground, vehicle, random_impairment(random)))
    restarts = random.randrange(3)
    for number in range(restarts):
        network.at(20 + 30 * number, vehicle.restart)
    network.run(timeout=100)
    assert len(ground.events_of(Rebooted)) == restarts


def test_restarts_over_bad_links(seeds: Seeds) -> None:
    seeds.check(scenario)
