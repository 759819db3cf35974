"""The world of Betaflight behind its sockets, with a stand-in for it."""

from __future__ import annotations

import asyncio
import socket
import struct

import pytest

from mavstack.errors import InvalidArgumentError
from mavstack.simulators import BetaflightSimulator
from tests.simulators.firmwares import until


def three_ports():
    """Return three free sockets of consecutive ports; the first is closed again."""
    for _ in range(100):
        first = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        first.bind(("127.0.0.1", 0))
        port = first.getsockname()[1]
        others = [socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(2)]
        try:
            for offset, other in enumerate(others, 1):
                other.bind(("127.0.0.1", port + offset))
        except OSError:
            for each in (first, *others):
                each.close()
            continue
        first.close()
        return port, others
    raise AssertionError("no three free ports")


async def test_it_sends_states_and_sticks_and_takes_motors():
    port, (state, sticks) = three_ports()
    lines = []
    with state, sticks:
        for each in (state, sticks):
            each.setblocking(False)
        world = BetaflightSimulator(listen=f"udpin://127.0.0.1:{port}", speed=0.0, on_connect=lines.append)
        async with world:
            assert "waits for motors" in world.status
            world.set_sticks([1500, 1500, 1200, 1500, 2000])
            run = asyncio.ensure_future(world.run(until=2.0))
            loop = asyncio.get_running_loop()
            assert len(await loop.sock_recv(state, 256)) == 144
            assert struct.unpack("<d16H", await loop.sock_recv(sticks, 64))[3] == 1200
            state.sendto(b"noise", ("127.0.0.1", port))
            state.sendto(struct.pack("<4f", *[0.7] * 4), ("127.0.0.1", port))
            await until(lambda: world.interface.answers)
            assert world.status == "Betaflight flies by its own clock"
            await asyncio.wait_for(run, 30)
            assert world.time == pytest.approx(2.0)
    assert lines == ["Betaflight is connected"]
    assert world.state.position[2] < 0.0
    assert world.interface.invalid == 1


@pytest.mark.parametrize(("speed", "times"), [(1.0, {0.0}), (0.0, {0.0025, 0.005})])
async def test_betaflight_keeps_its_own_clock_in_real_time(speed, times):
    port, (state, sticks) = three_ports()
    with state, sticks:
        state.setblocking(False)
        async with BetaflightSimulator(listen=f"udpin://127.0.0.1:{port}", speed=speed) as world:
            await asyncio.wait_for(world.run(until=0.005), 30)
            loop = asyncio.get_running_loop()
            packets = [await loop.sock_recv(state, 256) for _ in range(2)]
    assert {struct.unpack("<18d", packet)[0] for packet in packets} == times


def test_bodies_without_motors_are_refused():
    with pytest.raises(InvalidArgumentError, match="which the physics plane has not"):
        BetaflightSimulator("plane")
