"""Misbehaving peers and links of a runner: no vehicle stops, no memory grows, no error is lost."""

from __future__ import annotations

import asyncio
from math import inf
from random import Random
from typing import TYPE_CHECKING

import pytest

from mavstack.dialects import common
from mavstack.errors import LinkError
from mavstack.links import MemoryNetwork, open_link
from mavstack.node import Node
from mavstack.sim import Runner, Simulation, run_virtually

if TYPE_CHECKING:
    from collections.abc import Coroutine


def one_vehicle(**options: int) -> Simulation:
    simulation = Simulation(rate=10, **options)
    simulation.add()
    return simulation


def port_count(simulation: Simulation) -> int:
    return sum(len(vehicle.ports) for vehicle in simulation.vehicles)


@pytest.mark.flight
def test_speed_changes_to_infinite_and_back():
    simulation = one_vehicle()

    async def work() -> None:
        runner = Runner(simulation)
        run_task = asyncio.ensure_future(runner.run(200))
        await asyncio.sleep(1)
        runner.speed = inf
        for _ in range(100):
            await asyncio.sleep(0)
        runner.speed = 2.0
        before = simulation.elapsed
        await asyncio.sleep(10)
        assert simulation.elapsed - before == pytest.approx(20, abs=1)
        runner.speed = inf
        await run_task

    began = simulation.now
    run_virtually(work())
    assert simulation.now - began == pytest.approx(200)


def test_background_error_is_raised_on_exit():
    simulation = one_vehicle()

    def fail(elapsed: float) -> None:
        if elapsed > 2:
            raise ZeroDivisionError("raised by the test")

    simulation.before_step.append(fail)

    async def work() -> None:
        async with Runner(simulation) as runner:
            runner.start()
            await asyncio.sleep(5)

    with pytest.raises(ZeroDivisionError, match="raised by the test"):
        run_virtually(work())


def test_error_of_a_link_is_raised_on_exit(monkeypatch):
    simulation = one_vehicle()
    monkeypatch.setattr(simulation.vehicles[0], "receive", lambda port, data: 1 / 0)

    async def work() -> None:
        network = MemoryNetwork()
        async with Runner(simulation) as runner:
            await runner.connect(network.link(), simulation.vehicles)
            runner.start()
            async with Node(network.link()):
                await asyncio.sleep(5)

    with pytest.raises(ZeroDivisionError):
        run_virtually(work())


def test_closed_runner_leaves_no_ports():
    simulation = one_vehicle()
    simulation.add()

    async def work() -> None:
        for _ in range(5):
            network = MemoryNetwork()
            async with Runner(simulation) as runner:
                await runner.connect(network.link(), simulation.vehicles)
                runner.start()
                async with Node(network.link()) as ground:
                    await ground.wait_for_autopilot(system=1)
                    assert port_count(simulation) == 2
            assert port_count(simulation) == 0

    run_virtually(work())


@pytest.mark.fast_cases(7)
@pytest.mark.parametrize("seed", range(20))
def test_cancellation_at_any_moment(seed):
    """Cancel at any moment, as Ctrl-C does."""
    random, simulation = Random(seed), one_vehicle()
    speed = random.choice([1.0, 10.0, inf])  # with an infinite speed, virtual time stands still

    async def work() -> None:
        network = MemoryNetwork()
        async with Runner(simulation, speed=speed) as runner:
            await runner.connect(network.link(), simulation.vehicles)
            if random.random() < 0.5:
                runner.start()
            async with Node(network.link()) as ground:
                ground.send(common.Heartbeat())
                await runner.run()

    async def cancel_work() -> None:
        task = asyncio.ensure_future(work())
        for _ in range(random.randrange(60)):
            await asyncio.sleep(0 if speed == inf else random.choice([0, 0, 0.01]))
        task.cancel()
        with pytest.raises(asyncio.CancelledError):
            await task
        assert asyncio.all_tasks() == {asyncio.current_task()}

    run_virtually(cancel_work())
    assert port_count(simulation) == 0


def test_two_runners_on_one_port():
    async def work() -> None:
        async with Runner(one_vehicle()) as first, Runner(one_vehicle()) as second:
            for scheme in ("udpin", "tcpin"):
                link = await first.connect(f"{scheme}://127.0.0.1:0", first.simulation.vehicles)
                assert link.address is not None
                with pytest.raises(LinkError):
                    await second.connect(
                        f"{scheme}://127.0.0.1:{link.address[1]}", second.simulation.vehicles
                    )

    run(work())


def test_vehicles_answer_after_a_flood_of_invalid_data():
    """Invalid data of several forms; a command is answered afterwards."""
    simulation, random = one_vehicle(), Random(1)
    simulation.add()

    async def work() -> None:
        async with Runner(simulation) as runner:
            link = await runner.connect("udpin://127.0.0.1:0", simulation.vehicles)
            url = f"udpout://127.0.0.1:{link.address[1]}"
            flood = open_link(url)
            await flood.open()
            runner.start()
            async for batch in flood.batches():
                channel = batch[0].channel
                break
            heartbeat = bytes.fromhex("fd09000000ffbe000000000000000608c0040320a0")
            for _ in range(200):
                for _ in range(100):
                    channel.write(random.choice([random.randbytes(300), b"\xfd" * 280, heartbeat, b"\0"]))
                await asyncio.sleep(0)
            async with Node(url, system=254) as ground:
                vehicle = await ground.wait_for_autopilot(system=2)
                await vehicle.command(common.MavCmd.DO_SET_ROI_NONE)
            await flood.close()

    run(work())


def test_peer_that_never_reads():
    """Data for a peer that never reads is dropped, and other peers receive everything."""
    simulation = one_vehicle()

    async def work() -> None:
        network = MemoryNetwork()
        async with Runner(simulation) as runner:
            link = await runner.connect(network.link(), simulation.vehicles)
            silent_link = network.link("memory://pair?receive_queue=10000")
            await silent_link.open()
            runner.start()
            await asyncio.sleep(20)
            assert link.counters.dropped_out > 100
            async with Node(network.link()) as ground:
                vehicle = await ground.wait_for_autopilot()
                await vehicle.command(common.MavCmd.DO_SET_ROI_NONE)
            await silent_link.close()
            await asyncio.sleep(1)
            assert port_count(simulation) == 0

    run_virtually(work())


def run(work: Coroutine[None, None, None]) -> None:
    """Run in real time, since the sockets are real, with a timeout."""
    asyncio.run(asyncio.wait_for(work, 30))
