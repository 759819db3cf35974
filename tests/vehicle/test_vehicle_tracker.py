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
from tests.vehicle.peers import AUTOPILOT, TYPE, play

STATION = {"type": TYPE.GCS, "autopilot": AUTOPILOT.INVALID, "uptime": None}
CAMERA = {"type": TYPE.CAMERA, "autopilot": AUTOPILOT.INVALID, "uptime": None}
COMPANION = {"type": TYPE.ONBOARD_CONTROLLER, "autopilot": AUTOPILOT.INVALID, "uptime": None}
ALL = (VehicleEvent, GroundStationFound, GroundStationLost, GroundStationReturned, OwnAddressConflict)


def texts(events):
    return [str(event) for event in events]


def test_a_vehicle_is_found_once():
    async def scenario(stage):
        await stage.enter()
        await asyncio.sleep(20)
        (found,) = stage.told(*ALL)
        assert isinstance(found, VehicleFound)
        assert found.vehicle is stage.node.vehicles[1]
        assert found.vehicle.alive
        assert str(found) == "vehicle 1 found: quadrotor with ArduPilot"

    play(scenario)


def test_silence_and_return():
    async def scenario(stage):
        peer = await stage.enter()
        await asyncio.sleep(10)
        stage.told()
        peer.quiet = True
        await asyncio.sleep(4)
        assert not stage.told(*ALL)
        await asyncio.sleep(16)
        (lost,) = stage.told(*ALL)
        assert isinstance(lost, VehicleLost)
        assert lost.reason == "silent for 5 s"
        assert not lost.vehicle.alive
        peer.quiet = False
        await asyncio.sleep(10)
        (back,) = stage.told(*ALL)
        assert isinstance(back, VehicleReturned)
        assert back.after == pytest.approx(20, abs=1)
        assert back.vehicle is lost.vehicle is stage.node.vehicles[1]
        assert back.vehicle.alive
        assert str(back) == f"vehicle 1 returned after {back.after:.0f} s"

    play(scenario)


def test_a_link_that_is_closed_loses_its_vehicle_at_once():
    async def scenario(stage):
        peer = await stage.enter()
        await stage.enter(2)
        await asyncio.sleep(5)
        stage.told()
        await peer.stop()
        await asyncio.sleep(0.1)
        (lost,) = stage.told(*ALL)
        assert lost.vehicle.system == 1
        assert lost.reason.startswith("its link memory pair")
        assert lost.reason.endswith("is closed: closed by the peer")
        await asyncio.sleep(10)
        assert not stage.told(ComponentLost)  # told once, and the other one is there

    play(scenario)


def test_a_vehicle_on_another_link_is_not_lost():
    async def scenario(stage):
        first = await stage.enter()
        await stage.enter()
        await asyncio.sleep(5)
        stage.told()
        await first.stop()
        await asyncio.sleep(10)
        assert not stage.told(*ALL)

    play(scenario)


def test_a_reboot():
    async def scenario(stage):
        peer = await stage.enter()
        await asyncio.sleep(10)
        stage.told()
        await peer.reboot()
        await asyncio.sleep(20)
        (rebooted,) = stage.told(*ALL)
        assert isinstance(rebooted, VehicleRebooted)
        assert str(rebooted) == "vehicle 1 rebooted"

    play(scenario)


def test_a_reboot_that_takes_long():
    async def scenario(stage):
        peer = await stage.enter()
        await asyncio.sleep(10)
        stage.told()
        await peer.reboot(silence=30)
        await asyncio.sleep(20)
        assert [type(event) for event in stage.told(*ALL)] == [VehicleLost, VehicleReturned, VehicleRebooted]

    play(scenario)


def test_the_reboot_of_a_payload_is_not_its_vehicles():
    async def scenario(stage):
        await stage.enter()
        camera = await stage.enter(1, 100, type=TYPE.CAMERA, autopilot=AUTOPILOT.INVALID)
        await asyncio.sleep(10)
        stage.told()
        await camera.reboot()
        await asyncio.sleep(5)
        told = stage.told(ComponentRebooted, *ALL)
        assert [type(event) for event in told] == [ComponentRebooted]

    play(scenario)


