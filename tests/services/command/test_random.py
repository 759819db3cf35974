"""Commands over random networks: the answer, or a typed error within the deadline."""

from __future__ import annotations

from random import Random
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.errors import CommandDenied, CommandTimeout
from mavstack.services.command import Command, CommandClient, CommandServer, CommandStarted
from tests.services.network import GROUND, VEHICLE, Network, random_impairment, with_cuts

if TYPE_CHECKING:
    from mavstack.services.command import CommandRequest
    from tests.seeds import Seeds

DEADLINE = 90.0
QUICK, DENIED, LONG = common.MavCmd.DO_SET_SERVO, common.MavCmd.DO_SET_RELAY, common.MavCmd.NAV_TAKEOFF


class Vehicle:
    """A vehicle that records the commands that it executed, and completes long ones later."""

    def __init__(self, network: Network) -> None:
        self.network = network
        self.done: list[tuple[int, float]] = []
        self.node = network.node(VEHICLE, self.setup)

    def setup(self, engine) -> None:
        self.server = server = engine.add(CommandServer(VEHICLE))
        server.support(QUICK, self.quick)
        server.support(DENIED, lambda _: (common.MavResult.DENIED, 7))
        server.support(LONG, lambda _: None)

    def quick(self, request: CommandRequest) -> common.MavResult:
        self.done.append((request.command.command, request.command.param1))
        return common.MavResult.ACCEPTED

    def complete_long_commands(self) -> None:
        for event in self.node.events_of(CommandStarted):
            self.server.complete(event.request, common.MavResult.ACCEPTED)
            self.node.engine.touch(self.server)
        self.network.at(0.5, self.complete_long_commands)


def scenario(seed: int) -> None:
    network = Network(seed)
    random = Random(seed)
    vehicle = Vehicle(network)
    ground = network.node(GROUND)
    client = ground.engine.add(CommandClient(GROUND, VEHICLE))
    with_cuts(network, network.connect(ground, vehicle.node, random_impairment(random)))
    vehicle.complete_long_commands()
    if random.random() < 0.2:
        network.at(random.uniform(0, 3), vehicle.node.restart)
    quick = client.command(Command(QUICK, param1=seed), network.now)
    denied = client.command(Command(DENIED), network.now)
    long = client.command(Command(LONG, frame=random.choice([None, 6])), network.now)
    ground.engine.touch(client)
    operations = [quick, denied, long]
    assert network.run(lambda: all(operation.done for operation in operations), timeout=DEADLINE)
    if quick.error is None:
        assert (QUICK, float(seed)) in vehicle.done
    else:
        assert isinstance(quick.error, CommandTimeout)
    assert isinstance(denied.error, CommandDenied | CommandTimeout)
    if isinstance(denied.error, CommandDenied):
        assert (denied.error.code, denied.error.detail) == (common.MavResult.DENIED, 7)
    assert long.error is None or isinstance(long.error, CommandTimeout)


def test_commands_over_bad_links(seeds: Seeds) -> None:
    seeds.check(scenario)
