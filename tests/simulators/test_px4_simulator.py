"""The world of PX4 behind its socket, with a stand-in for PX4."""

from __future__ import annotations

import asyncio
from contextlib import suppress

import pytest

from mavstack.errors import InvalidArgumentError, LinkError
from mavstack.simulators import Px4Simulator
from mavstack.simulators.px4 import START, STEP, Phase
from tests.simulators.firmwares import Px4, until

FREE = "tcpin://127.0.0.1:0"


def simulator(**options):
    return Px4Simulator("copter", **{"listen": FREE, "speed": 0.0} | options)


async def test_px4_flies_in_lockstep():
    lines = []
    async with simulator(on_connect=lines.append) as world:
        px4 = await Px4.connect(world.port)
        flying = asyncio.ensure_future(px4.fly(1000))
        await world.run(until=2.0)
        assert world.interface.phase is Phase.LOCKSTEP
        assert world.status == Phase.LOCKSTEP.value
    await flying
    assert px4.times == [START + STEP * index for index in range(500)]
    assert world.interface.answers == 497
    assert world.interface.extra_answers == 0
    assert world.state.position[2] < -1.0
    assert lines[0].startswith("PX4 is connected")
    assert "lockstep" in lines[1]


class FalteringPx4(Px4):
    """PX4 with a rover: it answers only every third packet of sensors."""

    def answer(self, motors):
        if len(self.times) % 3 == 0:
            super().answer(motors)


async def test_a_rover_needs_no_answer_to_each_step():
    async with Px4Simulator("rover", listen=FREE, speed=0.0) as world:
        flying = asyncio.ensure_future((await FalteringPx4.connect(world.port)).fly(10**6))
        await world.run(until=0.2)
        assert world.time == pytest.approx(0.2)
        assert world.interface.phase is Phase.LOCKSTEP
    await flying


async def test_a_run_is_continued():
    async with simulator() as world:
        flying = asyncio.ensure_future((await Px4.connect(world.port)).fly(10**6))
        await world.run(until=0.5)
        assert world.time == pytest.approx(0.5)
        await world.run(until=0.4)
        assert world.time == pytest.approx(0.5)
        await world.run(until=1.0)
        assert world.time == pytest.approx(1.0)
    await flying


async def test_px4_that_leaves_ends_the_run_and_the_next_one_finds_a_new_world():
    async with simulator() as world:
        for _ in range(2):
            flying = asyncio.ensure_future((await Px4.connect(world.port)).fly(200))
            await world.run()
            await flying
            assert world.interface.steps in (200, 201)
            assert world.interface.phase is Phase.CLOSED
        flying = asyncio.ensure_future((await Px4.connect(world.port)).fly(20))
        with pytest.raises(LinkError, match="PX4 disconnected after"):
            await world.run(until=100)
        await flying


async def test_a_second_px4_is_refused():
    async with simulator() as world:
        first = await Px4.connect(world.port)
        await until(lambda: world.interface.phase is Phase.CONNECTED)
        second = await Px4.connect(world.port)
        assert await second.reader.read(1) == b""
        await second.close()
    await first.close()


async def test_pause_and_single_steps():
    async with simulator() as world:
        px4 = await Px4.connect(world.port, silent=0)
        flying = asyncio.ensure_future(px4.fly(10**6))
        world.pause(steps=5)
        running = asyncio.ensure_future(world.run())
        await until(lambda: world.interface.steps >= 5)
        for _ in range(50):
            await asyncio.sleep(0)
        assert world.interface.steps == 5
        assert world.status == "the simulation is paused"
        world.pause(steps=1)
        await until(lambda: world.interface.steps == 6)
        world.resume()
        await until(lambda: world.interface.steps >= 20)
        running.cancel()
        with suppress(asyncio.CancelledError):
            await running
    await flying


async def test_a_fault_begins_at_its_time():
    async with simulator() as world:
        px4 = await Px4.connect(world.port)
        flying = asyncio.ensure_future(px4.fly(10**6, motors=0.0))
        world.inject("imu-biased", after=1.0, duration=0.5)
        await world.run(until=2.0)
    await flying
    biased = [index * 0.004 for index, each in enumerate(px4.sensors) if each.xacc > 1.0]
    assert (min(biased), max(biased)) == pytest.approx((1.0, 1.496))


async def test_the_same_seed_gives_the_same_bytes_over_a_flight():
    async def flight(seed):
        async with simulator(seed=seed) as world:
            px4 = await Px4.connect(world.port, silent=0)
            flying = asyncio.ensure_future(px4.fly(10**6))
            await world.run(until=1.0)
        await flying
        return [each.to_dict() for each in px4.sensors], world.state

    assert await flight(3) == await flight(3)
    assert await flight(3) != await flight(4)


async def test_physics_that_fails_ends_the_run():
    async with simulator() as world:
        world._physics.step = lambda actuators, dt: 1 / 0
        flying = asyncio.ensure_future((await Px4.connect(world.port)).fly(100))
        with pytest.raises(ZeroDivisionError):
            await world.run()
    await flying


async def test_ten_worlds_run_at_once():
    async def fly(number):
        async with simulator(seed=number) as world:
            flying = asyncio.ensure_future((await Px4.connect(world.port, silent=0)).fly(10**6))
            await world.run(until=0.4)
            assert world.interface.extra_answers == 0
        await flying
        return world.time

    assert await asyncio.gather(*[fly(number) for number in range(10)]) == [pytest.approx(0.4)] * 10


@pytest.mark.parametrize("url", ["udpin://127.0.0.1:4560", "tcpout://127.0.0.1:4560"])
def test_another_scheme_is_refused(url):
    with pytest.raises(InvalidArgumentError, match=r"must be tcpin://HOST:PORT"):
        simulator(listen=url)


@pytest.mark.parametrize("speed", [-1.0, float("nan"), float("inf")])
def test_a_wrong_speed_is_refused(speed):
    with pytest.raises(InvalidArgumentError, match="the speed must be 0 or more"):
        simulator(speed=speed)


async def test_a_port_in_use_is_reported():
    async with simulator() as first:
        with pytest.raises(LinkError, match=r"cannot listen on tcpin://127\.0\.0\.1"):
            async with simulator(listen=f"tcpin://127.0.0.1:{first.port}"):
                pass
