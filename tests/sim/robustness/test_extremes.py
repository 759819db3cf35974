"""Extreme conditions: poles, many vehicles, reboots, endless jumps, floods, reproducibility."""

from __future__ import annotations

import gc
import tracemalloc
from math import hypot
from random import Random

import pytest

from mavstack.dialects import common
from mavstack.services.mission import MissionItem, Plan
from mavstack.sim.autopilot.mission.route import Route
from mavstack.sim.scenarios import take_off
from mavstack.sim.simulation import MAX_SYSTEMS, Simulation
from mavstack.sim.vehicle_types import Firmware, Home, VehicleType
from tests.sim.robustness.hostile_peers import ALL_VEHICLES, GROUND, TargetVehicle, state_of, target_vehicles
from tests.sim.robustness.random_actions import RandomActor

_CMD = common.MavCmd
HOMES = [
    *(Home(90, 0, 0, 0), Home(-90, 180, 0, 0), Home(89.9999, -180, 10, 359), Home(0, 180, -400, 90)),
    *(Home(-45, -179.9999999, 8800, 360), Home(0, 0, 0, 0)),
]


@pytest.mark.flight_cases(4)
@pytest.mark.fast_cases(3)
@pytest.mark.parametrize("firmware", Firmware)
@pytest.mark.parametrize("home", HOMES, ids=str)
def test_flights_start_anywhere_on_earth(home, firmware):
    simulation = Simulation(rate=10)
    vehicle = simulation.add(VehicleType.COPTER, firmware, home=home)
    take_off(simulation, vehicle)
    assert vehicle.autopilot.altitude == pytest.approx(10, abs=1.5)
    vehicle.autopilot.enter(vehicle.profile.return_to_launch, "test")
    simulation.advance(simulation.now + 70)
    truth = vehicle.body.truth
    assert not vehicle.autopilot.armed
    assert hypot(truth.north, truth.east) < 5
    assert vehicle.autopilot.home.altitude == pytest.approx(home.altitude, abs=5)


@pytest.mark.flight_cases(1)
@pytest.mark.flight
@pytest.mark.parametrize("rate", [10, 200, 1000])
def test_flights_at_any_rate(rate):
    simulation = Simulation(rate=rate)
    vehicle = simulation.add()
    take_off(simulation, vehicle)
    for _ in range(5 * rate):
        simulation.step()
    assert vehicle.autopilot.altitude == pytest.approx(10, abs=1.5)


@pytest.mark.nightly
def test_maximum_number_of_vehicles():
    simulation = Simulation(rate=10)
    while len(simulation.vehicles) < MAX_SYSTEMS:
        simulation.add(*ALL_VEHICLES[len(simulation.vehicles) % len(ALL_VEHICLES)])
    vehicles = simulation.vehicles
    assert sorted(vehicle.address.system for vehicle in vehicles) == list(range(1, MAX_SYSTEMS + 1))
    for vehicle in vehicles:
        vehicle.open_port("ground")
        vehicle.autopilot.arm(force=True)
    simulation.advance(simulation.now + 2)
    assert {vehicle.address.system for vehicle, _, _ in simulation.data_to_send()} == set(
        range(1, MAX_SYSTEMS + 1)
    )


def test_added_vehicle_does_not_change_others():
    simulation = Simulation(rate=10)
    first = simulation.add()
    take_off(simulation, first)
    for kind, firmware in ALL_VEHICLES:
        before = first.body.truth
        simulation.add(kind, firmware)
        assert first.body.truth == before
        simulation.step()
        assert first.autopilot.altitude == pytest.approx(10, abs=1.5)


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("firmware", Firmware)
def test_repeated_reboots(firmware):
    random = Random(3)
    simulation = Simulation(rate=10)
    target = TargetVehicle(simulation, simulation.add(VehicleType.COPTER, firmware), random)
    for _ in range(25):
        for _ in range(random.choice([1, 1, 2, 3])):
            target.vehicle.reboot()
        for _ in range(random.choice([0, 1, 3, 12, 25])):
            simulation.step()
        target.check()
        target.place_in_air()
    target.vehicle.reboot()
    target.drain_received()
    simulation.advance(simulation.now + 10)
    target.check()
    assert not target.vehicle.autopilot.armed
    assert target.vehicle.body.on_ground
    assert {message.autopilot for message in target.received if isinstance(message, common.Heartbeat)}
    assert len(target.vehicle.ports) == 1


ENDLESS_MISSIONS = [
    [MissionItem(_CMD.NAV_WAYPOINT), MissionItem(_CMD.DO_JUMP, 1, -1)],
    [MissionItem(_CMD.DO_JUMP, 1, -1)],
    [MissionItem(_CMD.DO_SET_ROI_NONE, frame=2), MissionItem(_CMD.DO_JUMP, 1, -1)],
    [MissionItem(_CMD.NAV_DELAY, 0), MissionItem(_CMD.DO_SET_ROI_NONE), MissionItem(_CMD.DO_JUMP, 1, -1)],
    [MissionItem(_CMD.NAV_LOITER_TIME), MissionItem(_CMD.DO_JUMP, 2, -1), MissionItem(_CMD.DO_JUMP, 1, -1)],
]


