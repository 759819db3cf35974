"""The blocking vehicle API: a script flies a simulated vehicle over real sockets."""

from __future__ import annotations

import pytest

import mavstack.sync
from mavstack.dialects import common
from mavstack.errors import ActionUnsupported, CommandDenied, GroupError
from mavstack.sim.background import BackgroundSimulator
from mavstack.vehicle import VehicleFound
from tests.interrupts import interrupt_main_thread, keyboard_interrupts


@pytest.fixture(scope="module")
def simulated():
    background = BackgroundSimulator("copter", "ardupilot", count=2, speed=20.0)
    for vehicle in background.simulation.vehicles:
        vehicle.parameters.set("FS_GCS_ENABLE", 0)  # ground-station heartbeats are sent in real time
    with background:
        yield background


@pytest.fixture
def node(simulated):
    with mavstack.sync.connect(simulated.url) as node:
        node.wait_for_vehicles(2, timeout=30)
        yield node


@pytest.mark.flight
def test_a_script_flies_a_vehicle(node):
    vehicle = node.wait_for_vehicle(1)
    vehicle.wait_until_ready()
    vehicle.arm()
    vehicle.takeoff(10)
    assert vehicle.armed
    assert vehicle.position.relative_altitude == pytest.approx(10, abs=2)
    vehicle.move(north=10)
    with vehicle.guided() as guided:
        guided.velocity(north=1)
        vehicle.wait_for_message(common.GlobalPositionInt)
    assert vehicle.params.get("WPNAV_SPEED").value == 1000
    assert vehicle.mission.download().items is not None
    with vehicle.stream(common.Attitude, rate=10) as attitudes:
        assert isinstance(next(attitudes), common.Attitude)
    vehicle.rtl()
    assert not vehicle.armed


def test_vehicles_groups_and_events(node):
    assert list(node.vehicles) == [1, 2]
    assert node.vehicles[2] == node.wait_for_vehicle(2)
    assert node.vehicles[2] != node.wait_for_vehicle(1)
    group = node.group()
    assert len(group) == 2
    assert group
    assert [vehicle.system for vehicle in group] == [1, 2]
    for vehicle in group:
        vehicle.wait_until_ready()
    group.set_mode("GUIDED").check()
    results = group.arm()
    assert results.ok
    assert set(results) == set(group)
    assert results[node.wait_for_vehicle(1)] is None
    group.disarm().check()
    with pytest.raises(GroupError):
        group.takeoff(10).check()  # disarmed


def test_a_group_runs_blocking_functions_at_the_same_time(node):
    def climb(vehicle):
        vehicle.wait_until_ready()
        vehicle.set_mode("GUIDED")
        return vehicle.system

    results = node.group().each(climb, name="changing mode")
    assert {vehicle.system: result for vehicle, result in results.items()} == {1: 1, 2: 2}

    def fail(vehicle):
        vehicle.component.command(common.MavCmd.DO_ORBIT)

    with pytest.raises(GroupError):
        node.group().each(fail, max_concurrency=1).check()


def test_ctrl_c_in_the_functions_of_a_group(node):
    interrupt_main_thread(after=0.5)
    with keyboard_interrupts(), pytest.raises(KeyboardInterrupt):
        node.group().each(lambda vehicle: vehicle.wait_for_message(common.Ping))
    assert node.wait_for_vehicle(1).alive


def test_objects_are_instances_of_the_blocking_classes(node):
    vehicle = node.wait_for_vehicle(1)
    assert type(vehicle) is mavstack.sync.Vehicle
    assert type(vehicle.params) is mavstack.sync.Params
    assert isinstance(vehicle.mission, mavstack.sync.VehiclePlan)
    assert isinstance(node, mavstack.sync.Node)
    assert type(node.group()) is mavstack.sync.Group
    with pytest.raises(ImportError):
        from mavstack.sync import Driver  # noqa: F401


def test_assignment_to_read_only_attributes_is_refused(node):
    vehicle = node.wait_for_vehicle(1)
    for name in ("armed", "params", "arm", "altitude", "mode", "component", "connection", "_inner"):
        with pytest.raises(AttributeError, match=name):
            setattr(vehicle, name, 7)
    (channel,) = node.links[0].channels
    state = node.channel_state(channel)
    state.trusted = True
    assert state.trusted is True


def test_events_lead_to_blocking_vehicles(simulated):
    with mavstack.sync.connect("udpin:127.0.0.1:0") as node, node.events(VehicleFound) as events:
        node.add_link(simulated.url)  # not before: vehicles may be found before the subscription
        found = next(events)
        assert found.vehicle == node.wait_for_vehicle(found.vehicle.system)


def test_errors_are_those_of_the_async_api(node):
    vehicle = node.wait_for_vehicle(1)
    with pytest.raises(CommandDenied):
        vehicle.component.command(common.MavCmd.DO_ORBIT)
    with BackgroundSimulator("rover") as rover, mavstack.sync.connect(rover.url) as other:
        driven = other.wait_for_vehicle()
        with pytest.raises(ActionUnsupported, match="cannot take off: it is a rover"):
            driven.takeoff(10)
