"""A shell over random networks: no duplicates, no invented data, no reordering."""

from __future__ import annotations

from random import Random
from typing import TYPE_CHECKING

from mavstack.services import Address
from mavstack.services.serial_control import (
    ShellClient,
    ShellInput,
    ShellOpened,
    ShellOutput,
    ShellReleased,
    ShellServer,
)
from tests.services.network import GROUND, VEHICLE, Network, random_impairment, with_cuts

if TYPE_CHECKING:
    from tests.seeds import Seeds

OTHER = Address(250, 190)
LINES = 40


class Echo:
    """A vehicle whose shell answers each line."""

    def __init__(self, network: Network) -> None:
        self.network = network
        self.taken = 0
        self.node = network.node(VEHICLE, self.setup)
        network.at(0.0, self.work)

    def setup(self, engine) -> None:
        self.shell = engine.add(ShellServer(VEHICLE))

    def work(self) -> None:
        fresh, self.taken = self.node.events[self.taken :], len(self.node.events)
        for _, event in fresh:
            if isinstance(event, ShellOpened):
                self.shell.feed(b"nsh> ")
            elif isinstance(event, ShellInput):
                self.shell.feed(b"did " + event.data)
        self.node.engine.touch(self.shell)
        self.network.at(0.05, self.work)


def scenario(seed: int) -> None:
    network, random = Network(seed), Random(seed)
    echo, ground = Echo(network), network.node(GROUND)
    client = ground.engine.add(ShellClient(GROUND, VEHICLE))
    impairment = random_impairment(random)
    cuts = random.random() < 0.5
    pipes = network.connect(ground, echo.node, impairment, bandwidth=random.choice([None, 2000.0]))
    if cuts:
        with_cuts(network, pipes)
    restarts = random.random() < 0.2
    if restarts:
        network.at(random.uniform(0, 5), echo.node.restart)
    client.open(network.now)
    ground.engine.touch(client)

    def write(number: int) -> None:
        client.write_line(f"line {number}", network.now)
        ground.engine.touch(client)

    for number in range(LINES):
        network.at(random.uniform(0, 0.1) + number * 0.12, lambda number=number: write(number))
    network.run(timeout=8.0)
    client.close(network.now)
    ground.engine.touch(client)
    assert network.run(lambda: bool(ground.events_of(ShellReleased)), timeout=60.0)
    network.run(timeout=5.0)

    lines = [b"line %d\n" % number for number in range(LINES)]
    inputs = [event for event in echo.node.events_of(ShellInput) if event.data]
    outputs = ground.events_of(ShellOutput)
    assert all(event.data in lines for event in inputs)
    assert restarts or len({event.data for event in inputs}) == len(inputs)
    in_turn = [lines.index(event.data) for event in inputs if not event.late]
    assert restarts or in_turn == sorted(in_turn)
    received = b"".join(event.data for event in outputs if not event.late)
    clean = not (
        impairment.loss or impairment.corrupt or impairment.reorder or impairment.jitter or cuts or restarts
    )
    if clean and not impairment.bandwidth:
        assert [event.data for event in inputs] == lines
        assert received == b"nsh> " + b"".join(b"did " + line for line in lines)
        assert echo.shell.owner is None
    other = network.node(OTHER)
    network.connect(other, echo.node)
    second_client = other.engine.add(ShellClient(OTHER, VEHICLE))
    network.run(timeout=31.0)  # the first one's closing may have been lost, but it does not stay for ever
    second_client.open(network.now)
    other.engine.touch(second_client)
    assert network.run(lambda: bool(other.events_of(ShellOutput)), timeout=3.0)
    assert echo.shell.owner == OTHER


def test_a_shell_over_bad_links(seeds: Seeds) -> None:
    seeds.check(scenario)
