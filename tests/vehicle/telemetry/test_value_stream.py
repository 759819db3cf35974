"""Streams of telemetry values, typed, at a rate, and the wait for first values."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.dialects import common
from mavstack.errors import CommandDenied, InvalidArgumentError, MessageTimeout
from mavstack.sim.vehicle_types import VehicleType
from mavstack.vehicle.telemetry.values import Battery, HomePosition
from tests.sim.running import reduce_telemetry
from tests.vehicle.telemetry.harness import RESULT, with_peer
from tests.vehicle.world import ARDUPILOT, PX4, fly, kind_name

COPTERS = [(VehicleType.COPTER, ARDUPILOT), (VehicleType.COPTER, PX4)]
ATTITUDE, QUATERNION = 30, 31


@pytest.mark.parametrize("kind", COPTERS, ids=kind_name)
def test_the_first_values_are_waited_for(kind):
    async def scenario(world, vehicle):
        assert vehicle.battery is None
        assert vehicle.home is None
        await vehicle.wait_for_telemetry()
        assert None not in (vehicle.position, vehicle.battery, vehicle.gps, vehicle.home)
        began = world.node.now()
        await vehicle.wait_for_telemetry("position", "home")
        assert world.node.now() == began

    fly(kind, scenario, prepare=reduce_telemetry)


@pytest.mark.parametrize("kind", COPTERS, ids=kind_name)
def test_a_stream_of_values_at_a_rate(kind):
    async def scenario(world, vehicle):
        async with vehicle.stream_battery(rate=2) as batteries:
            began = world.node.now()
            found = [await anext(batteries) for _ in range(10)]
        assert all(isinstance(battery, Battery) and battery.voltage > 10 for battery in found)
        assert 3.5 < world.node.now() - began < 7
        async for home in vehicle.stream_home():
            assert isinstance(home, HomePosition)
            break

    fly(kind, scenario, prepare=reduce_telemetry)


@pytest.mark.flight
def test_states_are_streamed_when_they_change_and_print_their_names():
    async def scenario(world, vehicle):
        async def collect(stream, count):
            return [await anext(stream) for _ in range(count)]

        reading = asyncio.gather(
            collect(vehicle.stream_armed(), 3),
            collect(vehicle.stream_in_air(), 2),
            collect(vehicle.stream_mode(), 2),
            collect(vehicle.stream_landed_state(), 2),
        )
        await asyncio.sleep(3)
        await vehicle.arm()
        await vehicle.takeoff(5)
        await vehicle.land()
        armed, in_air, modes, landed = await asyncio.wait_for(reading, 30)
        assert armed == [False, True, False]
        assert in_air == [False, True]
        assert modes[1] == "GUIDED"
        assert str(landed[0]) == f"{landed[0]}" == "ON_GROUND"

    fly(COPTERS[0], scenario)


def test_another_message_is_requested_if_the_first_one_is_refused():
    async def scenario(peer):
        handler = peer.node.commands.server.handler_of(common.MavCmd.SET_MESSAGE_INTERVAL)

        def refuse_attitude(request):
            handler(request)
            return RESULT.DENIED if int(request.command.param1) == ATTITUDE else RESULT.ACCEPTED

        peer.node.commands.server.support(common.MavCmd.SET_MESSAGE_INTERVAL, refuse_attitude)
        stream = peer.vehicle.stream_attitude(rate=5)
        reading = asyncio.create_task(anext(stream))
        await asyncio.sleep(8)
        peer.send(common.AttitudeQuaternion(q1=1.0))
        assert (await asyncio.wait_for(reading, 2)).yaw == 0
        assert [number for number, _ in peer.requested_rates][:2] == [ATTITUDE, QUATERNION]
        stream.close()

    with_peer(scenario)


def test_what_arrives_is_not_requested():
    async def scenario(peer):
        peer.send(common.AttitudeQuaternion(q1=1.0))
        await asyncio.sleep(0.2)
        stream = peer.vehicle.stream_attitude()
        reading = asyncio.create_task(anext(stream))
        for _ in range(8):
            await asyncio.sleep(0.5)
            peer.send(common.AttitudeQuaternion(q1=1.0))
        assert (await reading).roll == 0
        assert peer.requested_rates == []
        stream.close()

    with_peer(scenario)


def test_a_refused_value_and_one_that_never_comes():
    async def scenario(peer):
        with pytest.raises(MessageTimeout, match=r"waiting for rc of 1/1 failed: not received in 8 s"):
            await peer.vehicle.wait_for_telemetry("rc", timeout=8)
        peer.answer = RESULT.DENIED
        with pytest.raises(CommandDenied, match="streaming ATTITUDE at 4 Hz from"):
            await peer.vehicle.wait_for_telemetry("attitude")
        with pytest.raises(InvalidArgumentError, match="no telemetry 'speed'"):
            await peer.vehicle.wait_for_telemetry("speed")

    with_peer(scenario)
