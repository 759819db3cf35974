from __future__ import annotations

import asyncio
from math import inf

import pytest

from mavstack.dialects import common
from mavstack.errors import LinkURLError, MavstackError
from mavstack.links import BytesReceived, ChannelOpened, MemoryNetwork
from mavstack.msp import Direction, Frame
from mavstack.node import Node
from mavstack.node.pacing import MAX_BULK_BURST
from mavstack.services.log.entry import CHUNK
from mavstack.sim import Runner, Simulation, run_virtually
from mavstack.sim.runner import BULK_RATE, EVENTS_PER_TURN
from mavstack.sim.scenarios import arm, run_until


async def both(simulation: Simulation, work, *, speed: float = 1.0, **options):
    network = MemoryNetwork()
    async with Runner(simulation, speed=speed) as runner:
        await runner.connect(network.link(), simulation.vehicles)
        runner.start()
        async with Node(network.link(), **options) as ground:
            return await work(ground, runner)


def test_a_command_is_answered_at_once():
    simulation = Simulation()
    simulation.add()

    async def work(ground, _):
        vehicle = await ground.wait_for_autopilot()
        asked = ground.now()
        await vehicle.command(common.MavCmd.DO_SET_ROI_NONE)
        return ground.now() - asked

    assert run_virtually(both(simulation, work)) < 0.03


@pytest.mark.flight
def test_time_runs_at_the_given_speed():
    for speed, seconds in ((1, 10), (4, 40), (0.5, 5)):
        simulation = Simulation()
        simulation.add()

        async def work(_ground, _runner):
            await asyncio.sleep(10)

        began = simulation.now
        run_virtually(both(simulation, work, speed=speed))
        assert simulation.now - began == pytest.approx(seconds, abs=0.1)


@pytest.mark.flight
def test_a_log_is_sent_no_faster_than_peers_can_read_whatever_the_speed():
    simulation = Simulation()
    vehicle = simulation.add("rover")
    arm(simulation, vehicle)
    run_until(simulation, lambda: vehicle.storage.logs.logs()[0].size > 120_000)
    vehicle.autopilot.disarm("enough")

    async def work(ground, runner):
        peer, seconds = await ground.wait_for_autopilot(), []
        for runner.speed in (1.0, 5.0):
            began = ground.now()
            await peer.logs.download(1)
            seconds.append(ground.now() - began)
        return seconds

    fewest = (120_000 / CHUNK - MAX_BULK_BURST) / BULK_RATE
    for seconds in run_virtually(both(simulation, work)):
        assert fewest < seconds < 2.5 * fewest


@pytest.mark.flight
def test_a_speed_may_change_while_it_runs():
    simulation = Simulation()
    simulation.add()

    async def work(_ground, runner):
        await asyncio.sleep(5)
        runner.speed = 4.0
        await asyncio.sleep(5)

    began = simulation.now
    run_virtually(both(simulation, work))
    assert simulation.now - began == pytest.approx(25, abs=0.1)


@pytest.mark.flight
def test_as_fast_as_it_can():
    simulation = Simulation()
    simulation.add()
    began = simulation.now
    asyncio.run(Runner(simulation, speed=inf).run(30))
    assert simulation.now - began == pytest.approx(30, abs=0.2)


def test_a_slow_machine_loses_time_and_reports_it():
    simulation = Simulation()
    simulation.add()

    async def slow(_ground, runner):
        loop = asyncio.get_running_loop()
        await asyncio.sleep(1)
        loop._jumping.now += 60  # as after the machine slept
        await asyncio.sleep(1)
        return runner.lag

    began = simulation.now
    lag = run_virtually(both(simulation, slow))
    assert lag == pytest.approx(59.5, abs=0.6)
    assert simulation.now - began < 4


@pytest.mark.parametrize("speed", [0, -1, float("nan")])
def test_speeds_that_make_no_sense(speed):
    with pytest.raises(MavstackError, match="speed"):
        Runner(Simulation(), speed=speed)


def test_many_vehicles_on_one_link():
    simulation = Simulation()
    for _ in range(5):
        simulation.add()

    async def work(ground, _):
        remotes = [await ground.wait_for_autopilot(system) for system in range(1, 6)]
        await asyncio.sleep(3)
        await remotes[2].command(common.MavCmd.COMPONENT_ARM_DISARM, 1)
        values = await asyncio.gather(*(remote.params.get("SYSID_THISMAV") for remote in remotes))
        return [int(value.value) for value in values]

    assert run_virtually(both(simulation, work)) == [1, 2, 3, 4, 5]
    assert [vehicle.autopilot.armed for vehicle in simulation.vehicles] == [False, False, True, False, False]


