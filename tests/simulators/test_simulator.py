"""Simulators behind their sockets, with stand-ins for the firmwares."""

from __future__ import annotations

import asyncio
import struct
from contextlib import suppress

import pytest

from mavstack.dialects import Dialect, common
from mavstack.errors import InvalidArgumentError, LinkError
from mavstack.sim.vehicle_types import DEFAULT_HOME
from mavstack.simulators import ArduPilotSimulator, Px4Simulator
from mavstack.simulators.px4 import Phase
from mavstack.wire import Parser, encode

FREE = "tcpin://127.0.0.1:0"


class Px4:
    """PX4 as the interface sees it: silent at first, then one answer to each HIL_SENSOR."""

    def __init__(self, reader, writer, silent=3):
        self.reader, self.writer, self.silent = reader, writer, silent
        self.times = []

    @classmethod
    async def connect(cls, port, **options):
        return cls(*await asyncio.open_connection("127.0.0.1", port), **options)

    async def close(self):
        self.writer.close()
        with suppress(OSError):
            await self.writer.wait_closed()

    async def fly(self, steps, motors=0.6):
        try:
            with suppress(ConnectionResetError):
                await self._fly(steps, motors)
        finally:
            await self.close()

    async def _fly(self, steps, motors):
        parser = Parser(Dialect.load("common"))
        while len(self.times) < steps and (data := await self.reader.read(4096)):
            for packet in parser.feed(data):
                if isinstance(packet.message, common.HilSensor):
                    self.times.append(packet.message.time_usec)
                    if len(self.times) > self.silent:
                        self.answer(motors)

    def answer(self, motors):
        message = common.HilActuatorControls(controls=[motors] * 4 + [0.0] * 12, mode=129, flags=1)
        self.writer.write(encode(message, system=1, component=1))


async def until(holds):
    """Let the loop run until a condition holds."""
    while not holds():  # noqa: ASYNC110 (the simulator has no event for a step)
        await asyncio.sleep(0)


async def test_px4_flies_in_lockstep():
    lines = []
    async with Px4Simulator(
        "copter", home=DEFAULT_HOME, listen=FREE, speed=0, on_connect=lines.append
    ) as simulator:
        px4 = await Px4.connect(simulator.port)
        flying = asyncio.ensure_future(px4.fly(1000))
        await simulator.run(until=2.0)
    await flying
    assert simulator.interface.phase is Phase.LOCKSTEP
    assert px4.times[:500] == [1_000_000 + 4_000 * index for index in range(len(px4.times[:500]))]
    assert simulator.interface.answers >= 490
    assert simulator.state.position[2] < -1.0
    assert lines[0].startswith("PX4 is connected")
    assert "lockstep" in lines[1]


async def test_px4_that_leaves_ends_the_run():
    async with Px4Simulator("copter", home=DEFAULT_HOME, listen=FREE, speed=0) as simulator:
        px4 = await Px4.connect(simulator.port)
        flying = asyncio.ensure_future(px4.fly(20))
        await simulator.run()
        await flying
    async with Px4Simulator("copter", home=DEFAULT_HOME, listen=FREE, speed=0) as simulator:
        px4 = await Px4.connect(simulator.port)
        flying = asyncio.ensure_future(px4.fly(20))
        with pytest.raises(LinkError, match="PX4 disconnected after"):
            await simulator.run(until=100)
        await flying


async def test_a_second_px4_is_refused():
    async with Px4Simulator("copter", home=DEFAULT_HOME, listen=FREE, speed=0) as simulator:
        first = await Px4.connect(simulator.port)
        second = await Px4.connect(simulator.port)
        assert await second.reader.read(1) == b""
        await second.close()
    await first.close()


async def test_pause_and_single_steps():
    async with Px4Simulator("copter", home=DEFAULT_HOME, listen=FREE, speed=0) as simulator:
        px4 = await Px4.connect(simulator.port, silent=0)
        flying = asyncio.ensure_future(px4.fly(10**6))
        simulator.pace.pause(steps=5)
        running = asyncio.ensure_future(simulator.run())
        await until(lambda: simulator.interface.steps >= 5)
        for _ in range(50):
            await asyncio.sleep(0)
        assert simulator.interface.steps == 5
        assert simulator.pace.is_paused
        simulator.pace.resume()
        await until(lambda: simulator.interface.steps >= 10)
        running.cancel()
        with suppress(asyncio.CancelledError):
            await running
    await flying


async def test_ardupilot_asks_and_is_answered():
    lines = []
    async with ArduPilotSimulator(
        "copter", home=DEFAULT_HOME, listen="udpin://127.0.0.1:0", on_connect=lines.append
    ) as simulator:
        answers: asyncio.Queue[bytes] = asyncio.Queue()

        class Asks(asyncio.DatagramProtocol):
            def datagram_received(self, data, addr):
                answers.put_nowait(data)

        loop = asyncio.get_running_loop()
        sitl, _ = await loop.create_datagram_endpoint(Asks, remote_addr=("127.0.0.1", simulator.port))
        for number in range(200):
            sitl.sendto(struct.pack("<HHI16H", 18458, 400, number, *[1700] * 16))
            assert (await asyncio.wait_for(answers.get(), 10)).startswith(b"\n{")
        sitl.sendto(b"noise")
        sitl.sendto(struct.pack("<HHI16H", 18458, 400, 0, *[1000] * 16))
        await asyncio.wait_for(answers.get(), 10)
        sitl.close()
    assert lines == ["ArduPilot is connected", "ArduPilot was started again"]
    assert simulator.interface.invalid == 1
    assert simulator.time == pytest.approx(1 / 400)


async def test_physics_that_fails_ends_the_run():
    async with ArduPilotSimulator("copter", home=DEFAULT_HOME, listen="udpin://127.0.0.1:0") as simulator:
        simulator.interface._physics.step = lambda actuators, dt: 1 / 0  # type: ignore[method-assign]
        simulator.take(struct.pack("<HHI16H", 18458, 400, 0, *[1000] * 16), ("127.0.0.1", 9))
        with pytest.raises(ZeroDivisionError):
            await simulator.run()


@pytest.mark.parametrize("url", ["udpin://127.0.0.1:4560", "tcpout://127.0.0.1:4560"])
def test_another_scheme_is_refused(url):
    with pytest.raises(InvalidArgumentError, match=r"must be tcpin://HOST:PORT"):
        Px4Simulator("copter", home=DEFAULT_HOME, listen=url)


@pytest.mark.parametrize("speed", [-1.0, float("nan"), float("inf")])
def test_a_wrong_speed_is_refused(speed):
    with pytest.raises(InvalidArgumentError, match="the speed must be 0 or more"):
        Px4Simulator("copter", home=DEFAULT_HOME, listen=FREE, speed=speed)


async def test_a_port_in_use_is_reported():
    async with Px4Simulator("copter", home=DEFAULT_HOME, listen=FREE) as first:
        with pytest.raises(LinkError, match=r"cannot listen on tcpin://127\.0\.0\.1"):
            async with Px4Simulator("copter", home=DEFAULT_HOME, listen=f"tcpin://127.0.0.1:{first.port}"):
                pass
