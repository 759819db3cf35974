"""Clients of others see the vehicles of a swarm in their slots: MAVSDK one vehicle, MAVProxy another one."""

from __future__ import annotations

import re
from contextlib import asynccontextmanager

import pytest

from mavstack.geodesy import LocalFrame
from mavstack.links import MemoryNetwork
from mavstack.sim.runner import Runner
from mavstack.sim.simulation import Simulation
from mavstack.sim.vehicle_types import DEFAULT_HOME, Firmware, Home, VehicleType
from mavstack.vehicle import connect
from mavstack.vehicle.swarm.launch import take_off
from tests.interop.mavproxy import mavproxy, needs_mavproxy
from tests.interop.mavsdk_peer import mavsdk_peer, needs_mavsdk
from tests.sim.running import make_ready

pytestmark = [pytest.mark.interop, pytest.mark.timeout(240)]
FRAME = LocalFrame(DEFAULT_HOME.latitude, DEFAULT_HOME.longitude, DEFAULT_HOME.altitude)
#: A column of three, 12 metres apart: the last one is 24 metres behind the leader, which is at its home.
SPACING, HEIGHT = 12.0, 10.0


@asynccontextmanager
async def column(number):
    """Fly three copters in a column; yield the port of a link to one of them, and its slot."""
    simulation, network = Simulation(seed=7), MemoryNetwork()
    for index in range(3):
        latitude, longitude, _ = FRAME.to_global(0.0, SPACING * index, 0.0)
        home = Home(latitude, longitude, DEFAULT_HOME.altitude)
        simulation.add(VehicleType.COPTER, Firmware.PX4 if index == 1 else Firmware.ARDUPILOT, home=home)
    make_ready(simulation)
    async with Runner(simulation) as runner, connect(network.link()) as connection:
        await runner.connect(network.link(), simulation.vehicles)
        link = await runner.connect("tcpin://127.0.0.1:0", [simulation.vehicles[number - 1]])
        runner.start()
        group = await connection.wait_for_vehicles(3, timeout=30.0)
        (await take_off(group, HEIGHT)).check()
        async with connection.swarm() as swarm:
            await swarm.formation("column", spacing=SPACING)
            planned, _ = swarm._running._course.state(swarm._running._elapsed)
            place = next(
                row for row, each in zip(planned, swarm.vehicles, strict=True) if each.system == number
            )
            assert place[0] in (pytest.approx(-SPACING, abs=1.0), pytest.approx(-2 * SPACING, abs=1.0))
            yield link.address[1], place


def check(place, latitude, longitude, height):
    north, east, _ = FRAME.to_local(latitude, longitude, 0.0)
    assert (north, east, height) == (
        pytest.approx(place[0], abs=1.0),
        pytest.approx(place[1], abs=1.0),
        pytest.approx(place[2], abs=1.0),
    )


@needs_mavsdk
async def test_mavsdk_sees_a_member_in_its_slot():
    async with column(2) as (port, place), mavsdk_peer(f"tcpout://127.0.0.1:{port}") as ground:
        seen = await (await ground.stream("telemetry", "subscribe_position")).get()
        check(place, seen["latitude_deg"], seen["longitude_deg"], seen["relative_altitude_m"])


@needs_mavproxy
async def test_mavproxy_sees_a_member_in_its_slot(tmp_path):
    async with column(3) as (port, place), mavproxy(port, tmp_path, transport="tcp") as ground:
        await ground.wait_for_output("Detected vehicle 3:1")
        await ground.send_until_answered("status GLOBAL_POSITION_INT", "GLOBAL_POSITION_INT {", "}")
        line = ground.printed[ground.printed.rindex("GLOBAL_POSITION_INT {") :]
        values = {name: float(text) for name, text in re.findall(r"(\w+) : (-?\d+)", line.partition("}")[0])}
        check(place, values["lat"] / 1e7, values["lon"] / 1e7, values["relative_alt"] / 1e3)
