"""Nodes over memory links in virtual time: discovery, commands, subscriptions, cancellation, closing."""

from __future__ import annotations

import asyncio
from typing import Self

import pytest

from mavstack.dialects import ardupilotmega, common
from mavstack.errors import (
    CommandDenied,
    CommandTimeout,
    InvalidStateError,
    MavstackError,
    RemoteCancelled,
    RemoteTimeout,
)
from mavstack.links import MemoryNetwork
from mavstack.node import Node
from mavstack.services.heartbeat import ComponentFound, ComponentLost
from mavstack.services.mission import MissionItem, MissionServer
from mavstack.services.statustext import StatusText
from mavstack.sim.virtual import run_virtually

QUADROTOR, PX4 = common.MavType.QUADROTOR, common.MavAutopilot.PX4


class NodePair:
    """A ground station and a vehicle on one memory network."""

    def __init__(self) -> None:
        network = MemoryNetwork()
        self.ground = Node(network.link())
        self.vehicle = Node(network.link(), system=1, component=1, type=QUADROTOR, autopilot=PX4)

    async def __aenter__(self) -> Self:
        await self.ground.open()
        await self.vehicle.open()
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.vehicle.close()
        await self.ground.close()


def test_the_first_autopilot_is_found() -> None:
    async def work() -> None:
        async with NodePair() as pair:
            vehicle = await pair.ground.wait_for_autopilot()
            assert vehicle.address == (1, 1)
            assert vehicle.info is not None
            assert vehicle.info.type == QUADROTOR
            assert not pair.vehicle.components[255, 190].is_autopilot  # type: ignore[index]

    run_virtually(work())


def test_the_discovery_timeout_names_the_received_components() -> None:
    async def work() -> None:
        network = MemoryNetwork()
        async with Node(network.link()) as ground, Node(network.link(), system=9, component=100):
            with pytest.raises(RemoteTimeout, match=r"heard: 9/100") as caught:
                await ground.wait_for_autopilot(timeout=3)
            assert "memory://pair" in str(caught.value)

    run_virtually(work())


def test_plain_and_async_command_handlers() -> None:
    async def work() -> list[tuple[int, int]]:
        async with NodePair() as pair:
            progress: list[tuple[int, int]] = []

            @pair.vehicle.on_command(common.MavCmd.DO_SET_SERVO)
            def servo(request) -> common.MavResult:
                good = request.command.param2 == 1500
                return common.MavResult.ACCEPTED if good else common.MavResult.DENIED

            @pair.vehicle.on_command(common.MavCmd.DO_WINCH)
            async def winch(request) -> common.MavResult:
                for percent in (10, 60):
                    await asyncio.sleep(1)
                    pair.vehicle.commands.progress(request, percent)
                await asyncio.sleep(1)
                return common.MavResult.ACCEPTED

            vehicle = await pair.ground.wait_for_autopilot()
            await vehicle.command(common.MavCmd.DO_SET_SERVO, 5, 1500)
            with pytest.raises(CommandDenied, match="DO_SET_SERVO on 1/1 failed: DENIED"):
                await vehicle.command(common.MavCmd.DO_SET_SERVO, 5, 1)
            with pytest.raises(CommandDenied, match="UNSUPPORTED"):
                await vehicle.command(common.MavCmd.NAV_LAND)
            await vehicle.command(common.MavCmd.DO_WINCH, progress=lambda *now: progress.append(now))
            return progress

    assert {(10, 100), (60, 100)} <= set(run_virtually(work()))


def test_a_cancelled_task_cancels_the_command_on_the_vehicle() -> None:
    async def work() -> list[str]:
        ended = []
        async with NodePair() as pair:

            @pair.vehicle.on_command(common.MavCmd.DO_WINCH)
            async def winch(_request) -> common.MavResult:
                try:
                    await asyncio.sleep(100)
                except asyncio.CancelledError:
                    ended.append("winch stopped")
                    raise
                return common.MavResult.ACCEPTED

            vehicle = await pair.ground.wait_for_autopilot()
            with pytest.raises(TimeoutError):
                async with asyncio.timeout(5):
                    await vehicle.command(common.MavCmd.DO_WINCH)
            await asyncio.sleep(1)
            assert not vehicle._clients.command.busy
            assert not pair.vehicle.commands.server.running
        return ended

    assert run_virtually(work()) == ["winch stopped"]


