"""Simulations with links, in an event loop.

`make_ready` boots all vehicles, `running` connects them to a link.
"""

from __future__ import annotations

from contextlib import asynccontextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING

from mavstack.links import Impairment, impair
from mavstack.sim.runner import Runner
from mavstack.sim.scenarios import run_until
from mavstack.sim.telemetry.px4 import LinkMode, set_link_mode
from mavstack.sim.vehicle_types import Firmware

if TYPE_CHECKING:
    import asyncio
    from collections.abc import AsyncIterator

    from mavstack.links import Link, MemoryNetwork
    from mavstack.sim.simulation import Simulation
    from mavstack.sim.vehicle import SimulatedVehicle


#: Seconds from boot until a vehicle has a position and can be armed.
SETTLING_TIME = 15.0


#: ArduPilot's streams; the values are their rates in hertz over a slow radio.
_STREAMS = dict.fromkeys(("RAW_SENS", "RC_CHAN", "RAW_CTRL", "EXTRA1", "EXTRA2", "EXTRA3"), 0) | {
    "EXT_STAT": 1,
    "POSITION": 1,
}


def reduce_telemetry(vehicle: SimulatedVehicle) -> None:
    """Make a vehicle send little, since telemetry would take most of a test's time."""
    if vehicle.firmware is Firmware.PX4:
        set_link_mode(vehicle, LinkMode.MINIMAL)
        return
    for stream, rate in _STREAMS.items():
        vehicle.parameters.set(f"SR0_{stream}", rate)


def make_ready(simulation: Simulation) -> None:
    """Advance until all vehicles can be armed, and drop the data that they sent meanwhile."""
    for vehicle in simulation.vehicles:
        run_until(simulation, lambda vehicle=vehicle: vehicle.autopilot.booted)
    simulation.advance(simulation.now + SETTLING_TIME)
    for vehicle in simulation.vehicles:
        vehicle.data_to_send()


@dataclass(frozen=True, slots=True)
class RunningSimulation:
    """A simulation that advances in a task, with all its vehicles on one link."""

    runner: Runner
    link: Link
    task: asyncio.Task[None]

    def raise_error(self) -> None:
        """Raise the error that ended the simulation, if any."""
        if self.task.done() and not self.task.cancelled():
            self.task.result()


@asynccontextmanager
async def running(
    simulation: Simulation, link: str | Link, *, speed: float = 1.0
) -> AsyncIterator[RunningSimulation]:
    """Connect all vehicles to a link and advance them; at the end an error of the simulation is raised."""
    async with Runner(simulation, speed=speed) as runner:
        opened = await runner.connect(link, simulation.vehicles)
        advancing = RunningSimulation(runner, opened, runner.start())
        yield advancing
        advancing.raise_error()


def impaired_link(network: MemoryNetwork, **impairment: float) -> Link:
    """Return a link of the network, with loss, latency and so on if any are given."""
    return impair(network.link(), Impairment(**impairment)) if impairment else network.link()
