"""Fly three simulated copters north together and return, with the outcome of each."""

import asyncio

import mavstack
from mavstack.sim.background import BackgroundSimulator


async def main(url: str) -> None:
    """Fly all vehicles at the same time."""
    async with mavstack.connect(url) as connection:
        fleet = await connection.wait_for_vehicles(3)
        (await fleet.each(lambda vehicle: vehicle.wait_until_ready())).check()
        for step in (fleet.arm(), fleet.takeoff(10)):
            print(await step)
        await fleet.each(lambda vehicle: vehicle.move(north=15))
        for vehicle in fleet:
            print(vehicle, vehicle.mode, vehicle.position)
        (await fleet.rtl()).check()
        print("all have landed")


with BackgroundSimulator("copter", "px4", count=3, speed=10) as simulated:
    asyncio.run(main(simulated.url))
