"""MAVProxy's modules that feed a vehicle: corrections and positions, and aircraft that it shows."""

from __future__ import annotations

import asyncio
import json
import socket

import pytest

from mavstack.dialects import common
from mavstack.sim import Simulation
from mavstack.wire import encode
from tests.gnss.test_rtcm import msm, station
from tests.interop.mavproxy import mavproxy, needs_mavproxy
from tests.interop.simulated import Flight
from tests.sim.running import running

pytestmark = [pytest.mark.interop, pytest.mark.timeout(240), needs_mavproxy]

FIX = common.GpsFixType


def free_port() -> int:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


async def test_modules_that_feed_a_vehicle(tmp_path) -> None:
    simulation = Simulation()
    vehicle = simulation.add("copter", "ardupilot", remote_id=True)
    async with (
        running(simulation, "tcpin://127.0.0.1:0") as simulated,
        mavproxy(simulated.link.address[1], tmp_path, modules="adsb,output", transport="tcp") as console,
    ):
        flight = Flight(vehicle, console, simulated)
        await console.wait_for_output("Detected vehicle 1:1")
        await check_corrections(flight)
        await check_aircraft(flight)
        await check_remote_id(flight)
        await check_positions(flight)
        assert not [each for each in ("GPS Inject Failed", "GPS Input Failed") if each in console.printed]


async def check_corrections(flight: Flight) -> None:
    """DGPS sends corrections in fragments; MAVProxy 1.8.75 fails at a frame whose last one is full."""
    port = free_port()
    await load(flight, "DGPS")
    flight.ground.send_line(f"dgps set portnum {port}")
    await flight.ground.wait_for_output(f"Listening for RTCM packets on UDP://127.0.0.1:{port}")
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as base:
        for epoch in range(60):
            for frame in (station(), msm(1074, epoch, 250), msm(1084, epoch, 400)):
                base.sendto(frame.data, ("127.0.0.1", port))
                await asyncio.sleep(0.1)
            if flight.vehicle.body.sensors.gps_fix >= FIX.RTK_FLOAT:
                break
    assert flight.vehicle.body.sensors.gps_fix >= FIX.RTK_FLOAT


async def check_aircraft(flight: Flight) -> None:
    """An aircraft that the vehicle reports is counted; MAVProxy lists it only with its map."""
    place = flight.place(500.0, 0.0, 200.0)
    flags = common.AdsbFlags.VALID_COORDS | common.AdsbFlags.VALID_ALTITUDE
    report = common.AdsbVehicle(
        ICAO_address=0x4CA2D6, lat=round(place[0] * 1e7), lon=round(place[1] * 1e7),
        altitude=round(place[2] * 1e3), callsign="RYR1427", emitter_type=3, flags=flags,
    )  # fmt: skip
    port = flight.vehicle.open_port("receiver")
    for _ in range(100):
        flight.vehicle.receive(port, encode(report, system=1, component=156))
        flight.ground.send_line("adsb status")
        await asyncio.sleep(0.3)
        if "total threat count: 1" in flight.ground.printed:
            return
    raise AssertionError(flight.ground.printed[-500:])


async def check_remote_id(flight: Flight) -> None:
    """OpenDroneID sends to the autopilot, which passes the messages to the module."""
    module = flight.vehicle.remote_id
    assert module.ardupilot_problem == "UA_TYPE required in BasicID"
    await load(flight, "fakegps")  # it sets the position of the ground station
    flight.ground.send_line("module unload fakegps")
    await load(flight, "OpenDroneID")
    for setting in ("UAS_ID_type 1", "UAS_ID 1596F350", "UA_type 2", "rate_hz 2"):
        flight.ground.send_line(f"opendroneid set {setting}")
    for _ in range(200):
        await asyncio.sleep(0.1)
        if not module.ardupilot_problem:
            break
    assert module.ardupilot_problem == ""


async def check_positions(flight: Flight) -> None:
    """GPSInput sends positions, which a vehicle with its receiver at MAVLink takes."""
    flight.vehicle.parameters.set("GPS1_TYPE", 14)
    flight.vehicle.reboot()
    port = free_port()
    await load(flight, "GPSInput")
    flight.ground.send_line(f"GPSInput.port {port}")
    await flight.ground.wait_for_output(f"UDP://127.0.0.1:{port}")
    latitude, longitude, altitude = flight.place(500.0, -300.0)
    fix = {
        "fix_type": 3, "lat": round(latitude * 1e7), "lon": round(longitude * 1e7), "alt": altitude,
        "ignore_flags": 0, "satellites_visible": 11, "horiz_accuracy": 1.0, "vert_accuracy": 1.5,
    }  # fmt: skip
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as receiver:
        for _ in range(200):
            receiver.sendto(json.dumps(fix).encode(), ("127.0.0.1", port))
            await asyncio.sleep(0.1)
            if flight.vehicle.autopilot.has_position:
                break
    here = flight.vehicle.body.estimate
    assert (here.north, here.east) == (pytest.approx(500.0, abs=3), pytest.approx(-300.0, abs=3))


async def load(flight: Flight, module: str) -> None:
    flight.ground.send_line(f"module load {module}")
    await flight.ground.wait_for_output(f"Loaded module {module}")
