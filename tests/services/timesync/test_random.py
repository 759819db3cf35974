"""The offset over random networks is never further off than half the best round trip."""

from __future__ import annotations

from random import Random
from typing import TYPE_CHECKING

from mavstack.services.timesync import TimesyncClient, TimesyncServer
from tests.services.network import GROUND, VEHICLE, Network, random_impairment, with_cuts

if TYPE_CHECKING:
    from tests.seeds import Seeds


def scenario(seed: int) -> None:
    network, random = Network(seed), Random(seed)
    ahead = random.choice([0.0, -1.7e9, random.uniform(-1e6, 1e6)])

    def clock(now: float) -> int:
        return round((now + ahead) * 1e9)

    vehicle = network.node(VEHICLE, lambda engine: engine.add(TimesyncServer(VEHICLE, clock)))
    ground = network.node(GROUND)
    with_cuts(network, network.connect(ground, vehicle, random_impairment(random)))
    client = ground.engine.add(TimesyncClient(GROUND, VEHICLE, interval=1.0))
    if random.random() < 0.2:
        network.at(random.uniform(0, 3), vehicle.restart)
    network.run(timeout=30)
    assert client.estimate is not None
    assert abs(client.estimate.offset - ahead) <= client.estimate.uncertainty * 1.3 + 1e-3


def test_offsets_over_bad_links(seeds: Seeds) -> None:
    seeds.check(scenario)
