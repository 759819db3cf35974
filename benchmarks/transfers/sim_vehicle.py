"""A simulated PX4 copter with 1,500 parameters and its full telemetry, as in `mav sim`.

`python -m benchmarks.transfers.sim_vehicle PORT CONDITION` is started like any other vehicle program.
"""

from __future__ import annotations

import asyncio
import sys

from mavstack.sim import Simulation
from mavstack.sim.runner import Runner

from .vehicles import link_url

PARAMETERS = 1500


async def fly(port: int, condition: str) -> None:
    """Run the vehicle until the process is ended."""
    simulation = Simulation()
    vehicle = simulation.add("copter", "px4")
    server = vehicle.services.parameters
    for number in range(PARAMETERS - len(server.table)):
        server.add(f"BENCH_PARAM_{number}", number if number % 2 else number / 7)
    async with Runner(simulation) as runner:
        await runner.connect(link_url(port, condition), [vehicle])
        await runner.run()


if __name__ == "__main__":
    asyncio.run(fly(int(sys.argv[1]), sys.argv[2]))
