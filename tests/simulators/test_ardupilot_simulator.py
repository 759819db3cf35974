"""The world of ArduPilot behind its socket, with a stand-in for SITL."""

from __future__ import annotations

import asyncio
import json
from contextlib import suppress

import pytest

from mavstack.simulators import ArduPilotSimulator
from tests.simulators.firmwares import Sitl, until


def simulator(**options):
    return ArduPilotSimulator("copter", **{"listen": "udpin://127.0.0.1:0"} | options)


async def running(world):
    task = asyncio.ensure_future(world.run())
    await asyncio.sleep(0)
    return task


async def stopped(task):
    task.cancel()
    with suppress(asyncio.CancelledError):
        await task


async def test_ardupilot_asks_and_is_answered():
    lines = []
    async with simulator(on_connect=lines.append) as world:
        assert "waits for servo outputs" in world.status
        run = await running(world)
        sitl = await Sitl.connect(world.port)
        for number in range(200):
            assert (await sitl.ask(number, count=16 if number < 100 else 32)).startswith(b"\n{")
        assert world.status == "ArduPilot asks for each step and waits for the answer"
        sitl.send(b"noise")
        await sitl.ask(0, pulse=1000)
        sitl.close()
        await stopped(run)
    assert lines == ["ArduPilot is connected", "ArduPilot was started again"]
    assert world.interface.invalid == 1
    assert world.time == pytest.approx(1 / 400)


async def test_a_lost_answer_is_repeated():
    async with simulator() as world:
        run = await running(world)
        sitl = await Sitl.connect(world.port)
        first = await sitl.ask(7)
        assert await sitl.ask(7) == first
        assert json.loads(await sitl.ask(8))["timestamp"] == pytest.approx(2 / 400)
        assert (world.interface.steps, world.interface.repeated) == (2, 1)
        sitl.close()
        await stopped(run)


async def test_it_ends_at_its_time():
    async with simulator() as world:
        run = asyncio.ensure_future(world.run(until=0.1))
        sitl = await Sitl.connect(world.port)
        for number in range(40):
            await sitl.ask(number)
        await asyncio.wait_for(run, 10)
        assert world.time == pytest.approx(0.1)
        sitl.close()


async def test_a_pause_holds_the_answer_back():
    async with simulator() as world:
        run = await running(world)
        sitl = await Sitl.connect(world.port)
        await sitl.ask(0)
        world.pause()
        asking = asyncio.ensure_future(sitl.ask(1))
        await until(lambda: world._question is not None)
        assert world.interface.steps == 1
        sitl.send(b"noise")
        world.resume()
        await asking
        assert world.interface.steps == 2
        sitl.close()
        await stopped(run)


async def test_physics_that_fails_ends_the_run():
    async with simulator() as world:
        world._physics.step = lambda actuators, dt: 1 / 0
        run = await running(world)
        sitl = await Sitl.connect(world.port)
        asking = asyncio.ensure_future(sitl.ask(0))
        with pytest.raises(ZeroDivisionError):
            await run
        await stopped(asking)
        sitl.close()
