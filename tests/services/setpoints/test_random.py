"""Setpoints over random networks: what arrives was sent, in order, and silence is noticed."""

from __future__ import annotations

from random import Random
from typing import TYPE_CHECKING

from mavstack.services.setpoints import (
    AttitudeSetpoint,
    GlobalSetpoint,
    LocalSetpoint,
    SetpointReceived,
    SetpointReceiver,
    SetpointsTimedOut,
    SetpointStreamer,
)
from tests.services.network import GROUND, VEHICLE, Network, random_impairment, with_cuts

if TYPE_CHECKING:
    from tests.seeds import Seeds


def numbered(number: int):
    """A setpoint that tells its number."""
    return (
        LocalSetpoint(position=(number, 0, -5), yaw=0.5),
        GlobalSetpoint(47.0, 8.0, number, velocity=(1, None, 0)),
        AttitudeSetpoint(rates=(0, 0, number), thrust=0.25),
    )[number % 3]


def number_of(setpoint) -> float:
    match setpoint:
        case LocalSetpoint(position=(x, _, _)):
            return x
        case GlobalSetpoint(altitude=altitude):
            return altitude
    return setpoint.rates[2]


def scenario(seed: int) -> None:
    network, random = Network(seed), Random(seed)
    ground = network.node(GROUND)
    vehicle = network.node(VEHICLE, lambda engine: engine.add(SetpointReceiver(VEHICLE)) and None)
    streamer = ground.engine.add(SetpointStreamer(GROUND, VEHICLE, rate=random.choice([4.0, 20.0, 50.0])))
    impairment = random_impairment(random)
    pipes = network.connect(ground, vehicle, impairment, bandwidth=random.choice([None, 1000.0]))
    with_cuts(network, pipes, within=2.5)
    if random.random() < 0.2:
        network.at(random.uniform(0, 5), vehicle.restart)
    begin = network.now
    for number in range(1, 11):

        def change(number: int = number) -> None:
            streamer.set(numbered(number), network.now)
            ground.engine.touch(streamer)

        network.at(number * 0.5, change)
    network.run(timeout=6.0)
    streamer.stop(network.now)
    ground.engine.touch(streamer)
    expected = (network.now - begin) * streamer.rate
    assert streamer.sent <= expected + 1
    network.run(timeout=6.0)
    received = [event for event in vehicle.events if isinstance(event[1], SetpointReceived)]
    starved = vehicle.events_of(SetpointsTimedOut)
    assert all(event.setpoint == numbered(round(number_of(event.setpoint))) for _, event in received)
    numbers = [number_of(event.setpoint) for _, event in received]
    if impairment.loss < 0.5 and not starved[:-1]:
        # One receiver that never starved heard them in the order in which they were set.
        services = {id(service) for service, _ in received}
        if len(services) == 1:
            assert numbers == sorted(numbers)
    if received:
        last_service = received[-1][0]
        ends = [event for service, event in vehicle.events if service is last_service]
        assert isinstance(ends[-1], SetpointsTimedOut)
    if impairment.loss == 0 and impairment.corrupt == 0 and impairment.bandwidth == 0:
        assert numbers[-1] == 10


def test_setpoints_over_bad_links(seeds: Seeds) -> None:
    seeds.check(scenario)
