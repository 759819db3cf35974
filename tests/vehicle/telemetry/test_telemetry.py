"""The latest messages, by sender, with their times."""

from __future__ import annotations

import asyncio
from math import pi

import pytest

from mavstack.dialects import common
from mavstack.errors import CommandDenied, MavstackError, MessageTimeout, RemoteCancelled
from tests.vehicle.telemetry.harness import RESULT, with_peer, with_telemetry

CAMERA = common.MavComponent.CAMERA


def test_the_latest_message_of_a_class_and_its_age():
    async def scenario(harness):
        vehicle = harness.vehicle
        assert vehicle.latest(common.Attitude) is None
        assert vehicle.age(common.Attitude) is None
        harness.receive(common.Attitude(roll=1), common.Attitude(roll=2))
        await asyncio.sleep(2.5)
        message = vehicle.latest(common.Attitude)
        assert isinstance(message, common.Attitude)
        assert message.roll == 2
        assert vehicle.age(common.Attitude) == pytest.approx(2.5)

    with_telemetry(scenario)


def test_a_reader_returns_the_latest_packet_of_the_autopilot():
    async def scenario(harness):
        read = harness.telemetry.reader(common.Attitude)
        assert read() is None
        harness.receive(common.Attitude(roll=1))
        begun = harness.telemetry.now()
        await asyncio.sleep(2.5)
        packet, received_at = read()
        assert (packet.message.roll, received_at) == (1, pytest.approx(begun))
        harness.receive(common.Attitude(roll=2), component=CAMERA)
        assert read()[0] is packet
        harness.receive(common.Attitude(roll=3))
        assert read()[0].message.roll == 3

    with_telemetry(scenario)


def test_a_component_of_the_vehicle_is_not_mistaken_for_its_autopilot():
    async def scenario(harness):
        vehicle = harness.vehicle
        harness.receive(common.Attitude(yaw=pi / 2), component=CAMERA)
        assert vehicle.latest(common.Attitude) is None
        assert vehicle.attitude is None
        harness.receive(common.Attitude(yaw=0.0))
        harness.receive(common.Attitude(yaw=pi / 2), component=CAMERA)
        assert vehicle.attitude.yaw == 0
        assert vehicle.latest(common.Attitude, CAMERA).yaw == pytest.approx(pi / 2)
        assert vehicle.age(common.Attitude, CAMERA) == 0

    with_telemetry(scenario)


def test_messages_of_another_vehicle_do_not_count():
    async def scenario(harness):
        harness.receive(common.Attitude(yaw=1), system=2)
        assert harness.vehicle.attitude is None

    with_telemetry(scenario)


def test_a_limited_number_of_messages_is_kept_the_newest_ones():
    kinds = [
        common.Attitude,
        common.GpsRawInt,
        common.ScaledImu,
        common.RawImu,
        common.ScaledPressure,
        common.SysStatus,
        common.VfrHud,
        common.ServoOutputRaw,
        common.MissionCurrent,
    ]

    async def scenario(harness):
        harness.receive(common.SystemTime())
        for component in range(2, 252):
            await asyncio.sleep(0.001)
            harness.receive(*(kind() for kind in kinds), component=component)
        assert 1000 < harness.node._host.intake.stored(1) <= 2048
        assert harness.vehicle.latest(common.Attitude, 251) is not None
        assert harness.vehicle.latest(common.SystemTime) is None

    with_telemetry(scenario)


def test_a_listener_is_called_with_each_message_until_closed():
    async def scenario(harness):
        received_status, from_camera = [], []
        listening = harness.vehicle.add_listener(common.Attitude, received_status.append)
        harness.vehicle.add_listener(common.Attitude, from_camera.append, component=CAMERA)
        harness.receive(common.Attitude(roll=1), common.Heartbeat())
        harness.receive(common.Attitude(roll=2), component=CAMERA)
        assert received_status == [common.Attitude(roll=1)]
        assert from_camera == [common.Attitude(roll=2)]
        listening.close()
        harness.receive(common.Attitude(roll=3))
        assert len(received_status) == 1

    with_telemetry(scenario)


