"""Rangefinders and obstacles as values of a vehicle."""

from __future__ import annotations

import asyncio
from math import inf
from typing import TYPE_CHECKING

import pytest

from mavstack.links import MemoryNetwork
from mavstack.sim import Obstacle, Rangefinder, Simulation, run_virtually
from mavstack.vehicle import connect
from mavstack.vehicle.telemetry.surroundings import Obstacles
from tests.sim.running import make_ready, running

if TYPE_CHECKING:
    from mavstack.vehicle import Vehicle


def test_a_vehicle_with_two_rangefinders_and_a_proximity_sensor():
    async def flight() -> None:
        simulation = Simulation(seed=1)
        simulation.add_obstacle(Obstacle(12.0, 0.0, 2.0))
        finders = (Rangefinder.parse("downward"), Rangefinder.parse("forward:sonar"))
        simulated = simulation.add("copter", "px4", rangefinders=finders)
        make_ready(simulation)
        network = MemoryNetwork()
        async with running(simulation, network.link()), connect(network.link()) as node:
            vehicle: Vehicle = await node.wait_for_vehicle(1)
            assert (dict(vehicle.distances), vehicle.obstacles) == ({}, None)
            await asyncio.sleep(5)
            down, forward = vehicle.distances[0], vehicle.distances[1]
            assert (down.orientation, down.kind, down.max_distance) == (25, 0, 40.0)
            assert (forward.orientation, forward.kind) == (0, 1)
            found = vehicle.obstacles
            assert (len(found.distances), found.increment, found.from_north) == (72, 5.0, False)
            metres, bearing = found.nearest
            assert metres == pytest.approx(10.0, abs=0.2)
            assert abs((bearing + simulated.body.home.heading + 180) % 360 - 180) < 15
            simulated.cut(True)
            await asyncio.sleep(8)
            assert (dict(vehicle.distances), vehicle.obstacles) == ({}, None)

    run_virtually(flight())


def test_the_nearest_obstacle():
    assert Obstacles((None, inf), 5.0).nearest is None
    assert Obstacles((None, 4.0, 3.0, inf), 10.0, 350.0).nearest == (3.0, 10.0)
