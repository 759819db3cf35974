"""Manual control over random networks: received input was sent, and in the end all input is released."""

from __future__ import annotations

from random import Random
from typing import TYPE_CHECKING

from mavstack.services.manual_control import (
    ChannelOverride,
    ManualControlReceiver,
    ManualControlSender,
    ManualInput,
    ManualInputLost,
    ManualInputReceived,
    OverrideLost,
    OverrideReceived,
    OverrideSender,
)
from tests.services.network import GROUND, VEHICLE, Network, random_impairment, with_cuts

if TYPE_CHECKING:
    from tests.seeds import Seeds


def scenario(seed: int) -> None:
    network, random = Network(seed), Random(seed)
    ground, vehicle = network.node(GROUND), network.node(VEHICLE)
    receiver = vehicle.engine.add(ManualControlReceiver(VEHICLE))
    sticks = ground.engine.add(ManualControlSender(GROUND, VEHICLE, rate=random.choice([5.0, 20.0])))
    channels = ground.engine.add(OverrideSender(GROUND, VEHICLE, rate=random.choice([5.0, 20.0])))
    impairment = random_impairment(random)
    with_cuts(network, network.connect(ground, vehicle, impairment))
    inputs = [ManualInput(x=n, y=-n, z=500, buttons=n) for n in range(8)]
    overrides = [{1: 1000 + n, 9 + n % 3: 1500} for n in range(8)]

    def change(number: int) -> None:
        sticks.set(inputs[number], network.now)
        channels.set(ChannelOverride(overrides[number]), network.now)
        ground.engine.touch(sticks)
        ground.engine.touch(channels)

    for number in range(8):
        network.at(number * 0.6, lambda number=number: change(number))
    network.run(timeout=5.0)
    if random.random() < 0.3:
        ground.restart()  # the pilot's program dies without letting go
    else:
        for sender in (sticks, channels):
            sender.stop(network.now)
            ground.engine.touch(sender)
    network.run(timeout=10.0)
    for event in vehicle.events_of(ManualInputReceived):
        assert event.input in inputs or event.input == ManualInput()
    for event in vehicle.events_of(OverrideReceived):
        for channel, pulse in event.channels.items():
            assert any(override.get(channel) == pulse for override in overrides)
    assert receiver.latest(GROUND, network.now) is None
    assert receiver.overridden(GROUND, network.now) is None
    if vehicle.events_of(ManualInputReceived):
        assert isinstance(
            [e for _, e in vehicle.events if isinstance(e, ManualInputReceived | ManualInputLost)][-1],
            ManualInputLost,
        )
    held = [event for _, event in vehicle.events if isinstance(event, OverrideReceived | OverrideLost)]
    assert not held or isinstance(held[-1], OverrideLost) or not held[-1].channels


def test_steering_over_bad_links(seeds: Seeds) -> None:
    seeds.check(scenario)
