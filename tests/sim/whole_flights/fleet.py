"""Twelve vehicles in one simulation, each flown by the ground station as users of its firmware do."""

from __future__ import annotations

import asyncio
from contextlib import asynccontextmanager
from math import hypot
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.links import MemoryNetwork
from mavstack.node import Node
from mavstack.sim.simulation import RATE, Simulation
from mavstack.sim.vehicle_types import Firmware, VehicleType
from mavstack.sim.virtual import run_virtually
from tests.sim.running import impaired_link, reduce_telemetry, running
from tests.sim.whole_flights.ground_station import SAMPLES, Flight, Sample, Station

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Callable, Sequence

    from mavstack.node import RemoteComponent
    from mavstack.sim.vehicle import SimulatedVehicle
    from tests.sim.whole_flights.plans import FlightPlan

CMD = common.MavCmd
ALL = [(kind, firmware) for kind in VehicleType for firmware in Firmware]
#: Speed below which a vehicle that does not disarm by itself is at rest, in m/s.
AT_REST = 0.2
#: Time until a vehicle at rest moves after an item began, in seconds.
START_DELAY = 6.0


@asynccontextmanager
async def station(simulation: Simulation, **impairment: float) -> AsyncIterator[Station]:
    """Provide a ground station with the vehicles of a simulation on one link."""
    network = MemoryNetwork()
    async with (
        running(simulation, network.link()) as simulated,
        Node(impaired_link(network, **impairment)) as node,
    ):
        ground = Station(simulation, node)
        tasks = [asyncio.create_task(ground.listen()), asyncio.create_task(ground.listen_to_texts())]
        try:
            yield ground
        finally:
            for task in tasks:
                task.cancel()
            simulated.raise_error()


def record(simulation: Simulation, flights: dict[int, Flight]) -> None:
    """Record the true motion of all vehicles."""
    steps, every = 0, round(1.0 / (SAMPLES * simulation.step_length))

    def sample_all(elapsed: float) -> None:
        nonlocal steps
        steps += 1
        if steps % every == 0:
            for vehicle in simulation.vehicles:
                flights[vehicle.address.system].track.append(sample(vehicle, elapsed))

    simulation.before_step.append(sample_all)


def sample(vehicle: SimulatedVehicle, elapsed: float) -> Sample:
    body = vehicle.body
    return Sample(
        elapsed,
        body.truth,
        body.battery,
        body.airspeed,
        body.throttle,
        body.on_ground,
        body.transition,
        vehicle.autopilot.armed,
    )


def fly_all(
    plan_of: Callable[[VehicleType, Firmware], FlightPlan],
    kinds: Sequence[tuple[VehicleType, Firmware]] = ALL,
    *,
    wind: float = 0.0,
    rate: float = RATE,
    logs: Sequence[tuple[VehicleType, Firmware]] = (),
    **impairment: float,
) -> dict[tuple[VehicleType, Firmware], Flight]:
    """Fly all vehicles side by side; return the flight of each."""
    simulation = Simulation(seed=7, rate=rate)
    simulation.world.set_wind(speed=wind, direction=250, turbulence=0.15 if wind else 0.0)
    flights: dict[int, Flight] = {}
    for kind, firmware in kinds:
        vehicle = simulation.add(kind, firmware)
        reduce_telemetry(vehicle)
        flights[vehicle.address.system] = Flight(plan_of(kind, firmware))
    record(simulation, flights)

    async def fly_fleet() -> None:
        async with station(simulation, **impairment) as ground, asyncio.TaskGroup() as group:
            for system, flight in flights.items():
                flight.journal = ground.journal(system)
                with_log = (flight.kind, flight.plan.firmware) in logs
                group.create_task(fly(ground, system, flight, with_log))

    run_virtually(fly_fleet())
    return {(flight.kind, flight.plan.firmware): flight for flight in flights.values()}


async def fly(ground: Station, system: int, flight: Flight, with_log: bool) -> None:
    """Run one flight, from the first heartbeat to the last log."""
    remote, journal = await ground.node.wait_for_autopilot(system), flight.journal
    name = f"{flight.kind} of {flight.plan.firmware}"
    await ground.wait_until(lambda: journal.ready, f"{name} ready", timeout=60)
    await remote.mission.upload(flight.plan.items)
    flight.downloaded = (await remote.mission.download()).items
    await start(remote, flight)
    flight.began = ground.now
    if flight.kind.flies:
        await ground.wait_until(lambda: journal.armed, f"{name} armed", timeout=5)
        await ground.wait_until(lambda: not journal.armed, f"{name} landed")
    else:
        last = flight.plan.order[-1]
        await ground.wait_until(
            lambda: any(seq == last for _, seq in journal.current), f"{name} at its last item"
        )
        await asyncio.sleep(START_DELAY)
        await ground.wait_until(lambda: at_rest(flight), f"{name} at rest", timeout=120)
        await remote.command(CMD.COMPONENT_ARM_DISARM, 0)
    flight.ended = ground.now
    await asyncio.sleep(2.5)
    flight.logs = await remote.logs.list()
    if with_log:
        flight.log = await remote.logs.download(flight.logs[-1])


async def start(remote: RemoteComponent, flight: Flight) -> None:
    """Start the mission."""
    if flight.plan.firmware is Firmware.PX4:
        await remote.modes.set("MISSION")
        await remote.command(CMD.COMPONENT_ARM_DISARM, 1)
    elif flight.kind in (VehicleType.PLANE, VehicleType.VTOL):
        await remote.modes.set("AUTO")
        await remote.command(CMD.COMPONENT_ARM_DISARM, 1)
    else:
        await remote.command(CMD.COMPONENT_ARM_DISARM, 1)
        await remote.modes.set("AUTO")
        await remote.command(CMD.MISSION_START)


def at_rest(flight: Flight) -> bool:
    """Return whether the vehicle has not moved for some seconds."""
    return all(hypot(*each.motion[3:6]) < AT_REST for each in flight.track[-25:])
