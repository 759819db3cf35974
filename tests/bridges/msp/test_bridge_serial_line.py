"""The bridge to a simulated Betaflight at the end of a serial line, in virtual time."""

from __future__ import annotations

import asyncio
from contextlib import asynccontextmanager
from itertools import pairwise

import pytest

from mavstack.bridges.msp import FlightController
from mavstack.bridges.msp.bridge import MspBridge
from mavstack.dialects import common
from mavstack.links import Impairment, impair, memory_pair
from mavstack.links.events import BytesReceived
from mavstack.links.memory import MemoryNetwork
from mavstack.sim.virtual import run_virtually
from mavstack.vehicle import connect
from tests.sim.msp.peer import Peer

#: 115,200 baud.
SERIAL = Impairment(bandwidth=11520)
ANSWER_TIME = 0.001


async def answer(peer, link):
    """Answer requests that come over a link as the flight controller does."""

    def receive(events):
        for event in events:
            if isinstance(event, BytesReceived):
                asyncio.get_running_loop().call_later(ANSWER_TIME, reply, event)

    def reply(event):
        if data := peer.send(event.data):
            event.channel.write(data)

    async with link:
        await link.read(receive)


@asynccontextmanager
async def vehicle_at_a_serial_line():
    loop = asyncio.get_running_loop()
    near, far = memory_pair(loop.time)
    network = MemoryNetwork(lambda: loop.time() + 1e9)
    task = asyncio.create_task(answer(Peer("betaflight"), far))
    await asyncio.sleep(0)
    try:
        async with (
            FlightController(impair(near, SERIAL)) as controller,
            MspBridge(controller, network.link()),
            connect(network.link()) as connection,
        ):
            yield await connection.wait_for_vehicle()
    finally:
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)


@pytest.mark.flight
def test_attitude_at_100_hertz_while_parameters_are_downloaded():
    async def main():
        async with vehicle_at_a_serial_line() as vehicle:
            loop, times = asyncio.get_running_loop(), []
            await vehicle.set_message_rate(common.Attitude, 100)
            await asyncio.sleep(1)
            vehicle.add_listener(common.Attitude, lambda _: times.append(loop.time()))
            parameters = await vehicle.params.download()
            duration = times[-1] - times[0]
            assert len(parameters) > 200
            assert len(times) / duration == pytest.approx(100, abs=5)
            assert max(after - before for before, after in pairwise(times)) < 0.05

    run_virtually(main())
