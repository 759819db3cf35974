"""Lockstep over long times and through restarts, and recorded sessions."""

from __future__ import annotations

import asyncio
import hashlib
import json
import random
import struct
from pathlib import Path

import pytest

from mavstack.dialects import Dialect
from mavstack.sim.vehicle_types import DEFAULT_HOME
from mavstack.simulators import ArduPilotSimulator, Px4Simulator, Sensors
from mavstack.simulators.ardupilot import JsonInterface
from mavstack.simulators.bodies.surface import Surface
from mavstack.simulators.outputs import Outputs
from mavstack.simulators.px4 import START, STEP, Phase
from tests.simulators.firmwares import Px4, Sitl

MILLION = 1_000_000


class Counting(Px4):
    """PX4 that checks that no step is lost or repeated, and flies by what it measures."""

    last = START - STEP

    def __init__(self, *arguments, **options):
        super().__init__(*arguments, **options)
        self.digest = hashlib.sha256()

    async def _fly(self, steps, motors):
        from mavstack.dialects import common
        from mavstack.wire import Parser

        parser = Parser(Dialect.load("common"))
        while data := await self.reader.read(65536):
            for packet in parser.feed(data):
                if packet.message_id == common.HilSensor.__mavlink_row__[0]:
                    time = packet.message.time_usec
                    assert time == self.last + STEP, f"step {time} after {self.last}"
                    self.last = time
                    command = 0.5 + 0.05 * max(-1.0, min(1.0, packet.message.zacc + 9.8))
                    self.digest.update(struct.pack("<d", command))
                    self.answer(command)


async def counted(steps, seed=1):
    """Fly some steps; returns the digest of the outputs."""
    async with Px4Simulator(listen="tcpin://127.0.0.1:0", speed=0.0, seed=seed) as world:
        px4 = await Counting.connect(world.port, silent=0)
        flying = asyncio.ensure_future(px4.fly(steps))
        await world.run(until=steps * STEP / 1e6)
        assert world.interface.steps == steps
        assert world.interface.answers == steps
        assert world.interface.extra_answers == 0
    await flying
    return px4.digest.hexdigest()


async def test_no_step_is_lost_or_repeated():
    assert await counted(2000) == await counted(2000)


@pytest.mark.flight
async def test_a_minute_is_the_same_each_time():
    first = await counted(15_000, seed=5)
    assert first == await counted(15_000, seed=5)
    assert first != await counted(15_000, seed=6)


@pytest.mark.nightly
@pytest.mark.timeout(1800)
async def test_no_step_of_a_million_is_lost_or_repeated():
    await counted(MILLION)


@pytest.mark.parametrize("seed", range(3))
async def test_px4_is_killed_and_started_again_at_random(seed):
    choose = random.Random(seed)
    async with Px4Simulator(listen="tcpin://127.0.0.1:0", speed=0.0) as world:
        for _ in range(5):
            px4 = await Px4.connect(world.port, silent=choose.randrange(3))
            run = asyncio.ensure_future(world.run())
            steps = choose.randrange(1, 60)
            await px4.fly(steps)
            await asyncio.wait_for(run, 20)
            assert world.interface.phase is Phase.CLOSED
            assert px4.times[:steps] == [START + STEP * index for index in range(steps)]


@pytest.mark.parametrize("seed", range(3))
async def test_ardupilot_and_its_world_are_killed_at_random(seed):
    choose = random.Random(seed)
    port = 0
    for _ in range(3):
        async with ArduPilotSimulator(listen=f"udpin://127.0.0.1:{port}") as world:
            port = world.port
            run = asyncio.ensure_future(world.run())
            for _ in range(3):
                sitl = await Sitl.connect(port)
                first = choose.randrange(3)  # the first numbers may be lost
                for number in range(first, first + choose.randrange(1, 50)):
                    await sitl.ask(number)
                sitl.close()
            run.cancel()
            await asyncio.gather(run, return_exceptions=True)


#: Datagrams of an ArduRover 4.1: its first 20, then each 40th; one in hexadecimal digits a line.
SESSION = Path(__file__).with_name("sessions") / "ardurover.txt"


def test_a_recorded_session_is_answered():
    datagrams = [bytes.fromhex(line) for line in SESSION.read_text().split()]
    interface = JsonInterface(Surface(), Outputs.STEERING, DEFAULT_HOME, Sensors(DEFAULT_HOME))
    answers = [interface.answer(data) for data in datagrams]
    assert all(json.loads(answer)["timestamp"] > 0.0 for answer in answers)
    assert interface.steps == len(set(datagrams))
    assert interface.repeated == len(datagrams) - interface.steps
    assert interface.invalid == 0
    assert interface.state.position == pytest.approx((0.0, 0.0, 0.0), abs=0.1)