def test_a_listener_sees_the_latest_value():
    async def scenario(harness):
        seen = []
        harness.vehicle.add_listener(common.Attitude, lambda _: seen.append(harness.vehicle.attitude.yaw))
        harness.receive(common.Attitude(yaw=pi))
        assert seen == [pytest.approx(180)]

    with_telemetry(scenario)


def test_a_failing_listener_is_reported_and_stops_nothing():
    async def scenario(harness):
        received, received_status = [], []
        asyncio.get_running_loop().set_exception_handler(lambda _, context: received.append(context))
        harness.vehicle.add_listener(common.Attitude, lambda message: 1 / 0)
        harness.vehicle.add_listener(common.Attitude, received_status.append)
        harness.receive(common.Attitude())
        assert len(received_status) == 1
        assert "ATTITUDE" in received[0]["message"]
        assert isinstance(received[0]["exception"], ZeroDivisionError)

    with_telemetry(scenario)


def test_values_stay_after_the_connection_was_closed():
    async def scenario(harness):
        harness.heartbeat()
        harness.receive(common.ExtendedSysState(landed_state=2), common.Attitude())
        await harness.node.close()
        vehicle = harness.vehicle
        assert vehicle.attitude is not None
        assert vehicle.in_air is True
        assert vehicle.health.ready is None
        assert vehicle.status_texts == []
        with pytest.raises(MavstackError, match="not open"):
            await vehicle.wait_for_message(common.Attitude, timeout=1)

    with_telemetry(scenario)


def test_closed_telemetry_receives_nothing():
    async def scenario(harness):
        await harness.telemetry.close()
        harness.receive(common.Attitude(), common.Statustext(text="late"))
        assert harness.vehicle.attitude is None
        assert harness.vehicle.status_texts == []

    with_telemetry(scenario)


# The next message


def test_waiting_for_a_message_returns_a_new_one():
    async def scenario(peer):
        peer.send(common.Attitude(roll=1))
        await asyncio.sleep(0.1)
        asyncio.get_running_loop().call_later(1, peer.send, common.Attitude(roll=2))
        message = await peer.vehicle.wait_for_message(common.Attitude)
        assert message.roll == 2
        assert peer.requested_rates == [], "it comes by itself"

    with_peer(scenario)


def test_waiting_for_a_message_that_does_not_arrive():
    async def scenario(peer):
        with pytest.raises(MessageTimeout, match="waiting for ATTITUDE from 1/1 failed: none arrived in 3 s"):
            await peer.vehicle.wait_for_message(common.Attitude, timeout=3)
        assert peer.requested_rates == [(30, 250_000)]

    with_peer(scenario)


def test_waiting_for_a_message_that_the_vehicle_lacks():
    async def scenario(peer):
        peer.answer = RESULT.UNSUPPORTED
        with pytest.raises(CommandDenied, match="UNSUPPORTED"):
            await peer.vehicle.wait_for_message(common.Odometry, timeout=30)

    with_peer(scenario)


def test_waiting_for_a_message_when_the_connection_closes():
    async def scenario(peer):
        waiting = asyncio.create_task(peer.vehicle.wait_for_message(common.Attitude))
        await asyncio.sleep(0.5)
        await peer.vehicle.connection.close()
        with pytest.raises(
            RemoteCancelled, match="waiting for ATTITUDE from 1/1 failed: the connection was closed"
        ):
            await waiting

    with_peer(scenario)


def test_a_cancelled_wait_leaves_nothing_registered():
    async def scenario(peer):
        waiting = asyncio.create_task(peer.vehicle.wait_for_message(common.Attitude))
        await asyncio.sleep(0.5)
        waiting.cancel()
        await asyncio.gather(waiting, return_exceptions=True)
        assert not peer.vehicle.connection._host.packet_dispatch._open
        await asyncio.sleep(10)
        assert peer.requested_rates == []

    with_peer(scenario)
