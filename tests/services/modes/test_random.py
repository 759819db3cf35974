"""Modes over random networks: entered and reported, or a typed error within the deadline."""

from __future__ import annotations

from random import Random
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.errors import CommandDenied, CommandTimeout, ModeTimeout
from mavstack.services.command import CommandClient, CommandServer
from mavstack.services.heartbeat import HeartbeatSender
from mavstack.services.modes import ListModes, ModeChanged, ModeServer, SetMode, SetStandardMode, modes_of
from tests.services.network import GROUND, VEHICLE, Network, random_impairment, with_cuts

if TYPE_CHECKING:
    from tests.seeds import Seeds

TIMEOUT = 120.0
ALL = modes_of(3, 2, [*range(8), 9, 11, *range(13, 28)], {6: 5, 3: 6, 9: 7})


class Vehicle:
    """Has modes, enters them after a while, and refuses one."""

    def __init__(self, network: Network) -> None:
        self.network = network
        self.node = network.node(VEHICLE, self.setup)
        network.at(0.0, self.work)

    def setup(self, engine) -> None:
        self.modes = engine.add(
            ModeServer(
                VEHICLE, ALL, 0, autopilot=3, may_enter=lambda mode, _: "no" if mode.name == "FLIP" else None
            )
        )
        self.modes.register(engine.add(CommandServer(VEHICLE)))
        self.beacon = engine.add(HeartbeatSender(VEHICLE, 2, 3))
        self.beacon.base_mode = 1

    @property
    def entered(self) -> set[int]:
        return {0, *(event.mode.custom_mode for event in self.node.events_of(ModeChanged))}

    def work(self) -> None:
        self.beacon.custom_mode = self.modes.current.custom_mode
        self.network.at(0.2, self.work)


def scenario(seed: int) -> None:
    network, random = Network(seed), Random(seed)
    vehicle = Vehicle(network)
    ground = network.node(GROUND)
    client = ground.engine.add(CommandClient(GROUND, VEHICLE))
    with_cuts(network, network.connect(ground, vehicle.node, random_impairment(random)))
    if random.random() < 0.2:
        network.at(random.uniform(0, 5), vehicle.node.restart)
    listing = client.begin(ListModes(timeout=TIMEOUT), network.now)
    wanted = random.choice(["GUIDED", "flip", 6])
    setting = client.begin(SetMode(wanted), network.now)
    ground.engine.touch(client)
    assert network.run(lambda: listing.done and setting.done, timeout=TIMEOUT + 1)
    if listing.error is None:
        assert list(listing.result()) == ALL
    else:
        assert isinstance(listing.error, CommandTimeout | ModeTimeout)
    if setting.error is None:
        assert setting.result() in vehicle.entered
        assert wanted != "flip"
    elif isinstance(setting.error, CommandDenied):
        assert wanted == "flip"
        assert setting.error.code == common.MavResult.FAILED
    else:
        assert isinstance(setting.error, CommandTimeout | ModeTimeout)
    standard = client.begin(SetStandardMode(random.choice([5, 7])), network.now)
    ground.engine.touch(client)
    assert network.run(lambda: standard.done, timeout=TIMEOUT)
    if standard.error is None:
        assert standard.result() in (6, 9)
        assert standard.result() in vehicle.entered
    else:
        assert isinstance(standard.error, CommandTimeout | ModeTimeout)


def test_modes_over_bad_links(seeds: Seeds) -> None:
    seeds.check(scenario)