def test_closing_the_node_ends_running_operations() -> None:
    async def work() -> None:
        async with NodePair() as pair:
            await pair.ground.wait_for_autopilot()
            silent = pair.ground.component(7)
            task = asyncio.ensure_future(silent.command(common.MavCmd.NAV_LAND))
            messages = pair.ground.stream(common.Heartbeat)
            await asyncio.sleep(0.5)
            await pair.ground.close()
            with pytest.raises(RemoteCancelled):
                await task
            assert all([isinstance(message, common.Heartbeat) async for message in messages])
            with pytest.raises(MavstackError, match="not open"):
                pair.ground.send(common.Heartbeat())

    run_virtually(work())


def test_the_timeout_error_has_the_number_of_attempts() -> None:
    async def work() -> None:
        async with NodePair() as pair:
            with pytest.raises(CommandTimeout, match=r"NAV_LAND on 7/1 failed after 8 attempts: no answer"):
                await pair.ground.component(7).command(common.MavCmd.NAV_LAND)
            with pytest.raises(TimeoutError):
                await pair.ground.component(7).command(common.MavCmd.NAV_LAND, timeout=0.5)

    run_virtually(work())


def test_a_slow_subscriber_loses_the_oldest_items_and_delays_no_other() -> None:
    async def work() -> None:
        async with NodePair() as pair:
            await pair.ground.wait_for_autopilot()
            slow = pair.ground.stream(common.Attitude, queue=10)
            quick = pair.ground.stream(common.Attitude, queue=1000)
            for number in range(100):
                pair.vehicle.send(common.Attitude(time_boot_ms=number))
            await asyncio.sleep(0.1)
            assert [message.time_boot_ms for message in slow.drain()] == list(range(90, 100))
            assert slow.dropped == 90
            assert len(quick.drain()) == 100

    run_virtually(work())


def test_packets_of_unknown_ids_are_delivered_raw() -> None:
    async def work() -> None:
        network = MemoryNetwork()
        async with Node(network.link(), dialect=common) as ground, Node(network.link(), system=3) as other:
            packets = ground.packets(system=3)
            await asyncio.sleep(0.01)
            other.send(ardupilotmega.Wind(speed=3))
            await asyncio.sleep(0.01)
            unknown = [packet for packet in packets.drain() if packet.message is None]
            assert [packet.message_id for packet in unknown] == [168]
            assert unknown[0].payload

    run_virtually(work())


def test_events_of_components() -> None:
    async def work() -> None:
        network = MemoryNetwork()
        async with Node(network.link()) as ground:
            events = ground.events(ComponentFound, ComponentLost)
            async with Node(network.link(), system=4, component=1):
                assert (await anext(events)).component.address == (4, 1)
            lost = await anext(events)
            assert isinstance(lost, ComponentLost)

    run_virtually(work())


def test_an_invalid_address_is_an_error() -> None:
    with pytest.raises(MavstackError, match="0/190"):
        Node(system=0)


def test_message_requests_and_rates() -> None:
    async def work() -> None:
        async with NodePair() as pair:
            started = pair.vehicle.now()
            pair.vehicle.publish(
                common.Attitude,
                lambda now: common.Attitude(time_boot_ms=int(1000 * (now - started))),
                interval=1,
            )
            pair.vehicle.publish(common.HomePosition, lambda _: common.HomePosition(latitude=7))
            vehicle = await pair.ground.wait_for_autopilot()
            assert (await vehicle.request_message(common.HomePosition)).latitude == 7
            with pytest.raises(CommandDenied):
                await vehicle.request_message(common.GimbalDeviceInformation)
            assert (await vehicle.get_message_interval(common.Attitude)).seconds == 1
            await vehicle.set_message_rate(common.Attitude, 50)
            async with vehicle.stream(common.Attitude) as attitudes:
                await asyncio.sleep(1.001)
                assert 49 <= len(attitudes.drain()) <= 52

    run_virtually(work())


def test_status_texts_ping_and_timesync() -> None:
    async def work() -> None:
        async with NodePair() as pair:
            vehicle = await pair.ground.wait_for_autopilot()
            async with pair.ground.events(StatusText) as texts:
                pair.vehicle.send_statustext("propellers are on, " * 10, common.MavSeverity.WARNING)
                messages = await anext(texts)
            assert messages.text == "propellers are on, " * 10
            assert (await vehicle.ping()).received == 4
            assert vehicle.clock.estimate is None
            await asyncio.sleep(1)
            assert abs(vehicle.clock.estimate.offset) < 0.01

    run_virtually(work())


