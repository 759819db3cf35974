"""MAVSDK flies simulated planes and quadplanes."""

from __future__ import annotations

from math import nan

import pytest

from mavstack.dialects import common
from tests.interop.mavsdk_peer import needs_mavsdk
from tests.interop.simulated import raw_items, simulated_flight

pytestmark = [pytest.mark.interop, needs_mavsdk]

CMD = common.MavCmd


@pytest.mark.nightly
async def test_a_px4_plane() -> None:
    async with simulated_flight("plane", "px4") as flight:
        await flight.wait_for_telemetry("health_all_ok", True)
        assert await flight.call("system", "vehicle_type") == "FIXED_WING"
        await flight.call_ok("action", "set_takeoff_altitude", 30.0)
        await flight.call_ok("action", "arm")
        await flight.call_ok("action", "takeoff")
        await flight.wait_for_telemetry("landed_state", "TAKING_OFF", "IN_AIR")
        await flight.wait_for_telemetry("flight_mode", "HOLD")
        await check_cruise(flight)
        await fly_to_location_and_orbit(flight)
        await flight.call_ok("action", "return_to_launch")
        await flight.wait_for_telemetry("flight_mode", "RETURN_TO_LAUNCH")
        await flight.wait_until(lambda: flight.distance() < 120)
        await flight.call_ok("action", "land")
        await flight.wait_for_telemetry("in_air", False)
        await flight.wait_for_telemetry("armed", False)


async def check_cruise(flight) -> None:
    await flight.wait_for_telemetry("fixedwing_metrics", lambda update: 12 < update["airspeed_m_s"] < 25)
    wind = await flight.wait_for_telemetry("wind", lambda update: update["wind_altitude_msl_m"] > 500)
    assert abs(wind["wind_x_ned_m_s"]) < 3
    await flight.wait_until(lambda: abs(flight.height - 30) < 8)


async def fly_to_location_and_orbit(flight) -> None:
    await flight.call_ok("action", "goto_location_fixedwing", *flight.place(200, 0, 45), 60.0)
    await flight.wait_until(lambda: flight.distance(200, 0) < 80 and flight.height > 38)
    await flight.fly(8)
    assert flight.distance(200, 0) == pytest.approx(60, abs=25)
    await flight.call_ok("action", "do_orbit", -90.0, 0.0, 0, *flight.place(100, 0, 45))
    await flight.wait_until(lambda: abs(flight.distance(100, 0) - 90) < 20)
    await flight.fly(8)
    assert flight.distance(100, 0) == pytest.approx(90, abs=25)
    await flight.call_ok("action", "set_current_speed", 21.0)
    await flight.wait_for_telemetry("fixedwing_metrics", lambda update: update["airspeed_m_s"] > 20)
    await flight.call_ok("action", "hold")


async def test_an_ardupilot_plane_flies_a_mission() -> None:
    async with simulated_flight("plane", "ardupilot") as flight:
        await flight.wait_for_telemetry("health_all_ok", True)
        assert await flight.call("system", "vehicle_type") == "FIXED_WING"
        await flight.call_fails("FAILED", "action", "takeoff")  # planes do not take off by command
        sent = raw_items(
            flight,
            (CMD.NAV_WAYPOINT, 0, 0, 0),
            (CMD.NAV_TAKEOFF, 100, 0, 40),
            (CMD.NAV_WAYPOINT, 300, 0, 50),
            (CMD.NAV_WAYPOINT, 300, 250, 50),
            (CMD.NAV_LOITER_UNLIM, 0, 250, 60),
        )
        with flight.real_time():
            await flight.call_ok("mission_raw", "upload_mission", sent)
        progress = await flight.ground.stream("mission_raw", "subscribe_mission_progress")
        await flight.call_ok("action", "arm")
        await flight.call_ok("mission_raw", "start_mission")
        await flight.wait_for_telemetry("flight_mode", "MISSION")
        for current in range(1, 5):
            await progress.wait_for({"current": current, "total": 5}.__eq__)
        await flight.wait_for_telemetry("fixedwing_metrics", lambda update: 12 < update["airspeed_m_s"] < 25)
        await flight.wait_until(lambda: flight.distance(0, 250) < 90)
        await fly_guided(flight)
        await flight.call_ok("action", "return_to_launch")
        await flight.wait_for_telemetry("flight_mode", "RETURN_TO_LAUNCH")
        await flight.wait_until(lambda: flight.distance() < 110)
        await flight.fly(10)
        assert flight.vehicle.autopilot.armed  # it circles
        assert flight.distance() < 140
        await flight.call_ok("action", "kill")
        await flight.wait_for_telemetry("armed", False)


async def fly_guided(flight) -> None:
    await flight.call_ok("action", "goto_location", *flight.place(-200, 100, 80), nan)
    assert flight.vehicle.autopilot.mode.name == "GUIDED"  # MAVSDK has no name for a plane's guided mode
    await flight.wait_until(lambda: flight.distance(-200, 100) < 90 and flight.height > 72)
    await flight.call_ok("action", "hold")
    await flight.wait_for_telemetry("flight_mode", "HOLD")


@pytest.mark.parametrize("firmware", ["px4", "ardupilot"])
@pytest.mark.flight_cases(1)
async def test_quadplane_transitions(firmware: str) -> None:
    async with simulated_flight(
        "vtol", firmware, **{"px4": {}, "ardupilot": {"Q_RTL_MODE": 1}}[firmware]
    ) as flight:
        await flight.wait_for_telemetry("health_all_ok", True)
        await flight.call_ok("telemetry", "set_rate_vtol_state", 4.0)
        await flight.wait_for_telemetry("vtol_state", "MC")
        if firmware == "ardupilot":
            await flight.call_fails("FAILED", "action", "takeoff")
        await flight.call_ok("action", "set_takeoff_altitude", 30.0)
        await flight.call_ok("action", "arm")
        await flight.call_ok("action", "takeoff")
        await flight.wait_until(lambda: flight.height > 28)
        if firmware == "px4":
            await flight.wait_for_telemetry("flight_mode", "HOLD")
        await flight.call_ok("action", "transition_to_fixedwing")
        await flight.wait_for_telemetry("vtol_state", "TRANSITION_TO_FW", "FW")
        await flight.wait_until(lambda: flight.speed > 14)
        await flight.call_ok("action", "transition_to_multicopter")
        await flight.wait_for_telemetry("vtol_state", "TRANSITION_TO_MC", "MC")
        await flight.wait_until(lambda: flight.speed < 2)
        if firmware == "px4":
            await flight.call_ok("action", "land")
        else:
            await flight.call_fails("UNSUPPORTED", "action", "land")
            await flight.call_ok("action", "return_to_launch")
        await flight.wait_for_telemetry("landed_state", "LANDING", "ON_GROUND")
        await flight.wait_for_telemetry("armed", False)
