"""Every type and firmware flies a mission by the API over real UDP that loses a tenth and takes 200 ms."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.links import Impairment, impair, open_link
from mavstack.sim.runner import Runner
from mavstack.sim.simulation import Simulation
from mavstack.vehicle import connect
from tests.sim.whole_flights.fleet import whisper
from tests.sim.whole_flights.plans import triangle
from tests.vehicle.test_whole_missions import check, flown, loaded
from tests.vehicle.world import ALL, World

pytestmark = pytest.mark.interop

#: Simulated seconds in a real one while they fly; to the vehicles the link is as much slower then.
SPEED = 4.0
#: What vehicles wait for our heartbeats, which come by the real clock.
TIMEOUTS = {"FS_GCS_TIMEOUT", "FS_LONG_TIMEOUT", "FS_SHORT_TIMEOUT", "FS_TIMEOUT"}


async def test_all_types_fly_over_a_bad_link() -> None:
    simulation = Simulation(seed=6)
    for kind, firmware in ALL:
        vehicle = simulation.add(kind, firmware)
        whisper(vehicle)
        for name in TIMEOUTS:
            patience = vehicle.parameters.get(name, None)
            if patience is not None:
                vehicle.parameters.set(name, patience * SPEED)
    simulation.advance(simulation.now + 30.0)
    for vehicle in simulation.vehicles:
        vehicle.data_to_send()
    async with Runner(simulation) as runner:
        link = await runner.connect("udpin://127.0.0.1:0", simulation.vehicles)
        running = runner.start()
        bad = impair(
            open_link(f"udpout://127.0.0.1:{link.address[1]}"), Impairment(loss=0.1, latency=0.2, seed=2)
        )
        async with connect(bad) as node:
            made = World(simulation, node, None)
            plans = [loaded(made, number + 1, triangle(*kind)) for number, kind in enumerate(ALL)]
            flights = await asyncio.gather(*plans)
            runner.speed = SPEED  # vehicles would lose patience with an upload by a link so slow
            for flight in await asyncio.gather(*(flown(made, flight) for flight in flights)):
                check(flight)
        assert not running.done()
