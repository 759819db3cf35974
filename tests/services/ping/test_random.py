"""Pings over random networks: correct statistics, or a typed error in time."""

from __future__ import annotations

from random import Random
from typing import TYPE_CHECKING

from mavstack.errors import RemoteTimeout
from mavstack.services.ping import PingClient, PingServer
from tests.services.network import GROUND, VEHICLE, Network, random_impairment, with_cuts

if TYPE_CHECKING:
    from tests.seeds import Seeds


def scenario(seed: int) -> None:
    network, random = Network(seed), Random(seed)
    ground, vehicle = network.node(GROUND), network.node(VEHICLE, lambda e: e.add(PingServer(VEHICLE)))
    impairment = random_impairment(random)
    with_cuts(network, network.connect(ground, vehicle, impairment))
    if random.random() < 0.2:
        network.at(random.uniform(0, 3), vehicle.restart)
    client = ground.engine.add(PingClient(GROUND, VEHICLE))
    enough = random.choice([None, 1])
    pings = client.ping(network.now, count=6, interval=random.choice([0.01, 0.5]), enough=enough)
    ground.engine.touch(client)
    assert network.run(lambda: pings.done, timeout=10)
    if pings.error is not None:
        assert isinstance(pings.error, RemoteTimeout)
        assert pings.error.attempts == 6
        return
    statistics = pings.result()
    assert 1 <= statistics.received <= statistics.sent <= 6
    assert statistics.minimum >= 2 * (impairment.latency - impairment.jitter) - 1e-6
    if not impairment.loss and not impairment.corrupt and enough is None and network.now < 1:
        assert statistics.received == 6


def test_pings_over_bad_links(seeds: Seeds) -> None:
    seeds.check(scenario)
