"""Connections: finding vehicles, links that drop, reboots and silence."""

from __future__ import annotations

import asyncio
import inspect

import pytest

from mavstack.dialects import common
from mavstack.errors import MavstackError, RemoteError, RemoteTimeout
from mavstack.links import MemoryNetwork
from mavstack.node import Node
from mavstack.services.mission import MissionItem
from mavstack.services.modes import ModeMonitor
from mavstack.services.parameters import ParameterClient
from mavstack.sim.vehicle_types import DEFAULT_HOME as HOME
from mavstack.sim.vehicle_types import VehicleType
from mavstack.sim.virtual import run_virtually
from mavstack.vehicle import NodeOptions, VehicleLost, VehicleRebooted, VehicleReturned, connect
from tests.sim.running import reduce_telemetry
from tests.vehicle.peers import AUTOPILOT, TYPE, run_scenario
from tests.vehicle.world import ARDUPILOT, PX4, fly, kind_name

COPTERS = [(VehicleType.COPTER, ARDUPILOT), (VehicleType.COPTER, PX4)]
STATION = {"type": TYPE.GCS, "autopilot": AUTOPILOT.INVALID, "uptime": None}
CAMERA = {"type": TYPE.CAMERA, "autopilot": AUTOPILOT.INVALID, "uptime": None}


def plan(count=60):
    return [
        MissionItem.waypoint(HOME.latitude + number * 1e-5, HOME.longitude, 20.0) for number in range(count)
    ]


# Finding


def test_the_options_are_those_of_node():
    parameters = inspect.signature(Node.__init__).parameters.values()
    keywords = {each.name for each in parameters if each.kind is inspect.Parameter.KEYWORD_ONLY}
    assert set(NodeOptions.__annotations__) == keywords


def test_options_reach_the_node():
    node = connect(system=200, component=common.MavComponent.ONBOARD_COMPUTER, type=TYPE.ONBOARD_CONTROLLER)
    assert node.address == (200, 191)
    with pytest.raises(TypeError, match="sistem"):
        connect(sistem=3)  # type: ignore[call-arg]


def test_it_is_awaitable():
    async def scenario():
        node = await connect(MemoryNetwork().link())
        assert node.is_open
        await node.close()

    run_virtually(scenario())


def test_without_a_vehicle_the_error_names_what_was_heard():
    async def scenario(harness):
        await harness.add_peer(1, 100, **CAMERA)
        await harness.add_peer(254, 190, **STATION)
        with pytest.raises(RemoteTimeout) as caught:
            await harness.connection.wait_for_vehicle(timeout=5)
        assert str(caught.value) == (
            "waiting for a vehicle on memory://pair failed: "
            "none in 5 s; heard: 1/100 camera, 254/190 ground station"
        )

    run_scenario(scenario)


def test_for_another_system_the_error_names_the_vehicles():
    async def scenario(harness):
        await harness.add_peer(3)
        with pytest.raises(RemoteTimeout, match=r"vehicle 7 on .*heard: 3/1 quadrotor with ArduPilot$"):
            await harness.connection.wait_for_vehicle(7, timeout=5)

    run_scenario(scenario)


@pytest.mark.parametrize(
    ("sent", "text"),
    [
        (None, "heard: nothing, no link has a peer; check address and port"),
        (b"", "heard: nothing; check address and port, and that the vehicle is on"),
        (b"\x00\x55" * 40, "heard: 80 bytes that are not MAVLink; check the baud rate"),
        (common.Attitude(), "heard: 1 packets, but no heartbeat"),
    ],
    ids=["no peer", "silence", "noise", "no heartbeat"],
)
def test_when_nothing_was_heard_the_error_names_what_to_check(sent, text):
    async def scenario(harness):
        if sent is not None:
            peer = Node(harness.network.link(), system=1, component=1, heartbeat=False)
            await peer.open()
            await asyncio.sleep(0.1)
            for channel in peer._host.driver.channels:
                if isinstance(sent, bytes):
                    channel.write(sent)
            if not isinstance(sent, bytes):
                peer.send(sent)
        with pytest.raises(RemoteTimeout) as caught:
            await harness.connection.wait_for_vehicle(timeout=5)
        if sent is not None:
            await peer.close()
        assert text in str(caught.value)

    run_scenario(scenario, heartbeat=False)


def test_waiting_skips_a_lost_vehicle():
    async def scenario(harness):
        peer = await harness.add_peer()
        first = await harness.connection.wait_for_vehicle()
        peer.quiet = True
        await asyncio.sleep(20)
        with pytest.raises(RemoteTimeout, match=r"1/1 quadrotor with ArduPilot \(silent now\)"):
            await harness.connection.wait_for_vehicle(timeout=3)
        waiting = asyncio.create_task(harness.connection.wait_for_vehicle())
        await asyncio.sleep(3)
        peer.quiet = False
        assert await waiting is first

    run_scenario(scenario)


def test_vehicles_are_in_the_order_in_which_they_were_found():
    async def scenario(harness):
        for system in (9, 2, 5):
            await harness.add_peer(system)
            await asyncio.sleep(2)
        assert list(harness.connection.vehicles) == [9, 2, 5]
        assert (await harness.connection.wait_for_vehicle()).system == 9
        with pytest.raises(TypeError):
            harness.connection.vehicles[1] = None

    run_scenario(scenario)


