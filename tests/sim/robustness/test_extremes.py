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
from tests.sim.robustness.hostile_peers import EVERY_KIND, GROUND, Victim, state_of, victims
from tests.sim.robustness.random_actions import Abuser

_CMD = common.MavCmd
HOMES = [
    *(Home(90, 0, 0, 0), Home(-90, 180, 0, 0), Home(89.9999, -180, 10, 359), Home(0, 180, -400, 90)),
    *(Home(-45, -179.9999999, 8800, 360), Home(0, 0, 0, 0)),
]


@pytest.mark.parametrize("firmware", Firmware)
@pytest.mark.parametrize("home", HOMES, ids=str)
def test_flights_begin_anywhere_on_earth(home, firmware):
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


@pytest.mark.parametrize("rate", [10, 200, 1000])
def test_flights_at_any_rate(rate):
    simulation = Simulation(rate=rate)
    vehicle = simulation.add()
    take_off(simulation, vehicle)
    for _ in range(5 * rate):
        simulation.step()
    assert vehicle.autopilot.altitude == pytest.approx(10, abs=1.5)


def test_a_full_house():
    simulation = Simulation(rate=10)
    while len(simulation.vehicles) < MAX_SYSTEMS:
        simulation.add(*EVERY_KIND[len(simulation.vehicles) % len(EVERY_KIND)])
    vehicles = simulation.vehicles
    assert sorted(vehicle.address.system for vehicle in vehicles) == list(range(1, MAX_SYSTEMS + 1))
    for vehicle in vehicles:
        vehicle.open_port("ground")
        vehicle.autopilot.arm(force=True)
    simulation.advance(simulation.now + 2)
    assert {vehicle.address.system for vehicle, _, _ in simulation.data_to_send()} == set(
        range(1, MAX_SYSTEMS + 1)
    )


def test_who_comes_later_disturbs_nobody():
    simulation = Simulation(rate=10)
    first = simulation.add()
    take_off(simulation, first)
    for kind, firmware in EVERY_KIND:
        before = first.body.truth
        simulation.add(kind, firmware)
        assert first.body.truth == before
        simulation.step()
        assert first.autopilot.altitude == pytest.approx(10, abs=1.5)


@pytest.mark.parametrize("firmware", Firmware)
def test_reboots_within_reboots(firmware):
    random = Random(3)
    simulation = Simulation(rate=10)
    victim = Victim(simulation, simulation.add(VehicleType.COPTER, firmware), random)
    for _ in range(25):
        for _ in range(random.choice([1, 1, 2, 3])):
            victim.vehicle.reboot()
        for _ in range(random.choice([0, 1, 3, 12, 25])):
            simulation.step()
        victim.check()
        victim.place_in_air()
    victim.vehicle.reboot()
    victim.take_heard()
    simulation.advance(simulation.now + 10)
    victim.check()
    assert not victim.vehicle.autopilot.armed
    assert victim.vehicle.body.on_ground
    assert {message.autopilot for message in victim.received if isinstance(message, common.Heartbeat)}
    assert len(victim.vehicle.ports) == 1


CIRCLES = [
    [MissionItem(_CMD.NAV_WAYPOINT), MissionItem(_CMD.DO_JUMP, 1, -1)],
    [MissionItem(_CMD.DO_JUMP, 1, -1)],
    [MissionItem(_CMD.DO_SET_ROI_NONE, frame=2), MissionItem(_CMD.DO_JUMP, 1, -1)],
    [MissionItem(_CMD.NAV_DELAY, 0), MissionItem(_CMD.DO_SET_ROI_NONE), MissionItem(_CMD.DO_JUMP, 1, -1)],
    [MissionItem(_CMD.NAV_LOITER_TIME), MissionItem(_CMD.DO_JUMP, 2, -1), MissionItem(_CMD.DO_JUMP, 1, -1)],
]


@pytest.mark.parametrize(("kind", "firmware"), EVERY_KIND)
@pytest.mark.parametrize("circle", range(len(CIRCLES)))
def test_a_mission_that_goes_in_a_circle_hangs_no_tick(circle, kind, firmware, monkeypatch):
    """Items at the current position take no time, and the mission jumps back without end."""
    simulation = Simulation(rate=10)
    victim = Victim(simulation, simulation.add(kind, firmware), Random(1))
    simulation.advance(simulation.now + 2.1)
    victim.place_in_air()
    legs = 0
    taken = Route.leg

    def counted(route: Route, seq: int) -> object:
        nonlocal legs
        legs += 1
        assert legs < 40, "a tick that does not end"
        return taken(route, seq)

    monkeypatch.setattr(Route, "leg", counted)
    home = [MissionItem(_CMD.NAV_WAYPOINT)] if firmware is Firmware.ARDUPILOT else []
    first = len(home)
    items = [
        MissionItem(item.command, item.param1 - 1 + first, item.param2, frame=item.frame)
        if item.command == _CMD.DO_JUMP
        else item
        for item in CIRCLES[circle]
    ]
    victim.vehicle.mission.accept(Plan.of([*home, *items]), GROUND)
    victim.vehicle.engine.touch(victim.vehicle.mission)
    victim.vehicle.autopilot.enter(victim.vehicle.profile.mission, "test", commanded=True)
    for _ in range(10):
        legs = 0
        simulation.step()
        victim.check()


def kept_memory() -> int:
    """Return the bytes in use, without the bounded caches of enum values and the test's own."""
    gc.collect()
    names = ("*/enums.py", "*/enum.py", "*/hostile.py", __file__)
    others = [tracemalloc.Filter(False, name) for name in names]
    statistics = tracemalloc.take_snapshot().filter_traces(others).statistics("filename")
    return sum(statistic.size for statistic in statistics)


def test_a_flood_leaves_nothing_behind(monkeypatch):
    """Messages of all kinds from everywhere: the memory that they leave is bounded."""
    monkeypatch.setattr("mavstack.node.routes.MAX_ADDRESSES", 64)
    random = Random(5)
    simulation = Simulation(rate=10)
    victim = Victim(simulation, simulation.add(), random)
    simulation.advance(simulation.now + 2.1)

    def flood() -> None:
        for _ in range(120):
            for _ in range(20):
                victim.send(victim.anything(), victim.anybody())
            simulation.step()
            victim.check()
            victim.take_heard()
        victim._encoders.clear()

    flood()
    tracemalloc.start()
    try:
        flood()
        before = kept_memory()
        flood()
        assert kept_memory() - before < 100_000
    finally:
        tracemalloc.stop()


def bytes_of(seed: int, *, watched: bool) -> dict[str, bytes]:
    """Return the data of vehicles of all kinds during many events; `watched` reads their state as well."""
    random, other = Random(seed), Random(9)
    made = victims(random, rate=10, seconds=2.1)
    abusers = [Abuser(victim.simulation, victim.vehicle, random) for victim in made]
    said: dict[str, bytes] = {}
    for abuser in abusers:
        abuser.place_in_air()
    for _ in range(40):
        for abuser in abusers:
            vehicle = abuser.vehicle
            if random.random() < 0.2:
                abuser.do_something()
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
        abusers[0].simulation.step()
        for vehicle, port, data in abusers[0].simulation.data_to_send():
            name = f"{vehicle.vehicle_type} {vehicle.firmware} {vehicle.ports.index(port)}"
            said[name] = said.get(name, b"") + data
    return said


def test_the_same_bytes_whoever_looks_on():
    first = bytes_of(4, watched=False)
    assert len(first) >= len(EVERY_KIND)
    assert bytes_of(4, watched=False) == first
    assert bytes_of(4, watched=True) == first
