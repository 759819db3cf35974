"""Texts over random networks: complete and once, or marked as incomplete."""

from __future__ import annotations

from random import Random
from typing import TYPE_CHECKING

from mavstack.services.statustext import GAP, StatusText, StatustextReceiver, StatustextSender
from tests.services.network import GROUND, VEHICLE, Network, random_impairment, with_cuts

if TYPE_CHECKING:
    from tests.seeds import Seeds


def scenario(seed: int) -> None:
    network, random = Network(seed), Random(seed)
    letters = "abcdefghijklmnopqrstuvwxyzäöü€𝛑"
    senders: list[StatustextSender] = []
    texts = [
        f"<{number}> " + "".join(random.choices(letters, k=random.choice([5, 50, 46, random.randrange(300)])))
        for number in range(20)
    ]
    vehicle = network.node(VEHICLE, lambda engine: senders.append(engine.add(StatustextSender(VEHICLE))))
    ground = network.node(GROUND)
    ground.engine.add(StatustextReceiver(GROUND))
    impairment = random_impairment(random)
    pipes = network.connect(ground, vehicle, impairment)
    with_cuts(network, pipes)

    starting_until = [0.0]

    def restart() -> None:
        starting_until[0] = network.now + 3.0  # no sender starts faster
        vehicle.restart()

    def send(text: str) -> None:
        if not network.now < starting_until[0]:
            senders[-1].send_text(text)
            vehicle.engine.touch(senders[-1])

    for number, text in enumerate(texts):
        network.at(0.4 * number, lambda text=text: send(text))
    if random.random() < 0.3:
        network.at(random.uniform(0, 8), restart)
    network.run(timeout=60)
    received: list[StatusText] = ground.events_of(StatusText)
    whole = [event.text for event in received if event.complete]
    assert len(set(whole)) == len(whole)
    assert set(whole) <= set(texts)
    for event in received:
        assert event.complete != (GAP in event.text)
        if not event.complete:
            parts = [part.strip("\N{REPLACEMENT CHARACTER}") for part in event.text.split(GAP)]
            assert any(all(part in text for part in parts) for text in texts)


def test_texts_over_bad_links(seeds: Seeds) -> None:
    seeds.check(scenario)
