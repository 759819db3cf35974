"""Hardware in the loop, with a stand-in for the board at a UDP link."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.dialects import Dialect, common
from mavstack.errors import InvalidArgumentError, LinkURLError
from mavstack.links import BytesReceived, open_link
from mavstack.simulators import HardwareSimulator
from mavstack.wire import Parser, encode


async def fly(physics, firmware, answer):
    """Fly a second; returns the world and the messages that the board got."""
    lines, messages, parser = [], [], Parser(Dialect.load("common"))
    async with HardwareSimulator(
        physics, "udpin://127.0.0.1:0", firmware=firmware, on_connect=lines.append
    ) as world:
        assert world.status == "the simulator waits for the link to the board"
        world.pace.speed = 0.0
        board = open_link(f"udpout://127.0.0.1:{world.port}")
        await board.open()
        board.channels[0].write(encode(common.Heartbeat(), system=1, component=1))
        run = asyncio.ensure_future(world.run())

        async def read():
            async for batch in board.batches():
                for event in batch:
                    if isinstance(event, BytesReceived):
                        messages.extend(packet.message for packet in parser.feed(event.data))
                        board.channels[0].write(encode(answer, system=1, component=1))

        reading = asyncio.ensure_future(read())
        while not (world.time > 2.5 and len(lines) == 2 and len(messages) > 20):  # noqa: ASYNC110
            await asyncio.sleep(0)
        assert world.status == "the board flies by its own clock"
        for task in (run, reading):
            task.cancel()
        await asyncio.gather(run, reading, return_exceptions=True)
        await board.close()
    assert lines[1] == "the board drives its outputs"
    return world, messages


async def test_px4_on_a_board():
    motors = common.HilActuatorControls(controls=[0.7] * 4 + [0.0] * 12, mode=129)
    world, messages = await fly("copter", "px4", motors)
    kinds = {type(message).__name__ for message in messages}
    assert {"HilSensor", "HilGps", "Heartbeat"} <= kinds
    assert world.state.position[2] < 0.0


async def test_ardupilot_on_a_board():
    outputs = common.RcChannelsScaled(chan3_scaled=10_000)
    world, messages = await fly("rover", "ardupilot", outputs)
    assert any(isinstance(message, common.HilState) for message in messages)
    assert world.state.position[0] > 0.0


def test_wrong_arguments_are_refused():
    with pytest.raises(InvalidArgumentError, match="there is no hardware in the loop with 'betaflight'"):
        HardwareSimulator("copter", "udpin://127.0.0.1:0", firmware="betaflight")
    with pytest.raises(InvalidArgumentError, match="flies planes and drives rovers only"):
        HardwareSimulator("copter", "udpin://127.0.0.1:0", firmware="ardupilot")
    with pytest.raises(LinkURLError):
        HardwareSimulator("copter", "nonsense://x")
