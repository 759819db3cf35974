"""The flights of `mav demo --swarm`: six copters fly a formation, a show and a search, again and again."""

from __future__ import annotations

import asyncio
import math
from typing import TYPE_CHECKING, Final

from mavstack.cli.demo.flights import end_of_flight
from mavstack.errors import MavstackError
from mavstack.geodesy import LocalFrame
from mavstack.sim.vehicle_types import DEFAULT_HOME, Firmware, Home, VehicleType
from mavstack.swarm.search.missions import MissionOptions
from mavstack.swarm.separation import import_libraries
from mavstack.swarm.shows.show import Curve, Show, ShowVehicle, Trajectory
from mavstack.vehicle import connect
from mavstack.vehicle.swarm.launch import take_off

if TYPE_CHECKING:
    from collections.abc import Callable

    from mavstack.links import MemoryNetwork
    from mavstack.sim.simulation import Simulation
    from mavstack.sim.vehicle import SimulatedVehicle
    from mavstack.vehicle import Connection, Group

#: The number of copters, which run PX4 and ArduPilot in turn.
COUNT: Final = 6
#: System id of the program that flies the swarm.
_OWN_SYSTEM: Final = 253
_SPACING: Final = 10.0
_HEIGHT: Final = 15.0
_RADIUS: Final = 15.0
#: Seconds of the circle that the show flies, of the climb before it and of the descent after it.
_CIRCLE: Final = 60.0
_CLIMB: Final = 14.0
#: Number of Bézier curves that form the circle.
_ARCS: Final = 8


def add_swarm(simulation: Simulation) -> list[SimulatedVehicle]:
    """Add the copters to a simulation, side by side."""
    import_libraries()  # in a thread during the flight, simulated time would pass meanwhile
    frame = LocalFrame(DEFAULT_HOME.latitude, DEFAULT_HOME.longitude, DEFAULT_HOME.altitude)
    vehicles = []
    for index in range(COUNT):
        latitude, longitude, _ = frame.to_global(0.0, _SPACING * index, 0.0)
        firmware = Firmware.PX4 if index % 2 else Firmware.ARDUPILOT
        home = Home(latitude, longitude, DEFAULT_HOME.altitude)
        vehicles.append(simulation.add(VehicleType.COPTER, firmware, home=home))
    return vehicles


async def fly_swarm(network: MemoryNetwork, announce: Callable[[str], None]) -> None:
    """Fly the copters without end.

    Args:
        network: The network of the copters.
        announce: Called with a line about each part.
    """
    async with connect(network.link(), system=_OWN_SYSTEM) as connection:
        group = await connection.wait_for_vehicles(COUNT, timeout=None)
        (await group.each(lambda vehicle: vehicle.wait_until_ready(), name="waiting for")).check()
        while True:
            try:
                announce("takeoff")
                (await take_off(group, _HEIGHT)).check()
                await _fly_formations(connection, announce)
                await _search(group, announce)
            except MavstackError as error:
                announce(f"landing, since {error}")
                await group.land_all()


async def _fly_formations(connection: Connection, announce: Callable[[str], None]) -> None:
    async with connection.swarm() as swarm:
        announce("formation wedge")
        await swarm.formation("wedge", spacing=_SPACING)
        announce("moving 30 m north")
        await swarm.move(north=30.0)
        announce("turning by 90 degrees")
        await swarm.rotate(90.0)
        announce("a show on a circle")
        await swarm.show(circle_show())
        announce(f"smallest separation so far: {swarm.smallest_separation:.1f} m")


async def _search(group: Group, announce: Callable[[str], None]) -> None:
    announce("searching in strips, then home")
    frame = LocalFrame(DEFAULT_HOME.latitude, DEFAULT_HOME.longitude, DEFAULT_HOME.altitude)
    latitude, longitude, _ = frame.to_global(80.0, 30.0, 0.0)
    mission = MissionOptions(altitude=_HEIGHT, layer_spacing=5.0, speed=8.0)
    results = await group.search("parallel", (latitude, longitude), size=120.0, spacing=15.0, mission=mission)
    results.check()
    await asyncio.gather(*(end_of_flight(vehicle.component) for vehicle in group))


def circle_show() -> Show:
    """Return a show: up, once around a circle, down."""
    return Show("circle", [_circling(2.0 * math.pi * index / COUNT, index) for index in range(COUNT)])


def _circling(begin: float, index: int) -> ShowVehicle:
    step = 2.0 * math.pi / _ARCS
    reach = 4.0 / 3.0 * math.tan(step / 4.0) * _RADIUS
    first = _on_circle(begin, 0.0)
    ground, top = (*first, 0.0), (*first, _HEIGHT)
    curves = [Curve(0.0, _CLIMB, (ground, ground, top, top))]
    for arc in range(_ARCS):
        start, end = begin + arc * step, begin + (arc + 1) * step
        # The first arc begins at rest, and the last one ends at rest.
        points = (
            (*_on_circle(start, 0.0), _HEIGHT),
            (*_on_circle(start, reach if arc else 0.0), _HEIGHT),
            (*_on_circle(end, -reach if arc < _ARCS - 1 else 0.0), _HEIGHT),
            (*_on_circle(end, 0.0), _HEIGHT),
        )
        curves.append(Curve(_CLIMB + arc * _CIRCLE / _ARCS, _CIRCLE / _ARCS, points))
    last = curves[-1].points[-1]
    down = (last[0], last[1], 0.0)
    curves.append(Curve(_CLIMB + _CIRCLE, 2.0 * _CLIMB, (last, last, down, down)))
    return ShowVehicle(f"vehicle {index + 1}", Trajectory(curves))


def _on_circle(angle: float, along: float) -> tuple[float, float]:
    """Return a place on the circle, moved along its tangent."""
    cosine, sine = math.cos(angle), math.sin(angle)
    return _RADIUS * cosine - along * sine, _RADIUS * sine + along * cosine
