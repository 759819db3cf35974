"""Events of vehicles, payloads and ground stations are emitted once, when they happen."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.dialects import common
from mavstack.services.heartbeat import ComponentLost, ComponentRebooted, OwnAddressConflict
from mavstack.vehicle import (
    GroundStationFound,
    GroundStationLost,
    GroundStationReturned,
    PayloadFound,
    PayloadLost,
    PayloadReturned,
    SecondAutopilotFound,
    SystemIdConflict,
    SystemIdConflictEnded,
    VehicleEvent,
    VehicleFound,
    VehicleLost,
    VehicleRebooted,
    VehicleReturned,
)
from tests.vehicle.peers import AUTOPILOT, TYPE, run_scenario

STATION = {"type": TYPE.GCS, "autopilot": AUTOPILOT.INVALID, "uptime": None}
CAMERA = {"type": TYPE.CAMERA, "autopilot": AUTOPILOT.INVALID, "uptime": None}
COMPANION = {"type": TYPE.ONBOARD_CONTROLLER, "autopilot": AUTOPILOT.INVALID, "uptime": None}
ALL = (VehicleEvent, GroundStationFound, GroundStationLost, GroundStationReturned, OwnAddressConflict)


def texts(events):
    return [str(event) for event in events]


def test_a_vehicle_is_found_once():
    async def scenario(harness):
        await harness.add_peer()
        await asyncio.sleep(20)
        (found,) = harness.new_events(*ALL)
        assert isinstance(found, VehicleFound)
        assert found.vehicle is harness.connection.vehicles[1]
        assert found.vehicle.alive
        assert str(found) == "vehicle 1 found: quadrotor with ArduPilot"

    run_scenario(scenario)


def test_silence_and_return():
    async def scenario(harness):
        peer = await harness.add_peer()
        await asyncio.sleep(10)
        harness.new_events()
        peer.quiet = True
        await asyncio.sleep(4)
        assert not harness.new_events(*ALL)
        await asyncio.sleep(16)
        (lost,) = harness.new_events(*ALL)
        assert isinstance(lost, VehicleLost)
        assert lost.reason == "silent for 5 s"
        assert not lost.vehicle.alive
        peer.quiet = False
        await asyncio.sleep(10)
        (back,) = harness.new_events(*ALL)
        assert isinstance(back, VehicleReturned)
        assert back.after == pytest.approx(20, abs=1)
        assert back.vehicle is lost.vehicle is harness.connection.vehicles[1]
        assert back.vehicle.alive
        assert str(back) == f"vehicle 1 returned after {back.after:.0f} s"

    run_scenario(scenario)


def test_a_link_that_is_closed_loses_its_vehicle_at_once():
    async def scenario(harness):
        peer = await harness.add_peer()
        await harness.add_peer(2)
        await asyncio.sleep(5)
        harness.new_events()
        await peer.stop()
        await asyncio.sleep(0.1)
        (lost,) = harness.new_events(*ALL)
        assert lost.vehicle.system == 1
        assert lost.reason.startswith("its link memory pair")
        assert lost.reason.endswith("is closed: closed by the peer")
        await asyncio.sleep(10)
        assert not harness.new_events(ComponentLost)  # reported once, not again as a lost component

    run_scenario(scenario)


def test_a_vehicle_on_another_link_is_not_lost():
    async def scenario(harness):
        first = await harness.add_peer()
        await harness.add_peer()
        await asyncio.sleep(5)
        harness.new_events()
        await first.stop()
        await asyncio.sleep(10)
        assert not harness.new_events(*ALL)

    run_scenario(scenario)


def test_a_reboot():
    async def scenario(harness):
        peer = await harness.add_peer()
        await asyncio.sleep(10)
        harness.new_events()
        await peer.reboot()
        await asyncio.sleep(20)
        (rebooted,) = harness.new_events(*ALL)
        assert isinstance(rebooted, VehicleRebooted)
        assert str(rebooted) == "vehicle 1 rebooted"

    run_scenario(scenario)


def test_a_reboot_that_takes_long():
    async def scenario(harness):
        peer = await harness.add_peer()
        await asyncio.sleep(10)
        harness.new_events()
        await peer.reboot(silence=30)
        await asyncio.sleep(20)
        kinds = [type(event) for event in harness.new_events(*ALL)]
        assert kinds == [VehicleLost, VehicleReturned, VehicleRebooted]

    run_scenario(scenario)


def test_the_reboot_of_a_payload_is_not_its_vehicles():
    async def scenario(harness):
        await harness.add_peer()
        camera = await harness.add_peer(1, 100, type=TYPE.CAMERA, autopilot=AUTOPILOT.INVALID)
        await asyncio.sleep(10)
        harness.new_events()
        await camera.reboot()
        await asyncio.sleep(5)
        events = harness.new_events(ComponentRebooted, *ALL)
        assert [type(event) for event in events] == [ComponentRebooted]

    run_scenario(scenario)


def test_a_system_id_conflict_is_reported_once_and_is_no_reboot():
    async def scenario(harness):
        await harness.add_peer(uptime=100.0)
        other = await harness.add_peer(uptime=900.0)
        await asyncio.sleep(120)
        found, conflict = harness.new_events(*ALL)
        assert isinstance(found, VehicleFound)
        assert isinstance(conflict, SystemIdConflict)
        assert len(conflict.senders) == 2
        assert [len(sender.channels) for sender in conflict.senders] == [1, 1]
        assert conflict.vehicle.has_id_conflict
        assert str(conflict).startswith("vehicle 1 has a system id conflict: quadrotor with Ardu")
        other.quiet = True
        await asyncio.sleep(60)
        (over,) = harness.new_events(*ALL)
        assert isinstance(over, SystemIdConflictEnded)
        assert not over.vehicle.has_id_conflict

    run_scenario(scenario)


def test_a_second_vehicle_with_the_same_id_is_no_reboot():
    async def scenario(harness):
        await harness.add_peer(uptime=100.0)
        await asyncio.sleep(30)
        harness.new_events()
        await harness.add_peer(uptime=1.0)
        await asyncio.sleep(60)
        assert [type(event) for event in harness.new_events(*ALL)] == [SystemIdConflict]

    run_scenario(scenario)


def test_a_system_id_conflict_of_two_vehicle_types():
    async def scenario(harness):
        await harness.add_peer(uptime=None)
        await harness.add_peer(type=TYPE.FIXED_WING, autopilot=AUTOPILOT.PX4, uptime=None)
        await asyncio.sleep(60)
        (conflict,) = harness.new_events(SystemIdConflict)
        text = str(conflict)
        assert "quadrotor with ArduPilot on memory pair" in text
        assert "fixed wing with PX4 on memory pair" in text

    run_scenario(scenario)


def test_a_second_vehicle_is_no_conflict():
    async def scenario(harness):
        await harness.add_peer(1)
        await asyncio.sleep(5)
        await harness.add_peer(2, uptime=900.0, type=TYPE.FIXED_WING)
        await asyncio.sleep(60)
        assert texts(harness.new_events(*ALL)) == [
            "vehicle 1 found: quadrotor with ArduPilot",
            "vehicle 2 found: fixed wing with ArduPilot",
        ]
        assert list(harness.connection.vehicles) == [1, 2]

    run_scenario(scenario)


def test_payloads_are_reported_once_their_vehicle_is_known():
    async def scenario(harness):
        camera = await harness.add_peer(1, 100, **CAMERA)
        await asyncio.sleep(5)
        assert not harness.new_events(*ALL)
        await harness.add_peer(1, 1)
        await asyncio.sleep(5)
        await harness.add_peer(1, 191, **COMPANION)
        await harness.add_peer(2, 100, **CAMERA)  # on a system without a vehicle
        await asyncio.sleep(5)
        assert texts(harness.new_events(*ALL)) == [
            "vehicle 1 found: quadrotor with ArduPilot",
            "vehicle 1 has camera 1/100",
            "vehicle 1 has companion computer 1/191",
        ]
        vehicle = harness.connection.vehicles[1]
        assert {number: info.description for number, info in vehicle.components.items()} == {
            100: "camera",
            191: "companion computer",
        }
        camera.quiet = True
        await asyncio.sleep(10)
        (lost,) = harness.new_events(*ALL)
        assert isinstance(lost, PayloadLost)
        assert str(lost) == "vehicle 1 lost camera 1/100: silent for 5 s"
        assert vehicle.alive
        assert not vehicle.components[100].alive
        camera.quiet = False
        await asyncio.sleep(2)
        (back,) = harness.new_events(*ALL)
        assert isinstance(back, PayloadReturned)
        assert str(back).startswith("vehicle 1 has camera 1/100 again after ")

    run_scenario(scenario)


def test_ground_stations_are_no_vehicles_and_no_payloads():
    async def scenario(harness):
        await harness.add_peer(1)
        station = await harness.add_peer(1, 190, **STATION)  # with the vehicle's own system id
        await asyncio.sleep(5)
        assert texts(harness.new_events(*ALL)) == [
            "vehicle 1 found: quadrotor with ArduPilot",
            "another ground station: 1/190",
        ]
        assert [str(address) for address in harness.connection.ground_stations] == ["1/190"]
        station.quiet = True
        await asyncio.sleep(10)
        station.quiet = False
        await asyncio.sleep(2)
        events = harness.new_events(*ALL)
        assert [type(event) for event in events] == [GroundStationLost, GroundStationReturned]
        assert str(events[0]) == "ground station 1/190 lost: silent for 5 s"

    run_scenario(scenario)


def test_the_node_itself_is_no_ground_station():
    async def scenario(harness):
        await harness.add_peer()
        await asyncio.sleep(10)
        assert not harness.connection.ground_stations
        assert not harness.new_events(GroundStationFound)

    run_scenario(scenario)


def test_another_station_with_the_own_address_is_reported_once():
    async def scenario(harness):
        await harness.add_peer(255, 190, **STATION)
        await asyncio.sleep(30)
        (taken,) = harness.new_events(*ALL)
        assert isinstance(taken, OwnAddressConflict)
        assert taken.component.description == "ground station"

    run_scenario(scenario)


def test_echoed_heartbeats_of_the_node_are_ignored():
    async def scenario(harness):
        mirror = harness.network.link()
        await mirror.open()

        async def reflect():
            async for batch in mirror.batches():
                for event in batch:
                    if hasattr(event, "data"):
                        event.channel.write(event.data)

        task = asyncio.create_task(reflect())
        await asyncio.sleep(30)
        task.cancel()
        await mirror.close()
        assert not harness.new_events(*ALL)

    run_scenario(scenario)


def test_an_autopilot_need_not_be_component_1():
    async def scenario(harness):
        await harness.add_peer(7, 42)
        vehicle = await harness.connection.wait_for_vehicle()
        assert vehicle.address == (7, 42)
        assert harness.connection.vehicles[7] is vehicle

    run_scenario(scenario)


def test_a_second_autopilot_is_reported_and_never_takes_over():
    async def scenario(harness):
        first = await harness.add_peer(1, 1)
        await asyncio.sleep(2)
        await harness.add_peer(1, 2)
        await asyncio.sleep(5)
        found, second = harness.new_events(*ALL)
        assert isinstance(found, VehicleFound)
        assert isinstance(second, SecondAutopilotFound)
        assert str(second) == "vehicle 1 has a second autopilot: quadrotor with ArduPilot 1/2"
        first.quiet = True
        await asyncio.sleep(10)
        vehicle = harness.connection.vehicles[1]
        assert vehicle.address == (1, 1)
        assert not vehicle.alive
        assert vehicle.components[2].alive
        assert [type(event) for event in harness.new_events(*ALL)] == [VehicleLost]

    run_scenario(scenario)


def test_a_component_that_becomes_an_autopilot_is_found_then():
    async def scenario(harness):
        peer = await harness.add_peer(1, 1, type=TYPE.GENERIC, autopilot=AUTOPILOT.INVALID)
        await asyncio.sleep(5)
        assert not harness.new_events(*ALL)
        peer.type, peer.autopilot = TYPE.QUADROTOR, AUTOPILOT.PX4
        vehicle = await harness.connection.wait_for_vehicle(timeout=5)
        assert vehicle.system == 1
        assert [type(event) for event in harness.new_events(*ALL)] == [VehicleFound]

    run_scenario(scenario)


def test_a_gimbal_that_calls_itself_the_autopilot_does_not_lose_the_vehicle():
    async def scenario(harness):
        await harness.add_peer(1, 1)
        await harness.add_peer(1, 1, type=TYPE.GIMBAL, autopilot=AUTOPILOT.INVALID, uptime=None)
        await asyncio.sleep(30)
        assert [type(event) for event in harness.new_events(*ALL)] == [VehicleFound, SystemIdConflict]
        assert harness.connection.vehicles[1].component.info.is_autopilot

    run_scenario(scenario)


def test_an_autopilot_that_calls_itself_a_camera_for_a_while_is_not_its_own_payload():
    async def scenario(harness):
        peer = await harness.add_peer()
        await asyncio.sleep(5)
        harness.new_events()
        for peer.type, peer.autopilot in (
            (TYPE.CAMERA, AUTOPILOT.INVALID),
            (TYPE.QUADROTOR, AUTOPILOT.PX4),
        ):
            await asyncio.sleep(20)
        assert not harness.new_events(*ALL)
        assert harness.connection.vehicles[1].alive

    run_scenario(scenario)


def test_payloads_alone_are_only_components():
    async def scenario(harness):
        await harness.add_peer(1, 100, **CAMERA)
        await harness.add_peer(1, 154, type=TYPE.GIMBAL, autopilot=AUTOPILOT.INVALID)
        await asyncio.sleep(10)
        assert not harness.new_events(*ALL)
        assert not harness.new_events(PayloadFound)
        assert len(harness.connection.components) == 2
        assert not harness.connection.vehicles

    run_scenario(scenario)


def test_events_of_vehicles_can_be_iterated_over():
    async def scenario(harness):
        async with harness.connection.events(VehicleEvent) as events:
            await harness.add_peer()
            first = await anext(events)
            assert isinstance(first, VehicleFound)
            assert first.vehicle.component.info.type == common.MavType.QUADROTOR

    run_scenario(scenario)
