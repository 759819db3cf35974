"""Types and firmwares fly a mission over real UDP with 10 % loss and 200 ms latency."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.links import Impairment, impair, open_link
from mavstack.sim.runner import Runner
from mavstack.sim.simulation import Simulation
from mavstack.vehicle import connect
from tests.sim.running import reduce_telemetry
from tests.sim.whole_flights.plans import triangle
from tests.vehicle.test_whole_missions import check, flown, loaded
from tests.vehicle.world import ALL, Kind, World

pytestmark = pytest.mark.interop

#: Simulated seconds per real second in flight; the link appears slower by the same factor.
SPEED = 4.0
#: Timeouts of ground-station heartbeats, which come in real time.
TIMEOUTS = {"FS_GCS_TIMEOUT", "FS_LONG_TIMEOUT", "FS_SHORT_TIMEOUT", "FS_TIMEOUT"}


@pytest.mark.long
@pytest.mark.parametrize(
    "kinds", [pytest.param(ALL[::5], id="some"), pytest.param(ALL, id="all", marks=pytest.mark.nightly)]
)
async def test_types_fly_over_a_lossy_link(kinds: list[Kind]) -> None:
    simulation = Simulation(seed=6)
    for kind, firmware in kinds:
        vehicle = simulation.add(kind, firmware)
        reduce_telemetry(vehicle)
        for name in TIMEOUTS:
            timeout = vehicle.parameters.get(name, None)
            if timeout is not None:
                vehicle.parameters.set(name, timeout * SPEED)
    simulation.advance(simulation.now + 30.0)
    for vehicle in simulation.vehicles:
        vehicle.data_to_send()
    async with Runner(simulation) as runner:
        link = await runner.connect("udpin://127.0.0.1:0", simulation.vehicles)
        running = runner.start()
        impaired = impair(
            open_link(f"udpout://127.0.0.1:{link.address[1]}"), Impairment(loss=0.1, latency=0.2, seed=2)
        )
        async with connect(impaired) as connection:
            world = World(simulation, connection, None)
            loading = [loaded(world, number + 1, triangle(*kind)) for number, kind in enumerate(kinds)]
            flights = await asyncio.gather(*loading)
            runner.speed = SPEED  # at this speed an upload over the slow link would time out
            for flight in await asyncio.gather(*(flown(world, flight) for flight in flights)):
                check(flight)
        assert not running.done()
