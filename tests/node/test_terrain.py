"""Terrain from end to end: a connection serves it, a vehicle asks for it, and tells that it has it."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.errors import RemoteTimeout
from mavstack.links import MemoryNetwork
from mavstack.node import Node
from mavstack.services.terrain import TerrainCheckServer, TerrainClient, TerrainMap
from mavstack.sim.virtual import run_virtually
from mavstack.vehicle import connect
from tests.services.terrain.check_helpers import report_of
from tests.services.terrain.heights import PLACE, hills

QUADROTOR, ARDUPILOT = common.MavType.QUADROTOR, common.MavAutopilot.ARDUPILOTMEGA


def with_vehicle(work) -> None:
    """Run work with a vehicle that wants the terrain of one place."""

    async def run() -> None:
        network, terrain = MemoryNetwork(), TerrainMap()
        autopilot = Node(network.link(), system=1, component=1, type=QUADROTOR, autopilot=ARDUPILOT)
        autopilot.serve(TerrainCheckServer(autopilot.address, report_of(terrain)))
        autopilot.serve(TerrainClient(autopilot.address, terrain, lambda: [PLACE]))
        async with connect(network.link()) as connection, autopilot:
            await work(connection, await connection.wait_for_vehicle())

    run_virtually(run())


def test_a_connection_serves_terrain() -> None:
    async def work(connection, vehicle) -> None:
        assert not (await vehicle.terrain.check(*PLACE)).is_known
        server = connection.serve_terrain(hills)
        steps: list = []
        await vehicle.terrain.wait_until_loaded(PLACE, progress=lambda *step: steps.append(step))
        state = await vehicle.terrain.check(*PLACE)
        assert state.terrain_height == pytest.approx(hills(*PLACE), abs=4)
        assert (state.loaded, state.pending, server.sent) == (56, 0, 56)
        assert steps[-1] == (1, 1)
        assert vehicle.terrain is vehicle.component.terrain

    with_vehicle(work)


def test_no_ground_station_serves_terrain() -> None:
    async def work(connection, vehicle) -> None:
        with pytest.raises(RemoteTimeout, match="no tile arrived"):
            await vehicle.terrain.wait_until_loaded(PLACE)

    with_vehicle(work)


def test_a_vehicle_without_the_protocol() -> None:
    async def run() -> None:
        network = MemoryNetwork()
        autopilot = Node(network.link(), system=1, component=1, type=QUADROTOR, autopilot=12)
        async with connect(network.link()) as connection, autopilot:
            vehicle = await connection.wait_for_vehicle()
            with pytest.raises(RemoteTimeout, match="checking the terrain of 1/1 failed after 6 attempts"):
                await vehicle.terrain.check(*PLACE)

    run_virtually(run())
