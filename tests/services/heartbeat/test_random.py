"""Who sends with an address: two vehicles are always found, one vehicle over several links is never two.

Everything is in virtual time, with clocks, delays, loss and starts drawn from the seed.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from random import Random

import pytest

from mavstack.dialects import common
from mavstack.links import Impairment
from mavstack.services import Address, Outgoing, Service, message_ids
from mavstack.services.heartbeat import (
    AddressConflict,
    AddressConflictEnded,
    ComponentRebooted,
    Discovery,
    HeartbeatSender,
)
from mavstack.services.version import AutopilotVersion
from tests.services.network import GROUND, START, VEHICLE, Network

HOME = (47.3977, 8.5456)
DEGREE = 111_320.0
COMMANDS = common.MavCmd


@dataclass(frozen=True)
class Craft:
    """A vehicle: its boot before the start in seconds, its id, its place in metres, and its course."""

    booted: float = 30.0
    uid: int = 0
    north: float = 0.0
    yaw: float = 0.0
    speed: float = 0.0
    telemetry: float = 4.0  # hertz
    answers_time: bool = True


class Autopilot(Service):
    """An autopilot that answers on the channel of the question, as real ones do."""

    handles = message_ids(common.CommandLong, common.Timesync)

    def __init__(self, craft: Craft, arrival_channel, stamp_delay: float = 0.0) -> None:
        super().__init__(VEHICLE)
        self.craft, self._arrival_channel = craft, arrival_channel
        self._due, self._tick = START, 0
        self._stamp_delay = stamp_delay

    def next_timeout(self):
        return self._due

    def handle_timeout(self, now):
        if now < self._due:
            return
        self._due, self._tick = now + 1 / self.craft.telemetry, self._tick + 1
        craft, boot = self.craft, round((now - START + self.craft.booted - self._stamp_delay) * 1000)
        self.send(common.Attitude(time_boot_ms=boot, yaw=craft.yaw, roll=0.01))
        north = craft.north + craft.speed * (now - START)
        position = common.GlobalPositionInt(
            time_boot_ms=boot,
            lat=round((HOME[0] + north / DEGREE) * 1e7),
            lon=round(HOME[1] * 1e7),
            vx=round(craft.speed * 100),
        )
        if self._tick % 2:
            self.send(position)

    def receive(self, packet, now):
        channel = self._arrival_channel()
        asked = COMMANDS.REQUEST_AUTOPILOT_CAPABILITIES, COMMANDS.REQUEST_MESSAGE
        match packet.message:
            case common.CommandLong(command=command) if command in asked:
                answer = AutopilotVersion(uid=self.craft.uid).to_message()
                self._outbox.append(Outgoing(answer, GROUND, channel=channel))
            case common.Timesync(tc1=0, ts1=stamp) if self.craft.answers_time:
                clock = round((now - START + self.craft.booted) * 1e9)
                answer = common.Timesync(tc1=clock, ts1=stamp, target_system=GROUND.system)
                self._outbox.append(Outgoing(answer, GROUND, channel=channel))


def autopilot_node(network: Network, craft: Craft):
    def setup(engine):
        engine.add(HeartbeatSender(VEHICLE, common.MavType.QUADROTOR, common.MavAutopilot.ARDUPILOTMEGA))
        engine.add(Autopilot(craft, engine.arrival_channel))

    return network.node(VEHICLE, setup)


def ground_node(network: Network):
    def setup(engine):
        engine.add(HeartbeatSender(GROUND))
        discovery = Discovery(GROUND, channel_name=engine.arrival_channel, asks=True)
        engine.add(discovery)

    return network.node(GROUND, setup)


def conflicts(ground) -> list[AddressConflict]:
    return ground.events_of(AddressConflict)


def detection(ground, network, limit: float) -> float | None:
    """Return the seconds until the conflict is reported; None: never."""
    begin = network.now
    return network.now - begin if network.run(lambda: bool(conflicts(ground)), timeout=limit) else None


def two_vehicles(seed: int) -> tuple[Craft, Craft, Impairment]:
    """Draw two vehicles that differ in something, and the impairments of their links."""
    random = Random(seed)
    one = Craft(
        booted=random.uniform(250, 750),
        uid=random.choice([0, random.getrandbits(64)]),
        yaw=random.uniform(-3, 3),
        speed=random.choice([0.0, 0.0, 15.0]),
        telemetry=random.choice([2.0, 4.0]),
    )
    differences = [
        {"uid": random.getrandbits(64), "booted": one.booted + random.choice([0.0, 0.02])},
        {
            "north": random.choice([-1, 1]) * random.uniform(60, 500),
            "booted": one.booted + random.uniform(-3, 3),
        },
        {"booted": one.booted + random.choice([-1, 1]) * random.uniform(2.5, 200)},
        {"yaw": one.yaw + 2.0},
    ]
    which = random.choice(differences)
    if "uid" in which and not one.uid:
        one = replace(one, uid=5)
    if "uid" not in which and one.uid:
        which["uid"] = 0  # the second one reports none
    impairment = Impairment(latency=random.choice([0.0, 0.02, 0.1]), loss=random.choice([0.0, 0.0, 0.05]))
    return one, replace(one, **{"telemetry": 4.0, **which}), impairment


def find_two_vehicles(seed: int) -> float:
    network = Network(seed)
    ground = ground_node(network)
    one, other, impairment = two_vehicles(seed)
    for craft in (one, other):
        network.connect(autopilot_node(network, craft), ground, impairment)
    taken = detection(ground, network, 60.0)
    assert taken is not None, f"no conflict between {one} and {other}"
    assert not ground.events_of(ComponentRebooted)
    assert len(conflicts(ground)[0].senders) == 2
    return taken


def test_two_vehicles_on_two_links_are_found(seeds):
    times = []

    def scenario(seed: int) -> None:
        times.append(find_two_vehicles(seed))

    seeds.check(scenario)
    times.sort()
    print(f"detection: median {times[len(times) // 2]:.1f} s, longest {times[-1]:.1f} s")
    assert times[-1] <= 5.0


def test_a_conflict_lasts_as_long_as_both_speak():
    network = Network(1)
    ground = ground_node(network)
    pipes = [network.connect(autopilot_node(network, Craft(uid=uid)), ground) for uid in (1, 2)]
    network.run(timeout=200.0)
    assert len(conflicts(ground)) == 1
    assert not ground.events_of(AddressConflictEnded)
    for pipe in pipes[0]:
        pipe.cut = True
    network.run(timeout=60.0)
    assert len(ground.events_of(AddressConflictEnded)) == 1


def slow_link(random: Random) -> Impairment:
    """A telemetry radio: one to three seconds of delay, jitter, and sometimes little bandwidth."""
    latency = random.choice([0.0, 0.3, 1.0, 2.0, 3.0])
    return Impairment(
        latency=latency,
        jitter=random.choice([0.0, latency / 2]),
        loss=random.choice([0.0, 0.1, 0.3]),
        duplicate=random.choice([0.0, 0.1]),
        reorder=random.choice([0.0, 0.1]),
        bandwidth=random.choice([0.0, 0.0, 1200.0]),
        queue=4096,
    )


def fly_one_vehicle_over_two_links(seed: int) -> None:
    random = Random(seed)
    network = Network(seed)
    ground = ground_node(network)
    craft = Craft(
        booted=random.uniform(0, 500),
        uid=random.choice([0, 7]),
        yaw=random.uniform(-3, 3),
        speed=random.choice([0.0, 15.0, 40.0]),
        telemetry=random.choice([2.0, 4.0]),
        answers_time=random.random() < 0.8,
    )
    vehicle = autopilot_node(network, craft)
    network.connect(vehicle, ground, Impairment(latency=random.choice([0.0, 0.001, 0.1])))
    pipes = network.connect(vehicle, ground, slow_link(random))
    for begin, end in pairwise(sorted(random.uniform(0, 30) for _ in range(random.choice([0, 0, 2, 3])))):
        for pipe in pipes:
            network.at(begin, lambda pipe=pipe: setattr(pipe, "cut", True))
            network.at(end, lambda pipe=pipe: setattr(pipe, "cut", False))
    network.run(timeout=40.0)
    assert not conflicts(ground), conflicts(ground)


def test_one_vehicle_over_two_links_is_no_conflict(seeds):
    seeds.check(fly_one_vehicle_over_two_links)


class Repeater:
    """A router that sends all that comes over the first link of the ground over the second one too."""

    def __init__(self, ground, delay: float, network: Network) -> None:
        self.ground, self.delay, self.network = ground, delay, network

    def open(self) -> None:
        first, second = self.ground.ports
        receive = first.inward.receive

        def repeat(now: float) -> list[bytes]:
            data = receive(now)
            for chunk in data:
                self.network.at(self.delay, lambda chunk=chunk: second.inward.send(chunk, self.network.now))
            return data

        first.inward.receive = repeat


def fly_one_vehicle_behind_a_loop(seed: int) -> None:
    random = Random(seed)
    network = Network(seed)
    ground = ground_node(network)
    craft = Craft(uid=random.choice([0, 7]), speed=random.choice([0.0, 30.0]), yaw=random.uniform(-3, 3))
    vehicle = autopilot_node(network, craft)
    network.connect(vehicle, ground, Impairment(latency=random.choice([0.0, 0.1])))
    network.connect(network.node(Address(9, 9)), ground)
    Repeater(ground, random.choice([0.0, 0.05, 0.5, 1.5, 3.0]), network).open()
    network.run(timeout=40.0)
    assert not conflicts(ground), conflicts(ground)


def test_one_vehicle_behind_a_router_that_loops_is_no_conflict(seeds):
    seeds.check(fly_one_vehicle_behind_a_loop)


@pytest.mark.parametrize("shift", [0.0, 4.0, 30.0])
def test_two_vehicles_on_one_channel_are_found(shift):
    network = Network(3)
    ground = ground_node(network)
    network.connect(autopilot_node(network, Craft(north=100.0)), ground)
    network.connect(autopilot_node(network, Craft(booted=30 + shift)), ground)
    first, second = ground.ports
    second.channel = first.channel  # a router merges both
    taken = detection(ground, network, 60.0)
    assert taken is not None
    assert taken <= 5.0
    (conflict,) = conflicts(ground)
    assert conflict.differs[0] in ("position", "boot time")
