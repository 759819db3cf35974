"""Closing a node: quiet while packets arrive, and complete if a step of it fails."""

from __future__ import annotations

import asyncio
import socket
import threading
import time

import pytest

import mavstack
from mavstack.dialects import common
from mavstack.errors import RemoteCancelled
from mavstack.links import MemoryNetwork
from mavstack.node import Node
from mavstack.services.command import Command
from mavstack.sim.background import BackgroundSimulator
from mavstack.sim.virtual import run_virtually
from mavstack.wire import Encoder
from tests.node.vehicle import VehiclePair

VEHICLES = 5


class Flood:
    """Telemetry of several vehicles to one UDP port, faster than one wake-up of the event loop reads it."""

    def __init__(self) -> None:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as chosen:
            chosen.bind(("127.0.0.1", 0))
            self.port = chosen.getsockname()[1]
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._send)

    def __enter__(self):
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ended.set()
        self._thread.join()

    def _send(self) -> None:
        heartbeat = common.Heartbeat(type=common.MavType.QUADROTOR, autopilot=common.MavAutopilot.PX4)
        encoders = [Encoder(1 + number, 1) for number in range(VEHICLES)]
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            count = 0
            while not self._ended.wait(0.001 if count % 10 == 0 else 0):
                message = heartbeat if count % 20 == 0 else common.Attitude(time_boot_ms=count)
                for encoder in encoders:
                    sender.sendto(encoder.encode(message), ("127.0.0.1", self.port))
                count += 1


def record_reports() -> list[dict]:
    reports: list[dict] = []
    asyncio.get_running_loop().set_exception_handler(lambda _, context: reports.append(context))
    return reports


async def assert_no_task_is_left() -> None:
    for _ in range(5):
        await asyncio.sleep(0)
    assert asyncio.all_tasks() == {asyncio.current_task()}


async def test_closing_is_quiet_while_packets_arrive():
    reports = record_reports()
    with Flood() as flood:
        for _ in range(12):
            async with mavstack.connect(f"udpin://127.0.0.1:{flood.port}") as connection:
                await connection.wait_for_vehicles(VEHICLES, timeout=20)
                stream = connection.stream(common.Attitude)
                time.sleep(0.02)  # noqa: ASYNC251 (datagrams queue up while the event loop is busy)
                await asyncio.sleep(0)
            async for _ in stream:
                pass  # the iteration ends
    assert reports == []
    await assert_no_task_is_left()


@pytest.mark.nightly
async def test_closing_is_quiet_beside_five_fast_copters():
    reports = record_reports()
    with BackgroundSimulator("copter", "ardupilot", count=VEHICLES, speed=20.0) as simulator:
        for cycle in range(20):
            async with mavstack.connect(simulator.url) as connection:
                group = await connection.wait_for_vehicles(VEHICLES, timeout=20)
                for vehicle in group:
                    vehicle.stream(common.Attitude, rate=50)
                await asyncio.sleep(0.02 * cycle)
    assert reports == []
    await assert_no_task_is_left()


async def test_a_simulator_in_a_thread_closes_inside_an_event_loop():
    with BackgroundSimulator("copter", "ardupilot") as simulator:
        async with mavstack.connect(simulator.url) as connection:
            await connection.wait_for_vehicle(timeout=20)


async def test_a_link_that_fails_to_close_keeps_nothing_open(monkeypatch):
    networks = [MemoryNetwork() for _ in range(3)]
    links = [network.link() for network in networks]
    node = await Node(*links).open()
    messages, events = node.stream(common.Heartbeat), node.events()

    async def fail() -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(links[1], "close", fail)
    with pytest.raises(OSError, match="No space left"):
        await node.close()
    assert [link.closed for link in links] == [True, False, True]
    assert [item async for item in messages] == []
    async for _ in events:
        pass
    await node.close()
    await assert_no_task_is_left()


async def test_a_cancelled_close_is_complete(monkeypatch):
    links = [MemoryNetwork().link() for _ in range(3)]
    node = await Node(*links).open()

    async def wait() -> None:
        await asyncio.sleep(60)

    monkeypatch.setattr(links[0], "close", wait)
    with pytest.raises(TimeoutError):
        async with asyncio.timeout(0.05):
            await node.close()
    assert [link.closed for link in links] == [False, True, True]
    await assert_no_task_is_left()


async def test_a_handler_may_close_its_own_node():
    network = MemoryNetwork()
    reports = record_reports()
    ended = []
    async with Node(network.link()) as ground:
        vehicle = await Node(network.link(), system=1, component=1).open()

        @vehicle.on_command(common.MavCmd.PREFLIGHT_REBOOT_SHUTDOWN)
        async def shut_down(_):
            await vehicle.close()
            ended.append(vehicle.is_open)
            return common.MavResult.ACCEPTED

        command = Command(common.MavCmd.PREFLIGHT_REBOOT_SHUTDOWN)
        sent = asyncio.ensure_future(ground.component(1).command(command.command, timeout=0.5))
        await asyncio.sleep(0.2)
        sent.cancel()
    assert ended == [False]
    assert reports == []


async def test_no_timer_runs_and_nothing_is_sent_after_closing():
    network = MemoryNetwork()
    async with Node(network.link()) as other:
        node = await Node(network.link(), system=1, component=1).open()
        command = asyncio.ensure_future(node.component(7).command(common.MavCmd.DO_SET_SERVO))
        await asyncio.sleep(0.05)
        await node.close()
        async with other.packets() as packets:
            command.cancel()
            await asyncio.sleep(0.05)
            node.wake(node._heartbeat)
            await asyncio.sleep(1.2)
            assert [packet for packet in packets.drain() if packet.system == 1] == []


def test_a_call_of_several_requests_is_cancelled_between_two_of_them() -> None:
    """The node closes in the turn of the event loop in which an answer ends the first request."""

    async def main() -> None:
        async with VehiclePair(autopilot=common.MavAutopilot.ARDUPILOTMEGA) as pair:
            closing = []
            pair.ground.add_packet_listener(
                common.AutopilotVersion, lambda _: closing.append(asyncio.create_task(pair.ground.close()))
            )
            with pytest.raises(RemoteCancelled, match="closed"):
                await pair.remote.params.download(timeout=30.0)
            await closing[0]

    run_virtually(main())
