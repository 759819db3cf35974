"""Fly a simulated copter by setpoints: a circle, by a velocity that turns."""

import asyncio
from math import cos, sin

import mavstack
from mavstack.sim.background import BackgroundSimulator

SPEED = 5  # simulated seconds per second


async def main(url: str) -> None:
    """Take off, follow setpoints, land."""
    async with mavstack.connect(url) as connection:
        vehicle = await connection.wait_for_vehicle()
        await vehicle.wait_until_ready()
        await vehicle.arm()
        await vehicle.takeoff(10)
        async with vehicle.guided() as guided:
            for step in range(40):
                angle = step * 0.3
                guided.velocity(north=3 * cos(angle), east=3 * sin(angle))
                await asyncio.sleep(0.5 / SPEED)
        print("after the circle:", vehicle.velocity, vehicle.position)
        await vehicle.land()


with BackgroundSimulator("copter", "ardupilot", speed=SPEED) as simulated:
    asyncio.run(main(simulated.url))
