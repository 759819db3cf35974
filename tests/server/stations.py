"""Stations with simulated vehicles, and a client of their API, in virtual time."""

from __future__ import annotations

from contextlib import asynccontextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from mavstack.links import MemoryNetwork
from mavstack.server.access import Access
from mavstack.server.app import make_app
from mavstack.server.station import Station
from mavstack.sim.simulation import Simulation
from mavstack.sim.vehicle_types import Firmware, VehicleType
from mavstack.sim.virtual import run_virtually
from tests.server.asgi import ApiClient
from tests.sim.running import make_ready, reduce_telemetry, running
from tests.waiting import wait_until

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Awaitable, Callable, Sequence

Kind = tuple[VehicleType, Firmware]
COPTER = (VehicleType.COPTER, Firmware.ARDUPILOT)
PX4_COPTER = (VehicleType.COPTER, Firmware.PX4)


@dataclass
class Ground:
    """A station with vehicles, and a client of its API."""

    simulation: Simulation
    station: Station
    api: ApiClient
    network: MemoryNetwork

    async def wait_until(self, holds: Callable[[], object], *, timeout: float = 60.0) -> None:
        await wait_until(holds, timeout=timeout, interval=0.1, now=self.station.connection.now)


@asynccontextmanager
async def ground(
    *kinds: Kind,
    access: Access | None = None,
    full_telemetry: bool = False,
    ready: bool = True,
    folder: Any = None,
) -> AsyncIterator[Ground]:
    """Run vehicles that stand at home, ready to arm, and a station that found them."""
    simulation = Simulation(seed=5)
    for kind, firmware in kinds:
        vehicle = simulation.add(kind, firmware)
        if not full_telemetry:
            reduce_telemetry(vehicle)
    if ready:
        make_ready(simulation)
    network = MemoryNetwork()
    station = Station(folder=folder, telemetry=full_telemetry)
    async with running(simulation, network.link()), station:
        await station.sources.add(network.link())
        if kinds:
            await station.connection.wait_for_vehicles(len(kinds))
        app = make_app(station, access or Access(), static=None)
        yield Ground(simulation, station, ApiClient(app), network)


def serve(
    kinds: Kind | Sequence[Kind], scenario: Callable[[Ground], Awaitable[None]], **options: Any
) -> None:
    """Run a scenario with a station and vehicles in virtual time."""
    listed = [kinds] if kinds and isinstance(kinds[-1], Firmware) else kinds

    async def run() -> None:
        async with ground(*listed, **options) as world:
            await scenario(world)

    run_virtually(run())