def test_a_broadcast_reaches_all():
    simulation = Simulation()
    for _ in range(3):
        simulation.add()

    async def work(ground, _):
        for system in (1, 2, 3):
            await ground.wait_for_autopilot(system)
        await asyncio.sleep(3)
        ground.send(common.CommandLong(command=common.MavCmd.COMPONENT_ARM_DISARM, param1=1))
        await asyncio.sleep(0.1)

    run_virtually(both(simulation, work))
    assert all(vehicle.autopilot.armed for vehicle in simulation.vehicles)


def test_a_peer_that_comes_late_and_goes():
    simulation = Simulation()
    vehicle = simulation.add()
    network = MemoryNetwork()

    async def work():
        async with Runner(simulation) as runner:
            await runner.connect(network.link(), simulation.vehicles)
            runner.start()
            for _ in range(2):
                async with Node(network.link()) as ground:
                    await ground.wait_for_autopilot()
                    assert len(vehicle.ports) == 1
                await asyncio.sleep(0.1)
                assert not vehicle.ports

    run_virtually(work())


def test_it_speaks_over_two_links_at_once():
    simulation = Simulation()
    vehicle = simulation.add()
    first, second = MemoryNetwork(), MemoryNetwork()

    async def work():
        async with Runner(simulation) as runner:
            for network in (first, second):
                await runner.connect(network.link(), simulation.vehicles)
            runner.start()
            async with Node(first.link(), system=254) as one, Node(second.link(), system=253) as two:
                await (await one.wait_for_autopilot()).command(common.MavCmd.DO_SET_ROI_NONE)
                await (await two.wait_for_autopilot()).command(common.MavCmd.DO_SET_ROI_NONE)
                assert len(vehicle.ports) == 2

    run_virtually(work())


@pytest.mark.parametrize("speed", [1.0, inf])
def test_a_time_that_is_no_whole_number_of_steps_ends_too(speed):
    simulation = Simulation()
    simulation.add()
    began = simulation.now
    run_virtually(Runner(simulation, speed=speed).run(0.05))
    assert simulation.now - began == pytest.approx(0.06)


def test_a_flood_of_packets_leaves_turns_to_other_tasks(monkeypatch):
    simulation = Simulation()
    simulation.add()
    turn, turns_of_packets = 0, []

    async def work() -> None:
        nonlocal turn
        network = MemoryNetwork()
        async with Runner(simulation) as runner, network.link() as flooder:
            await runner.connect(network.link(), simulation.vehicles)
            await asyncio.sleep(0.1)
            (channel,) = flooder.channels
            with monkeypatch.context() as patch:
                patch.setattr(runner, "_take", lambda *_: turns_of_packets.append(turn))
                for _ in range(20 * EVENTS_PER_TURN):
                    channel.write(b"no packet")
                for turn in range(100):  # noqa: B007 (read by the function above)
                    await asyncio.sleep(0)

    run_virtually(work())
    assert len(turns_of_packets) == 20 * EVENTS_PER_TURN
    assert max(map(turns_of_packets.count, set(turns_of_packets))) <= EVENTS_PER_TURN


def test_a_link_carries_the_protocol_of_its_vehicles():
    simulation = Simulation()
    simulation.add()
    first, second = (simulation.add_flight_controller(firmware) for firmware in ("betaflight", "inav"))

    async def connect(url, vehicles):
        async with Runner(simulation) as runner:
            await runner.connect(url, vehicles)

    for url, vehicles in (
        ("udpout://127.0.0.1:9", [first]),
        ("msp+udpout://127.0.0.1:9", [first, second]),
        ("msp+udpout://127.0.0.1:9", simulation.vehicles),
    ):
        with pytest.raises(LinkURLError):
            asyncio.run(connect(url, vehicles))
    asyncio.run(connect("msp+udpout://127.0.0.1:9", [first]))


def test_clients_of_a_flight_controller_are_answered_at_once():
    simulation, network = Simulation(), MemoryNetwork()
    controller = simulation.add_flight_controller("betaflight")

    async def work():
        async with Runner(simulation) as runner, network.link() as client:
            await runner.connect(network.link(), [controller])
            runner.start()
            began = asyncio.get_running_loop().time()
            async for event in client:
                if isinstance(event, ChannelOpened):
                    event.channel.write(Frame(2).encode())
                elif isinstance(event, BytesReceived):
                    return event.data, asyncio.get_running_loop().time() - began
        raise AssertionError

    data, seconds = run_virtually(work())
    assert data == Frame(2, b"BTFL", Direction.RESPONSE).encode()
    assert seconds < 0.03
