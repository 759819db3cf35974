"""A TCP connection whose server restarts."""

from __future__ import annotations

import asyncio
import socket

import pytest

from mavstack.dialects import common
from mavstack.errors import CommandTimeout
from mavstack.sim.runner import Runner
from mavstack.sim.simulation import Simulation
from mavstack.sim.vehicle_types import Firmware, VehicleType
from mavstack.vehicle import VehicleEvent, VehicleLost, VehicleReturned, connect

pytestmark = pytest.mark.interop


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


async def test_a_server_restarts():
    simulation, port = Simulation(seed=3), free_port()
    simulation.add(VehicleType.COPTER, Firmware.ARDUPILOT)
    first = Runner(simulation)
    await first.connect(f"tcpin://127.0.0.1:{port}", simulation.vehicles)
    first.start()
    async with asyncio.timeout(60), connect(f"tcpout://127.0.0.1:{port}?retry=200ms") as connection:
        vehicle = await connection.wait_for_vehicle()
        telemetry = connection.stream(common.Heartbeat, system=1)
        events = connection.events(VehicleEvent)
        await first.close()
        lost = await anext(events)
        assert isinstance(lost, VehicleLost)
        assert f"its link tcpout 127.0.0.1:{port} is closed" in lost.reason
        with pytest.raises(CommandTimeout, match="1/1"):
            await vehicle.component.command(common.MavCmd.DO_SET_HOME, 1, timeout=2)
        telemetry.drain()
        async with Runner(simulation) as second:
            await second.connect(f"tcpin://127.0.0.1:{port}", simulation.vehicles)
            second.start()
            back = await anext(events)
            assert isinstance(back, VehicleReturned)
            assert back.vehicle is vehicle
            assert 1.0 < back.after < 60.0
            await anext(telemetry)
            assert (await vehicle.params.get("RTL_ALT")).value > 0
        assert [type(event) for event in events.drain() if not isinstance(event, VehicleLost)] == []