def test_a_system_id_conflict_is_reported_once_and_is_no_reboot():
    async def scenario(stage):
        await stage.enter(uptime=100.0)
        other = await stage.enter(uptime=900.0)
        await asyncio.sleep(120)
        found, conflict = stage.told(*ALL)
        assert isinstance(found, VehicleFound)
        assert isinstance(conflict, SystemIdConflict)
        assert len(conflict.senders) == 2
        assert [len(sender.channels) for sender in conflict.senders] == [1, 1]
        assert conflict.vehicle.has_id_conflict
        assert str(conflict).startswith("vehicle 1 has a system id conflict: quadrotor with Ardu")
        other.quiet = True
        await asyncio.sleep(60)
        (over,) = stage.told(*ALL)
        assert isinstance(over, SystemIdConflictEnded)
        assert not over.vehicle.has_id_conflict

    play(scenario)


def test_a_second_vehicle_with_the_same_id_is_no_reboot():
    async def scenario(stage):
        await stage.enter(uptime=100.0)
        await asyncio.sleep(30)
        stage.told()
        await stage.enter(uptime=1.0)
        await asyncio.sleep(60)
        assert [type(event) for event in stage.told(*ALL)] == [SystemIdConflict]

    play(scenario)


def test_a_system_id_conflict_of_two_vehicle_types():
    async def scenario(stage):
        await stage.enter(uptime=None)
        await stage.enter(type=TYPE.FIXED_WING, autopilot=AUTOPILOT.PX4, uptime=None)
        await asyncio.sleep(60)
        (conflict,) = stage.told(SystemIdConflict)
        text = str(conflict)
        assert "quadrotor with ArduPilot on memory pair" in text
        assert "fixed wing with PX4 on memory pair" in text

    play(scenario)


def test_a_second_vehicle_is_no_conflict():
    async def scenario(stage):
        await stage.enter(1)
        await asyncio.sleep(5)
        await stage.enter(2, uptime=900.0, type=TYPE.FIXED_WING)
        await asyncio.sleep(60)
        assert texts(stage.told(*ALL)) == [
            "vehicle 1 found: quadrotor with ArduPilot",
            "vehicle 2 found: fixed wing with ArduPilot",
        ]
        assert list(stage.node.vehicles) == [1, 2]

    play(scenario)


def test_payloads_are_reported_once_their_vehicle_is_known():
    async def scenario(stage):
        camera = await stage.enter(1, 100, **CAMERA)
        await asyncio.sleep(5)
        assert not stage.told(*ALL)
        await stage.enter(1, 1)
        await asyncio.sleep(5)
        await stage.enter(1, 191, **COMPANION)
        await stage.enter(2, 100, **CAMERA)  # on a system without a vehicle
        await asyncio.sleep(5)
        assert texts(stage.told(*ALL)) == [
            "vehicle 1 found: quadrotor with ArduPilot",
            "vehicle 1 has camera 1/100",
            "vehicle 1 has companion computer 1/191",
        ]
        vehicle = stage.node.vehicles[1]
        assert {number: info.description for number, info in vehicle.components.items()} == {
            100: "camera",
            191: "companion computer",
        }
        camera.quiet = True
        await asyncio.sleep(10)
        (lost,) = stage.told(*ALL)
        assert isinstance(lost, PayloadLost)
        assert str(lost) == "vehicle 1 lost camera 1/100: silent for 5 s"
        assert vehicle.alive
        assert not vehicle.components[100].alive
        camera.quiet = False
        await asyncio.sleep(2)
        (back,) = stage.told(*ALL)
        assert isinstance(back, PayloadReturned)
        assert str(back).startswith("vehicle 1 has camera 1/100 again after ")

    play(scenario)


def test_ground_stations_are_no_vehicles_and_no_payloads():
    async def scenario(stage):
        await stage.enter(1)
        station = await stage.enter(1, 190, **STATION)  # with the vehicle's own system id
        await asyncio.sleep(5)
        assert texts(stage.told(*ALL)) == [
            "vehicle 1 found: quadrotor with ArduPilot",
            "another ground station: 1/190",
        ]
        assert [str(address) for address in stage.node.ground_stations] == ["1/190"]
        station.quiet = True
        await asyncio.sleep(10)
        station.quiet = False
        await asyncio.sleep(2)
        told = stage.told(*ALL)
        assert [type(event) for event in told] == [GroundStationLost, GroundStationReturned]
        assert str(told[0]) == "ground station 1/190 lost: silent for 5 s"

    play(scenario)


