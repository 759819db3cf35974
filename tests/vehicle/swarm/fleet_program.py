"""A program with a fleet of simulated vehicles: `python -m tests.vehicle.swarm.fleet_program COUNT`.

It prints the URL of its link, and ends when its input ends. The vehicles are ready to arm, on a grid, and
only send heartbeats and requested messages, so that hundreds of them fit into a busy machine.
"""

from __future__ import annotations

import asyncio
import sys

from mavstack.sim.runner import Runner
from tests.vehicle.swarm.test_swarm_figures import fleet


async def serve(count):
    simulation = fleet(count)
    async with Runner(simulation) as runner:
        link = await runner.connect("tcpin://127.0.0.1:0", simulation.vehicles)
        runner.start()
        print(f"tcpout://127.0.0.1:{link.address[1]}", flush=True)
        await asyncio.to_thread(sys.stdin.read)


if __name__ == "__main__":
    asyncio.run(serve(int(sys.argv[1])))