@pytest.mark.flight_cases(48)
@pytest.mark.fast_cases(16)
@pytest.mark.parametrize(("kind", "firmware"), ALL_VEHICLES)
@pytest.mark.parametrize("number", range(len(ENDLESS_MISSIONS)))
def test_endless_mission_does_not_block_a_tick(number, kind, firmware, monkeypatch):
    """The items at the current position take no time, and DO_JUMP repeats them without a limit."""
    simulation = Simulation(rate=10)
    target = TargetVehicle(simulation, simulation.add(kind, firmware), Random(1))
    simulation.advance(simulation.now + 2.1)
    target.place_in_air()
    legs = 0
    original_leg = Route.leg

    def counted_leg(route: Route, seq: int) -> object:
        nonlocal legs
        legs += 1
        assert legs < 40, "too many legs in one tick"
        return original_leg(route, seq)

    monkeypatch.setattr(Route, "leg", counted_leg)
    home = [MissionItem(_CMD.NAV_WAYPOINT)] if firmware is Firmware.ARDUPILOT else []
    first = len(home)
    items = [
        MissionItem(item.command, item.param1 - 1 + first, item.param2, frame=item.frame)
        if item.command == _CMD.DO_JUMP
        else item
        for item in ENDLESS_MISSIONS[number]
    ]
    target.vehicle.mission.accept(Plan.of([*home, *items]), GROUND)
    target.vehicle.engine.touch(target.vehicle.mission)
    target.vehicle.autopilot.enter(target.vehicle.profile.mission, "test", commanded=True)
    for _ in range(10):
        legs = 0
        simulation.step()
        target.check()


def used_memory() -> int:
    """Return the bytes in use, without bounded caches (enum values, lookups) and the tests' own objects."""
    gc.collect()
    names = ("*/enums.py", "*/enum.py", "*/service_index.py", "*/hostile_peers.py", __file__)
    others = [tracemalloc.Filter(False, name) for name in names]
    statistics = tracemalloc.take_snapshot().filter_traces(others).statistics("filename")
    return sum(statistic.size for statistic in statistics)


@pytest.mark.nightly
def test_memory_is_bounded_under_a_flood(monkeypatch):
    """Send random messages from many sources; the memory that stays allocated is bounded."""
    monkeypatch.setattr("mavstack.node.routes.MAX_ADDRESSES", 64)
    random = Random(5)
    simulation = Simulation(rate=10)
    target = TargetVehicle(simulation, simulation.add(), random)
    simulation.advance(simulation.now + 2.1)

    def flood() -> None:
        for _ in range(120):
            for _ in range(20):
                target.send(target.random_message(), target.random_source())
            simulation.step()
            target.check()
            target.drain_received()
        target._encoders.clear()

    flood()
    tracemalloc.start()
    try:
        for _ in range(3):  # until the bounded tables of addresses are full
            flood()
        before = used_memory()
        flood()
        assert used_memory() - before < 100_000
    finally:
        tracemalloc.stop()


def sent_bytes(seed: int, *, watched: bool) -> dict[str, bytes]:
    """Return the data that all vehicles send under random actions; `watched` also reads their state."""
    random, other = Random(seed), Random(9)
    targets = target_vehicles(random, rate=10, seconds=2.1)
    actors = [RandomActor(target.simulation, target.vehicle, random) for target in targets]
    sent: dict[str, bytes] = {}
    for actor in actors:
        actor.place_in_air()
    for _ in range(40):
        for actor in actors:
            vehicle = actor.vehicle
            if random.random() < 0.2:
                actor.run_random_action()
            if watched and other.random() < 0.5:
                autopilot = vehicle.autopilot
                print(dict(state_of(vehicle)), vehicle.body.sensors, vehicle.body.health, autopilot.altitude)
                print(
                    autopilot.base_mode,
                    autopilot.system_status,
                    autopilot.landed_state,
                    vehicle.engine.next_timeout(),
                )
                print(
                    autopilot.mission.route,
                    vehicle.storage.logs.logs(),
                    list(vehicle.profile.arming_problems(autopilot)),
                )
        actors[0].simulation.step()
        for vehicle, port, data in actors[0].simulation.data_to_send():
            name = f"{vehicle.vehicle_type} {vehicle.firmware} {vehicle.ports.index(port)}"
            sent[name] = sent.get(name, b"") + data
    return sent


@pytest.mark.nightly
def test_reading_state_does_not_change_the_sent_bytes():
    first = sent_bytes(4, watched=False)
    assert len(first) >= len(ALL_VEHICLES)
    assert sent_bytes(4, watched=False) == first
    assert sent_bytes(4, watched=True) == first
