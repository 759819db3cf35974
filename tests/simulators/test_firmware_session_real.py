"""Real firmware in our worlds; the environment names the programs."""

from __future__ import annotations

import asyncio
import os
import sys
import time

import pytest

from mavstack import sync
from mavstack.sim.vehicle_types import Home
from mavstack.simulators.firmware_session import FirmwareOptions, FirmwareSession
from tests.interop.betaflight import URL, betaflight_sitl
from tests.simulators.firmwares import free_port
from tests.simulators.quadrotor import QUADROTOR
from tests.waiting import wait_until

pytestmark = [pytest.mark.interop, pytest.mark.timeout(300)]


def program(variable):
    """Return the program that the environment names, or skip."""
    path = os.environ.get(variable)
    if not path:
        pytest.skip(f"{variable} names no program")
    return path


def out():
    return (f"tcpin://127.0.0.1:{free_port()}",)


def fly(vehicle):
    """Take off, fly a square, and land."""
    vehicle.wait_until_ready()
    vehicle.arm()
    vehicle.takeoff(8)
    start = vehicle.position
    for north, east in ((0.0002, 0.0), (0.0002, 0.0003), (0.0, 0.0003), (0.0, 0.0)):
        vehicle.goto(start.latitude + north, start.longitude + east)
    vehicle.land()


@pytest.mark.parametrize("physics", ["copter", "rotorpy:px4_sihsim_quadx", "mujoco"])
def test_px4_takes_off_flies_a_square_and_lands(firmware, tmp_path, physics):
    binary = program("MAVSTACK_PX4")
    if physics == "mujoco":
        (tmp_path / "quad.xml").write_text(QUADROTOR)
        physics = f"mujoco:{tmp_path / 'quad.xml'}"
    flight = firmware("px4", binary, physics=physics, speed=0.0)
    with sync.connect(flight.url) as connection:
        fly(connection.wait_for_vehicle(timeout=60))
    assert flight.simulator.interface.extra_answers == 0


@pytest.mark.parametrize("physics", ["plane", "jsbsim:c172x", "vtol"])
def test_px4_takes_off_with_wings_and_stays_in_the_air(firmware, physics):
    flight = firmware("px4", program("MAVSTACK_PX4"), physics=physics, speed=0.0, home=Home(52.3, 4.7, 2.0))
    with sync.connect(flight.url) as connection:
        vehicle = connection.wait_for_vehicle(timeout=60)
        vehicle.wait_until_ready()
        vehicle.arm()
        vehicle.takeoff(40)
        end = flight.simulator.time + 60.0
        while flight.simulator.time < end:
            assert flight.simulator.state.position[2] < -15.0, flight.simulator.state
            time.sleep(0.05)


def test_px4_drives_our_rover(firmware):
    flight = firmware("px4", program("MAVSTACK_PX4"), vehicle="rover", speed=0.0)
    with sync.connect(flight.url) as connection:
        vehicle = connection.wait_for_vehicle(timeout=60)
        vehicle.wait_until_ready()
        vehicle.arm()
        home = vehicle.position
        vehicle.goto(home.latitude + 0.0003, home.longitude + 0.0002)
        north, east, _ = flight.simulator.state.position
        assert (north, east) == pytest.approx((33.4, 15.1), abs=5.0)


def test_arduplane_takes_off_on_jsbsim(firmware):
    slow = {"ARSPD_FBW_MIN": 28, "ARSPD_FBW_MAX": 50, "TRIM_ARSPD_CM": 3600, "TKOFF_ROTATE_SPD": 30}
    flight = firmware(
        "ardupilot",
        program("MAVSTACK_ARDUPLANE"),
        vehicle="plane",
        physics="jsbsim:c172x",
        speed=0.0,
        out=out(),
        parameters={**slow, "TKOFF_ALT": 50, "TKOFF_LVL_ALT": 15, "THR_MAX": 100},
    )
    with sync.connect(flight.url) as connection:
        vehicle = connection.wait_for_vehicle(timeout=60)
        vehicle.wait_until_ready()
        vehicle.set_mode("TAKEOFF")
        vehicle.arm(allow_flight=True)
        end = time.monotonic() + 150
        while flight.simulator.state.position[2] > -30.0:
            assert time.monotonic() < end, flight.simulator.state
            time.sleep(0.2)
    assert flight.simulator.interface.invalid == 0


def test_ardurover_drives_our_body(firmware):
    flight = firmware(
        "ardupilot", program("MAVSTACK_ARDUROVER"), vehicle="rover", speed=0.0, instance=3, out=out()
    )
    with sync.connect(flight.url) as connection:
        vehicle = connection.wait_for_vehicle(timeout=60)
        vehicle.wait_until_ready()
        vehicle.arm()
        home = vehicle.position
        vehicle.goto(home.latitude + 0.0003, home.longitude + 0.0002)
        north, east, _ = flight.simulator.state.position
        assert (north, east) == pytest.approx((33.4, 15.1), abs=5.0)
    assert flight.events == ["ArduPilot is connected"]


async def test_betaflight_arms_and_lifts_our_body(tmp_path):
    binary = program("MAVSTACK_BETAFLIGHT_SITL")
    with betaflight_sitl(tmp_path) as sitl:
        await sitl.start()
        switch = "aux 0 0 0 1700 2100 0 0"
        setting = await asyncio.create_subprocess_exec(
            sys.executable, "-m", "mavstack", "msp", "cli", URL, "-c", switch, "--save"
        )
        await sitl.wait_for_exit()
        await asyncio.wait_for(setting.wait(), 60)
        options = FirmwareOptions("betaflight", binary=binary, folder=tmp_path)
        async with FirmwareSession(options) as session:
            run = asyncio.ensure_future(session.run())
            world = session.simulator
            await wait_until(lambda: world.time > 8.0, "Betaflight has started")
            world.set_sticks((1500, 1500, 1000, 1500, 2000))
            await wait_until(lambda: min(world.interface.controls) > 0.04, "Betaflight is armed")
            world.set_sticks((1500, 1500, 1600, 1500, 2000))
            await wait_until(lambda: world.state.position[2] < -10.0, "it is 10 m up")
            assert abs(world.state.rates[2]) < 0.2, "it does not spin"
            run.cancel()
