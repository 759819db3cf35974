"""Streams: typed, at the rate asked for, and never silently denied."""

from __future__ import annotations

import asyncio
import gc

import pytest

from mavstack.dialects import common
from mavstack.errors import CommandDenied, LocalProtocolError
from mavstack.sim.vehicle_types import VehicleType
from tests.sim.running import reduce_telemetry
from tests.vehicle.telemetry.harness import PX4, RESULT, with_peer
from tests.vehicle.world import ARDUPILOT, fly
from tests.vehicle.world import PX4 as SIMULATED_PX4

COPTERS = [(VehicleType.COPTER, ARDUPILOT), (VehicleType.COPTER, SIMULATED_PX4)]
ATTITUDE, ODOMETRY = 30, 331


async def sending(peer, message, interval=0.1):
    while True:
        peer.send(message)
        await asyncio.sleep(interval)


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("kind", COPTERS, ids=lambda kind: kind[1])
@pytest.mark.parametrize("rate", [2, 10])
def test_the_requested_rate_is_the_received_rate(kind, rate):
    async def scenario(world, vehicle):
        async with vehicle.stream(common.HighresImu, rate=rate) as messages:
            await asyncio.sleep(1)
            messages.drain()
            await asyncio.sleep(10)
            assert len(messages.drain()) == pytest.approx(10 * rate, abs=1)
        await asyncio.sleep(1)
        before = vehicle.age(common.HighresImu)
        await asyncio.sleep(5)
        assert vehicle.age(common.HighresImu) == pytest.approx(before + 5), "no stream requests it"

    fly(kind, scenario, prepare=reduce_telemetry)


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("kind", COPTERS, ids=lambda kind: kind[1])
def test_a_missing_message_is_requested_for_good(kind):
    async def scenario(world, vehicle):
        async for message in vehicle.stream(common.HighresImu):
            assert isinstance(message, common.HighresImu)
            break
        await asyncio.sleep(10)
        assert vehicle.age(common.HighresImu) < 0.3

    fly(kind, scenario, prepare=reduce_telemetry)


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("kind", COPTERS, ids=lambda kind: kind[1])
def test_several_messages_in_the_order_of_arrival(kind):
    async def scenario(world, vehicle):
        seen = set()
        async with vehicle.stream(common.Attitude, common.GlobalPositionInt) as messages:
            async for message in messages:
                match message:
                    case common.Attitude() | common.GlobalPositionInt():
                        seen.add(type(message))
                if len(seen) == 2:
                    break
        assert vehicle.telemetry.rates.held == {}, "both come by themselves"

    fly(kind, scenario)


def test_a_message_that_arrives_by_itself_is_not_requested():
    async def scenario(peer):
        task = asyncio.create_task(sending(peer, common.Attitude()))
        async with peer.vehicle.stream(common.Attitude) as messages:
            await asyncio.sleep(5)
            assert len(messages.drain()) > 40
        assert peer.requested_rates == []
        task.cancel()

    with_peer(scenario)


def test_the_rate_is_requested_at_first_use_and_released_at_the_end():
    async def scenario(peer):
        stream = peer.vehicle.stream(common.Attitude, rate=5)
        await asyncio.sleep(3)
        assert peer.requested_rates == []
        async with stream:
            await asyncio.sleep(1)
            assert peer.requested_rates == [(ATTITUDE, 200_000)]
        await asyncio.sleep(1)
        assert peer.requested_rates == [(ATTITUDE, 200_000), (ATTITUDE, 0)]
        stream.close()
        assert [message async for message in stream] == []

    with_peer(scenario)


def test_the_fastest_of_several_streams_counts():
    async def scenario(peer):
        async with peer.vehicle.stream(common.Attitude, rate=5):
            await asyncio.sleep(1)
            async with peer.vehicle.stream(common.Attitude, rate=20):
                await asyncio.sleep(1)
            async with peer.vehicle.stream(common.Attitude, rate=2):
                await asyncio.sleep(1)
        await asyncio.sleep(1)
        assert [interval for _, interval in peer.requested_rates] == [200_000, 50_000, 200_000, 0]

    with_peer(scenario)


@pytest.mark.parametrize("rate", [None, 5.0])
def test_a_refusal_is_raised_if_nothing_arrives(rate):
    async def scenario(peer):
        peer.answer = RESULT.UNSUPPORTED
        with pytest.raises(CommandDenied, match=r"ODOMETRY at \d Hz from 1/1 failed: UNSUPPORTED"):
            await anext(peer.vehicle.stream(common.Odometry, rate=rate))
        assert not peer.vehicle.connection._host.packet_dispatch._open

    with_peer(scenario, autopilot=PX4)