def test_the_node_itself_is_no_ground_station():
    async def scenario(stage):
        await stage.enter()
        await asyncio.sleep(10)
        assert not stage.node.ground_stations
        assert not stage.told(GroundStationFound)

    play(scenario)


def test_another_station_with_the_own_address_is_reported_once():
    async def scenario(stage):
        await stage.enter(255, 190, **STATION)
        await asyncio.sleep(30)
        (taken,) = stage.told(*ALL)
        assert isinstance(taken, OwnAddressConflict)
        assert taken.component.description == "ground station"

    play(scenario)


def test_echoed_heartbeats_of_the_node_are_ignored():
    async def scenario(stage):
        mirror = stage.network.link()
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
        assert not stage.told(*ALL)

    play(scenario)


def test_an_autopilot_need_not_be_component_1():
    async def scenario(stage):
        await stage.enter(7, 42)
        vehicle = await stage.node.wait_for_vehicle()
        assert vehicle.address == (7, 42)
        assert stage.node.vehicles[7] is vehicle

    play(scenario)


def test_a_second_autopilot_is_reported_and_never_takes_over():
    async def scenario(stage):
        first = await stage.enter(1, 1)
        await asyncio.sleep(2)
        await stage.enter(1, 2)
        await asyncio.sleep(5)
        found, second = stage.told(*ALL)
        assert isinstance(found, VehicleFound)
        assert isinstance(second, SecondAutopilotFound)
        assert str(second) == "vehicle 1 has a second autopilot: quadrotor with ArduPilot 1/2"
        first.quiet = True
        await asyncio.sleep(10)
        vehicle = stage.node.vehicles[1]
        assert vehicle.address == (1, 1)
        assert not vehicle.alive
        assert vehicle.components[2].alive
        assert [type(event) for event in stage.told(*ALL)] == [VehicleLost]

    play(scenario)


def test_a_component_that_becomes_an_autopilot_is_found_then():
    async def scenario(stage):
        peer = await stage.enter(1, 1, type=TYPE.GENERIC, autopilot=AUTOPILOT.INVALID)
        await asyncio.sleep(5)
        assert not stage.told(*ALL)
        peer.type, peer.autopilot = TYPE.QUADROTOR, AUTOPILOT.PX4
        vehicle = await stage.node.wait_for_vehicle(timeout=5)
        assert vehicle.system == 1
        assert [type(event) for event in stage.told(*ALL)] == [VehicleFound]

    play(scenario)


def test_a_gimbal_that_calls_itself_the_autopilot_does_not_lose_the_vehicle():
    async def scenario(stage):
        await stage.enter(1, 1)
        await stage.enter(1, 1, type=TYPE.GIMBAL, autopilot=AUTOPILOT.INVALID, uptime=None)
        await asyncio.sleep(30)
        assert [type(event) for event in stage.told(*ALL)] == [VehicleFound, SystemIdConflict]
        assert stage.node.vehicles[1].component.info.is_autopilot

    play(scenario)


def test_an_autopilot_that_calls_itself_a_camera_for_a_while_is_not_its_own_payload():
    async def scenario(stage):
        peer = await stage.enter()
        await asyncio.sleep(5)
        stage.told()
        for peer.type, peer.autopilot in (
            (TYPE.CAMERA, AUTOPILOT.INVALID),
            (TYPE.QUADROTOR, AUTOPILOT.PX4),
        ):
            await asyncio.sleep(20)
        assert not stage.told(*ALL)
        assert stage.node.vehicles[1].alive

    play(scenario)


def test_payloads_alone_are_only_components():
    async def scenario(stage):
        await stage.enter(1, 100, **CAMERA)
        await stage.enter(1, 154, type=TYPE.GIMBAL, autopilot=AUTOPILOT.INVALID)
        await asyncio.sleep(10)
        assert not stage.told(*ALL)
        assert not stage.told(PayloadFound)
        assert len(stage.node.components) == 2
        assert not stage.node.vehicles

    play(scenario)


def test_events_of_vehicles_can_be_iterated_over():
    async def scenario(stage):
        async with stage.node.events(VehicleEvent) as events:
            await stage.enter()
            first = await anext(events)
            assert isinstance(first, VehicleFound)
            assert first.vehicle.component.info.type == common.MavType.QUADROTOR

    play(scenario)