def test_waiting_for_several_vehicles():
    async def scenario(harness):
        for system in (1, 2):
            await harness.add_peer(system)
        group = await harness.connection.wait_for_vehicles(2)
        assert sorted(group.systems) == [1, 2]
        with pytest.raises(RemoteTimeout, match=r"for 3 vehicles on .* failed: 2 in 4 s; heard: 1/1 quad"):
            await harness.connection.wait_for_vehicles(3, timeout=4)
        late = asyncio.create_task(harness.connection.wait_for_vehicles(3))
        await asyncio.sleep(10)
        await harness.add_peer(3)
        assert sorted((await late).systems) == [1, 2, 3]

    run_scenario(scenario)


def test_a_group_of_unknown_system_ids():
    async def scenario(harness):
        await harness.add_peer(4)
        await harness.connection.wait_for_vehicle()
        assert harness.connection.group().systems == harness.connection.group(4).systems == (4,)
        with pytest.raises(MavstackError, match="no vehicle with system id 3 was found; known: 4"):
            harness.connection.group(4, 3)

    run_scenario(scenario)


# Links that drop and return


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("kind", COPTERS, ids=kind_name)
def test_a_call_during_a_silence_ends_in_its_typed_timeout(kind):
    async def scenario(world, vehicle):
        events = world.node.events(VehicleLost, VehicleReturned)
        world.simulated.cut(True)
        asked = [
            vehicle.component.command(common.MavCmd.DO_SET_HOME, 1),
            vehicle.params.get("SYSID_THISMAV"),
            vehicle.params.download(),
            vehicle.mission.upload(plan(5)),
            vehicle.mission.download(),
            vehicle.arm(),
        ]
        async with asyncio.timeout(300):
            ended = await asyncio.gather(*asked, return_exceptions=True)
        for error in ended:
            assert isinstance(error, RemoteTimeout), error
            assert "1/1" in str(error)
        world.simulated.cut(False)
        await vehicle.params.download()
        await world.wait_until(lambda: vehicle.alive)
        assert [type(event) for event in events.drain()] == [VehicleLost, VehicleReturned]
        async with world.node.stream(common.Heartbeat, system=1) as heartbeats:
            await anext(heartbeats)

    fly(kind, scenario, prepare=reduce_telemetry)


@pytest.mark.nightly
def test_a_running_call_continues_after_a_short_silence():
    async def scenario(world, vehicle):
        async def cut():
            await asyncio.sleep(1)
            world.simulated.cut(True)
            await asyncio.sleep(3)
            world.simulated.cut(False)

        cutting = asyncio.create_task(cut())
        uploaded = await vehicle.mission.upload(plan(300))
        assert len(uploaded.items) == 300
        await cutting

    fly(COPTERS[0], scenario, prepare=reduce_telemetry, latency=0.2)


def test_a_link_that_is_closed_and_opened_again():
    async def scenario(harness):
        peer = await harness.add_peer()
        vehicle = await harness.connection.wait_for_vehicle()
        await peer.stop()
        with pytest.raises(RemoteTimeout):
            await vehicle.component.command(common.MavCmd.DO_SET_HOME, 1)
        harness.new_events()
        await harness.add_peer(uptime=300.0)
        assert await harness.connection.wait_for_vehicle() is vehicle
        assert [type(event) for event in harness.new_events(VehicleReturned)] == [VehicleReturned]

    run_scenario(scenario)


# Reboots


async def outcome(work):
    """Return the result; None for a typed error."""
    try:
        return await work
    except RemoteError:
        return None


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("kind", COPTERS, ids=kind_name)
def test_the_cache_is_cleared_at_a_reboot(kind):
    async def scenario(world, vehicle):
        parameters = await vehicle.params.download()
        vehicle.component._clients.get(ModeMonitor)  # it follows from the first use on
        await world.wait_until(lambda: vehicle.component.modes.current is not None)
        whole = len(parameters)
        events = world.node.events(VehicleRebooted)
        world.simulated.reboot()
        await anext(events)
        assert not vehicle.params.cached
        assert not vehicle.component._clients.get(ParameterClient).complete
        assert len(parameters) == whole  # a returned mapping is not changed
        assert len(await vehicle.params.download()) == whole
        await world.wait_until(lambda: vehicle.component.modes.current is not None)
        assert not events.drain()

    fly(kind, scenario, prepare=reduce_telemetry)


@pytest.mark.fast_cases(2)
@pytest.mark.parametrize("kind", COPTERS, ids=kind_name)
@pytest.mark.parametrize("packed", [True, False])
def test_a_download_across_a_reboot_is_complete_or_fails(kind, packed):
    async def scenario(world, vehicle):
        whole = await vehicle.params.download(packed=packed)
        steps = []

        def progress(*step):
            steps.append(step)
            if len(steps) == 3:
                world.simulated.reboot()

        fetched = await outcome(vehicle.params.download(packed=packed, timeout=120, progress=progress))
        assert len(steps) >= 3
        assert fetched is None or fetched.keys() == whole.keys()
        assert len(await vehicle.params.download(packed=packed)) == len(whole)

    fly(kind, scenario, prepare=reduce_telemetry, latency=0.05)


@pytest.mark.nightly
@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("kind", COPTERS, ids=kind_name)
def test_an_upload_across_a_reboot_is_complete_or_fails(kind):
    async def scenario(world, vehicle):
        before = await vehicle.mission.upload(plan(3))
        uploading = asyncio.create_task(vehicle.mission.upload(plan(100), timeout=60))
        await asyncio.sleep(1)
        assert not uploading.done()
        world.simulated.reboot()
        uploaded = await outcome(uploading)
        await world.wait_until(lambda: vehicle.alive)
        assert len((await vehicle.mission.download()).items) == len((uploaded or before).items)

    fly(kind, scenario, prepare=reduce_telemetry, latency=0.05)
