"""Events over random networks, with numbers that wrap: each is given once, in order, or counted as lost."""

from __future__ import annotations

from random import Random
from typing import TYPE_CHECKING

from mavstack.services.events import EventReceived, EventReceiver, EventSender, EventsLost
from tests.services.network import GROUND, START, VEHICLE, Network, random_impairment

if TYPE_CHECKING:
    from tests.seeds import Seeds

_COUNT = 30


def scenario(seed: int) -> None:
    network, random = Network(seed), Random(seed)
    ground, vehicle = network.node(GROUND), network.node(VEHICLE)
    sender = vehicle.engine.add(EventSender(VEHICLE, START))
    ground.engine.add(EventReceiver(GROUND, VEHICLE))
    impairment = random_impairment(random)
    network.connect(ground, vehicle, impairment)
    sender.latest = random.choice([sender.latest, 65535 - random.randrange(_COUNT), random.randrange(65536)])

    def report(number: int) -> None:
        sender.report(number, network.now)
        vehicle.engine.touch(sender)

    times = sorted(random.uniform(8, 40) for _ in range(_COUNT))
    for number, time in enumerate(times):
        network.at(time, lambda number=number: report(number))
    network.run(timeout=150)
    given = [event.id for event in ground.events_of(EventReceived)]
    lost = sum(event.count for event in ground.events_of(EventsLost))
    assert given == sorted(set(given))
    assert len(given) + lost == (_COUNT - given[0] if given else lost)
    if not impairment.corrupt and impairment.loss <= 0.1:
        assert lost == 0
        assert given


def test_events_over_bad_links(seeds: Seeds) -> None:
    seeds.check(scenario)
