"""Fly two simulated drones in circles near Zermatt, for the dashboard of the browser ground station.

Each sends MAVLink on a TCP port of its own, 5760 and 5761. Ctrl-C ends the program.
"""

import asyncio

from mavstack import LinkError
from mavstack.sim import Home, Runner, Simulation
from mavstack.sim.scenarios import take_off

HOST = "127.0.0.1"
#: Port, home and altitude above home in metres of each drone.
DRONES = (
    (5760, Home(46.0037, 7.7466, 1750, 0), 100.0),
    (5761, Home(46.0037, 7.7518, 1720, 90), 60.0),
)


def simulate() -> Simulation:
    """Return a simulation of both drones, which circle already."""
    simulation = Simulation()
    for _, home, altitude in DRONES:
        take_off(simulation, simulation.add("plane", home=home), altitude)
    return simulation


async def main() -> None:
    """Serve both drones."""
    simulation = simulate()
    async with Runner(simulation) as runner:
        for (port, _, _), drone in zip(DRONES, simulation.vehicles, strict=True):
            try:
                await runner.connect(f"tcpin://{HOST}:{port}", [drone])
            except LinkError as error:
                raise SystemExit(str(error)) from None
        print("two drones fly on the ports", ", ".join(str(port) for port, _, _ in DRONES))
        await runner.run()


if __name__ == "__main__":
    try:
        asyncio.run(main())
    except KeyboardInterrupt:
        print("ended")
