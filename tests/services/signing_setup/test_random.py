"""Changing keys over random networks: in the end both ends communicate."""

from __future__ import annotations

from random import Random
from typing import TYPE_CHECKING

from mavstack.errors import RemoteDenied, RemoteTimeout
from mavstack.links import Impairment
from mavstack.security import SigningKey
from tests.services.network import random_impairment, with_cuts
from tests.services.signing_setup.harness import SigningHarness

if TYPE_CHECKING:
    from tests.seeds import Seeds

KEYS = [None, SigningKey.from_passphrase("one"), SigningKey.from_passphrase("two")]


def scenario(seed: int) -> None:
    random = Random(seed)
    old, new = random.choice(KEYS), random.choice(KEYS)
    refuses = random.random() < 0.15
    harness = SigningHarness(
        seed,
        key=old,
        impairment=random_impairment(random),
        policy=(lambda request: "no") if refuses else None,
        answers=random.random() < 0.8,
    )
    network = harness.network
    with_cuts(network, harness.pipes)
    for pipe in harness.pipes:  # one direction may be gone for long, at the worst moment
        if random.random() < 0.2:
            begin, end = random.uniform(0, 12), random.uniform(0, 20)
            network.at(begin, lambda pipe=pipe: setattr(pipe, "cut", True))
            network.at(begin + end, lambda pipe=pipe: setattr(pipe, "cut", False))
    if random.random() < 0.2:
        network.at(random.uniform(0, 12), harness.restart_vehicle)
    operation = harness.install(new)
    assert network.run(lambda: operation.done, timeout=41.0)
    if operation.error is None:
        assert harness.server.key == new
        assert not harness.server.on_trial
    else:
        assert isinstance(operation.error, RemoteDenied | RemoteTimeout)
    calm = Impairment()
    for pipe in harness.pipes:
        pipe.cut = False
        pipe.flow._model = calm
    network.run(timeout=40.0)
    assert not harness.client.changing
    assert not harness.server.on_trial
    assert harness.server.key in (old, new)
    assert not refuses or harness.server.key == old
    harness.assert_heartbeats_arrive()


def test_keys_over_bad_links(seeds: Seeds) -> None:
    seeds.check(scenario)