@pytest.mark.parametrize("rate", [None, 5.0])
@pytest.mark.parametrize("answer", [RESULT.DENIED, RESULT.FAILED])
def test_a_refusal_is_ignored_if_messages_arrive(rate, answer):
    async def scenario(peer):
        peer.answer = answer
        task = asyncio.create_task(sending(peer, common.Odometry(), 3.0))
        async with peer.vehicle.stream(common.Odometry, rate=rate) as messages:
            for _ in range(5):
                await anext(messages)
        task.cancel()

    with_peer(scenario)


def test_one_of_several_messages_may_be_refused():
    async def scenario(peer):
        peer.answer = RESULT.UNSUPPORTED
        task = asyncio.create_task(sending(peer, common.Attitude()))
        async with peer.vehicle.stream(common.Attitude, common.Odometry) as messages:
            await asyncio.sleep(10)
            assert isinstance(await anext(messages), common.Attitude)
            assert list(messages.denied) == [common.Odometry]
        task.cancel()

    with_peer(scenario, autopilot=PX4)


def test_messages_that_are_not_periodic_are_not_requested():
    async def scenario(peer):
        peer.answer = RESULT.UNSUPPORTED
        asyncio.get_running_loop().call_later(60, peer.send, common.Statustext(text="at last"))
        message = await anext(peer.vehicle.stream(common.Statustext))
        assert message.text == "at last"
        assert peer.requested_rates == []

    with_peer(scenario)


def test_an_unanswered_request_is_repeated():
    async def scenario(peer):
        peer.node.commands.server.support(common.MavCmd.SET_MESSAGE_INTERVAL, lambda request: None)
        stream = peer.vehicle.stream(common.Odometry, rate=5)
        waiting = asyncio.create_task(anext(stream))
        await asyncio.sleep(100)
        assert not waiting.done(), "a silent vehicle has not refused"
        stream.close()
        with pytest.raises(StopAsyncIteration):
            await waiting

    with_peer(scenario)


@pytest.mark.flight
def test_a_stream_without_references_ends():
    async def scenario(peer):
        task = asyncio.create_task(sending(peer, common.Attitude()))
        async for _ in peer.vehicle.stream(common.Attitude, rate=5):
            break
        gc.collect()
        await asyncio.sleep(1)
        assert not peer.vehicle.connection._host.packet_dispatch._open
        assert peer.requested_rates[-1] == (ATTITUDE, 0)
        peer.vehicle.stream(common.Attitude)  # never used
        gc.collect()
        assert not peer.vehicle.connection._host.packet_dispatch._open
        task.cancel()

    with_peer(scenario)


def test_a_slow_reader_loses_the_oldest():
    async def scenario(peer):
        async with peer.vehicle.stream(common.SystemTime, queue=3) as messages:
            for number in range(10):
                peer.send(common.SystemTime(time_boot_ms=number))
            await asyncio.sleep(1)
            assert [message.time_boot_ms for message in messages.drain()] == [7, 8, 9]
            assert messages.dropped == 7

    with_peer(scenario)


def test_it_ends_with_the_connection():
    async def scenario(peer):
        async def read():
            return [message async for message in peer.vehicle.stream(common.Attitude, rate=5)]

        reading = asyncio.create_task(read())
        await asyncio.sleep(1)
        peer.send(common.Attitude(roll=1))
        await asyncio.sleep(0.1)
        await peer.vehicle.connection.close()
        assert await reading == [common.Attitude(roll=1)]

    with_peer(scenario)


@pytest.mark.parametrize("rate", [0, -1, float("nan"), float("inf")])
def test_an_invalid_rate_is_misuse(rate):
    async def scenario(peer):
        with pytest.raises(LocalProtocolError, match="rate must be positive and finite"):
            await anext(peer.vehicle.stream(common.Attitude, rate=rate))
        with pytest.raises(LocalProtocolError, match="name the message classes"):
            peer.vehicle.stream(rate=5)

    with_peer(scenario)


@pytest.mark.parametrize("kind", COPTERS, ids=lambda kind: kind[1])
def test_a_message_that_is_never_streamed_is_requested(kind):
    async def scenario(world, vehicle):
        began = world.node.now()
        version = await vehicle.wait_for_message(common.AutopilotVersion, timeout=10)
        assert version.flight_sw_version
        async with vehicle.stream(common.ProtocolVersion, common.AutopilotVersion) as messages:
            seen = {type(await asyncio.wait_for(anext(messages), 3)) for _ in range(2)}
        assert seen == {common.ProtocolVersion, common.AutopilotVersion}
        assert world.node.now() - began < 2

    fly(kind, scenario, prepare=reduce_telemetry)


def test_a_refused_request_for_an_answer_raises_the_refusal():
    async def scenario(peer):
        with pytest.raises(CommandDenied, match=r"requesting AUTOPILOT_VERSION from .*UNSUPPORTED"):
            await peer.vehicle.wait_for_message(common.AutopilotVersion, timeout=10)

    with_peer(scenario)
