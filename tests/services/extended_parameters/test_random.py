"""Extended parameters over random networks: equal sets, or a typed error in time."""

from __future__ import annotations

from random import Random
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.errors import ParameterDenied, ParameterTimeout
from mavstack.services.extended_parameters import ExtendedSetStarted
from tests.services.extended_parameters.harness import ExtendedParameterHarness
from tests.services.network import random_impairment, with_cuts

if TYPE_CHECKING:
    from mavstack.services.extended_parameters import ExtendedValue
    from tests.seeds import Seeds

DEADLINE = 250.0
KIND = common.MavParamExtType
ACK = common.ParamAck


def any_value(random: Random, kind: int) -> ExtendedValue:
    if kind == KIND.CUSTOM:
        return "abcdefgh " * random.randrange(14)
    return random.randrange(100) / 4 if kind in (KIND.REAL32, KIND.REAL64) else random.randrange(100)


class Camera(ExtendedParameterHarness):
    """A pair whose server has a few parameters that take their time, and keeps its values over restarts."""

    def __init__(self, seed: int, random: Random) -> None:
        self.random = random
        kinds = [random.choice(list(KIND)) for _ in range(random.randrange(1, 20))]
        rows = {f"P{number}": (any_value(random, kind), kind) for number, kind in enumerate(kinds)}
        super().__init__(rows, seed=seed, impairment=random_impairment(random))
        with_cuts(self.network, self.pipes)
        self.finish_long_ones()

    def _setup(self, engine) -> None:
        super()._setup(engine)
        self.server.add("LONG", 0, handler=lambda _: None)
        self.server.add("LOCKED", 0, handler=lambda _: ACK.FAILED)

    def restart(self) -> None:
        self.rows = {name: (self.server[name], kind) for name, (_, kind) in self.rows.items()}
        self.camera.restart()

    def finish_long_ones(self) -> None:
        for event in self.camera.events_of(ExtendedSetStarted):
            self.server.complete(event.request, ACK.ACCEPTED, self.network.now)
        self.touch()
        self.network.at(3.0, self.finish_long_ones)


def scenario(seed: int) -> None:
    random = Random(seed)
    camera = Camera(seed, random)
    network, client = camera.network, camera.client
    original = {name: camera.server[name] for name in camera.rows}
    if random.random() < 0.2:
        network.at(random.uniform(0, 3), camera.restart)
    listing = client.download(network.now)
    names = random.choices(sorted(camera.rows), k=random.randrange(5))
    wanted = [(name, any_value(random, camera.rows[name][1])) for name in names]
    sets = [(name, value, client.set(name, value, network.now)) for name, value in wanted]
    long, locked = client.set("LONG", 5, network.now), client.set("LOCKED", 5, network.now)
    camera.run(listing, *(operation for _, _, operation in sets), long, locked, timeout=DEADLINE)
    possible: dict[str, list[ExtendedValue]] = {}
    for name, value, operation in sets:
        if operation.error is None:
            assert operation.result().value == value
            possible[name] = [value]
        else:
            assert isinstance(operation.error, ParameterTimeout | ParameterDenied)
            possible[name] = [*possible.get(name, [original[name]]), value]
    assert all(camera.server[name] in values for name, values in possible.items())
    assert long.error is None or isinstance(long.error, ParameterTimeout | ParameterDenied)
    assert isinstance(locked.error, ParameterDenied | ParameterTimeout)
    assert camera.server["LOCKED"] == 0
    if listing.error is None:
        assert set(listing.result()) == {*original, "LONG", "LOCKED"}
        for name in set(original) - set(names):
            assert listing.result()[name].value == original[name]
    else:
        assert isinstance(listing.error, ParameterTimeout)


def test_extended_parameters_over_bad_links(seeds: Seeds) -> None:
    seeds.check(scenario)
