"""Simulated vehicles, and a connection to them, in virtual time."""

from __future__ import annotations

from contextlib import asynccontextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING

from mavstack.links import MemoryNetwork
from mavstack.sim.simulation import Simulation
from mavstack.sim.vehicle_types import Firmware, VehicleType
from mavstack.sim.virtual import run_virtually
from mavstack.vehicle import Connection, connect
from tests.sim.running import impaired_link, make_ready, running
from tests.waiting import wait_until

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Awaitable, Callable, Sequence

    from mavstack.services.version import FirmwareVersion
    from mavstack.sim.vehicle import SimulatedVehicle
    from mavstack.vehicle import Vehicle

ARDUPILOT, PX4 = Firmware.ARDUPILOT, Firmware.PX4
Kind = tuple[VehicleType, Firmware]
ALL: list[Kind] = [(kind, firmware) for kind in VehicleType for firmware in Firmware]
FLYING = [(kind, firmware) for kind, firmware in ALL if kind.flies]


def kind_name(kind: Kind) -> str:
    return "-".join(kind)


@dataclass
class World:
    """A simulation, the connection to its vehicles, and the network between them."""

    simulation: Simulation
    node: Connection
    network: MemoryNetwork

    @property
    def simulated(self) -> SimulatedVehicle:
        return self.simulation.vehicles[0]

    async def wait_until(self, holds: Callable[[], bool], *, timeout: float = 60.0) -> None:
        await wait_until(holds, timeout=timeout, interval=0.1, now=self.node.now)


@asynccontextmanager
async def world(
    *kinds: Kind,
    ready: bool = True,
    payloads: bool = False,
    prepare: Callable[[SimulatedVehicle], None] | None = None,
    version: FirmwareVersion | None = None,
    **conditions: float,
) -> AsyncIterator[World]:
    """Run vehicles that stand at home, ready to arm, and a connection to them."""
    simulation = Simulation(seed=5)
    for kind, firmware in kinds:
        vehicle = simulation.add(kind, firmware, camera=payloads, gimbal=payloads, version=version)
        if prepare is not None:
            prepare(vehicle)
    if ready:
        make_ready(simulation)
    network = MemoryNetwork()
    link = impaired_link(network, **conditions)
    async with running(simulation, network.link()), connect(link) as node:
        yield World(simulation, node, network)


def fly(
    kind: Kind | Sequence[Kind],
    scenario: Callable[[World, Vehicle], Awaitable[None]],
    *,
    ready: bool = True,
    payloads: bool = False,
    prepare: Callable[[SimulatedVehicle], None] | None = None,
    version: FirmwareVersion | None = None,
    **conditions: float,
) -> World:
    """Run a scenario with a vehicle (the first of several) in virtual time."""
    kinds = [kind] if isinstance(kind[1], Firmware) else kind

    async def run() -> World:
        options = {"ready": ready, "payloads": payloads, "prepare": prepare, "version": version}
        async with world(*kinds, **options, **conditions) as flown:
            await scenario(flown, await flown.node.wait_for_vehicle(1))
            return flown

    return run_virtually(run())
