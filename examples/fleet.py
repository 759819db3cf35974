"""Three simulated copters take off, fly north together and come home; what each answers is told."""

import asyncio

import mavstack
from mavstack.sim.background import BackgroundSimulator


async def main(url: str) -> None:
    """Fly all of them at once."""
    async with mavstack.connect(url) as node:
        fleet = await node.wait_for_vehicles(3)
        (await fleet.each(lambda vehicle: vehicle.wait_until_ready())).check()
        for step in (fleet.arm(), fleet.takeoff(10)):
            print(await step)
        await fleet.each(lambda vehicle: vehicle.move(north=15))
        for vehicle in fleet:
            print(vehicle, vehicle.mode, vehicle.position)
        (await fleet.rtl()).check()
        print("all are home")


with BackgroundSimulator("copter", "px4", count=3, speed=10) as simulated:
    asyncio.run(main(simulated.url))