def test_plans_are_uploaded_and_downloaded() -> None:
    async def work() -> None:
        async with NodePair() as pair:
            pair.vehicle.serve(MissionServer(pair.vehicle.address))
            vehicle = await pair.ground.wait_for_autopilot()
            items = [
                MissionItem(common.MavCmd.NAV_WAYPOINT, param5=47 + number / 1000, param6=8.5, param7=30)
                for number in range(20)
            ]
            steps: list[tuple[int, int]] = []
            await vehicle.mission.upload(items, progress=lambda *step: steps.append(step))
            assert list((await vehicle.mission.download()).items) == items
            assert steps[-1][0] <= steps[-1][1] == 20
            assert len(await vehicle.fence.download()) == 0
            await vehicle.mission.clear()
            assert len(await vehicle.mission.download()) == 0

    run_virtually(work())


def test_a_command_cancelled_before_its_handler_started() -> None:
    async def work() -> None:
        async with NodePair() as pair:

            @pair.vehicle.on_command(common.MavCmd.DO_WINCH)
            async def winch(_request) -> common.MavResult:
                await asyncio.sleep(1000)
                return common.MavResult.ACCEPTED

            vehicle = await pair.ground.wait_for_autopilot()
            async with vehicle.stream(common.CommandAck) as answers:
                vehicle.send(common.CommandLong(command=common.MavCmd.DO_WINCH))
                vehicle.send(common.CommandCancel(command=common.MavCmd.DO_WINCH))
                await asyncio.sleep(1)
                results = [answer.result for answer in answers.drain()]
            assert results == [common.MavResult.IN_PROGRESS, common.MavResult.CANCELLED]
            assert not pair.vehicle.commands.server.running

    run_virtually(work())


def test_listeners_get_messages_and_packets_until_they_close() -> None:
    async def work() -> None:
        async with NodePair() as pair:
            await pair.ground.wait_for_autopilot()
            messages, packets = [], []
            first = pair.ground.add_listener((common.Attitude, common.VfrHud), messages.append, system=1)
            second = pair.ground.add_packet_listener(common.Attitude, packets.append)
            pair.vehicle.send(common.Attitude(roll=1))
            pair.vehicle.send(common.VfrHud(airspeed=2))
            await asyncio.sleep(1)
            first.close()
            first.close()
            pair.vehicle.send(common.Attitude(roll=3))
            await asyncio.sleep(1)
            second.close()
            assert messages == [common.Attitude(roll=1), common.VfrHud(airspeed=2)]
            assert [packet.message.roll for packet in packets] == [1, 3]

    run_virtually(work())


def test_a_changed_heartbeat_is_sent_immediately() -> None:
    async def work() -> None:
        async with NodePair() as pair, pair.ground.stream(common.Heartbeat, system=1) as heartbeats:
            await anext(heartbeats)
            heartbeats.drain()
            pair.vehicle.set_heartbeat(base_mode=129, custom_mode=7)
            await asyncio.sleep(0.1)
            (heartbeat,) = heartbeats.drain()
            assert (heartbeat.base_mode, heartbeat.custom_mode) == (129, 7)
            assert heartbeat.system_status == common.MavState.ACTIVE

    run_virtually(work())


def test_the_state_of_a_channel_ends_with_the_channel() -> None:
    async def work() -> None:
        async with NodePair() as pair:
            await pair.ground.wait_for_autopilot()
            (channel,) = pair.ground.links[0].channels
            state = pair.ground.channel_state(channel)
            assert state is not None
            assert not state.trusted
            await pair.ground.close()
            assert pair.ground.channel_state(channel) is None

    run_virtually(work())


def test_closing_the_node_ends_a_wait_without_timeout() -> None:
    async def work() -> None:
        async with Node(MemoryNetwork().link()) as node:
            waiting = asyncio.ensure_future(node.wait_for_autopilot(timeout=None))
            await asyncio.sleep(1)
            await node.close()
            with pytest.raises(
                RemoteTimeout, match=r"waiting for an autopilot on .* failed: the node was closed"
            ):
                await waiting

    run_virtually(work())


def test_the_timeout_of_a_ping_is_that_of_the_whole_call() -> None:
    async def work() -> float:
        loop = asyncio.get_running_loop()
        async with NodePair() as pair:
            start = loop.time()
            with pytest.raises(RemoteTimeout):
                await pair.ground.component(9).ping(100, timeout=5)
            return loop.time() - start

    assert 4.9 < run_virtually(work()) < 5.5


def test_a_closed_node_raises_invalid_state_error() -> None:
    with pytest.raises(InvalidStateError, match="not open"):
        Node().send(common.Heartbeat())
