"""Flights of simulated vehicles in worlds."""

from __future__ import annotations

import asyncio
from contextlib import asynccontextmanager

from mavstack import connect
from mavstack.links import MemoryNetwork
from mavstack.simulators.foreign import ForeignVehicle


@asynccontextmanager
async def flown(firmware, vehicle_type, port):
    """Yield a vehicle in the world at a port, and its client."""
    network = MemoryNetwork()
    scheme = "tcpout" if firmware == "px4" else "udpout"
    made = ForeignVehicle(firmware, vehicle_type, to=f"{scheme}://127.0.0.1:{port}", links=[network.link()])
    async with made:
        flying = asyncio.ensure_future(made.run())
        while made.vehicle is None and not flying.done():  # noqa: ASYNC110 (there is no event for it)
            await asyncio.sleep(0.01)
        try:
            async with connect(network.link()) as connection:
                vehicle = await connection.wait_for_vehicle()
                await vehicle.wait_until_ready()
                yield made, vehicle
        finally:
            flying.cancel()
            await asyncio.gather(flying, return_exceptions=True)


@asynccontextmanager
async def running(world):
    """Run a world."""
    async with world:
        run = asyncio.ensure_future(world.run())
        await asyncio.sleep(0)
        try:
            yield world
        finally:
            run.cancel()
            await asyncio.gather(run, return_exceptions=True)
