"""MAVSDK flies our simulated planes and quadplanes."""

from __future__ import annotations

from math import nan

import pytest

from mavstack.dialects import common
from tests.interop.mavsdk_peer import needs_mavsdk
from tests.interop.simulated import in_flight, raw_items

pytestmark = [pytest.mark.interop, needs_mavsdk]

CMD = common.MavCmd


async def test_a_px4_plane() -> None:
    async with in_flight("plane", "px4") as flight:
        await flight.hears("health_all_ok", True)
        assert await flight.call("system", "vehicle_type") == "FIXED_WING"
        await flight.does("action", "set_takeoff_altitude", 30.0)
        await flight.does("action", "arm")
        await flight.does("action", "takeoff")
        await flight.hears("landed_state", "TAKING_OFF", "IN_AIR")
        await flight.hears("flight_mode", "HOLD")
        await flies_on_its_wing(flight)
        await goes_somewhere(flight)
        await flight.does("action", "return_to_launch")
        await flight.hears("flight_mode", "RETURN_TO_LAUNCH")
        await flight.until(lambda: flight.distance() < 120)
        await flight.does("action", "land")
        await flight.hears("in_air", False)
        await flight.hears("armed", False)


async def flies_on_its_wing(flight) -> None:
    await flight.hears("fixedwing_metrics", lambda heard: 12 < heard["airspeed_m_s"] < 25)
    wind = await flight.hears("wind", lambda heard: heard["wind_altitude_msl_m"] > 500)
    assert abs(wind["wind_x_ned_m_s"]) < 3
    await flight.until(lambda: abs(flight.height - 30) < 8)


async def goes_somewhere(flight) -> None:
    """And circles there."""
    await flight.does("action", "goto_location_fixedwing", *flight.place(200, 0, 45), 60.0)
    await flight.until(lambda: flight.distance(200, 0) < 80 and flight.height > 38)
    await flight.fly(8)
    assert flight.distance(200, 0) == pytest.approx(60, abs=25)
    await flight.does("action", "do_orbit", -90.0, 0.0, 0, *flight.place(100, 0, 45))
    await flight.until(lambda: abs(flight.distance(100, 0) - 90) < 20)
    await flight.fly(8)
    assert flight.distance(100, 0) == pytest.approx(90, abs=25)
    await flight.does("action", "set_current_speed", 21.0)
    await flight.hears("fixedwing_metrics", lambda heard: heard["airspeed_m_s"] > 20)
    await flight.does("action", "hold")


async def test_an_ardupilot_plane_flies_a_mission() -> None:
    async with in_flight("plane", "ardupilot") as flight:
        await flight.hears("health_all_ok", True)
        assert await flight.call("system", "vehicle_type") == "FIXED_WING"
        await flight.refuses("FAILED", "action", "takeoff")  # a plane does not by command
        sent = raw_items(
            flight,
            (CMD.NAV_WAYPOINT, 0, 0, 0),
            (CMD.NAV_TAKEOFF, 100, 0, 40),
            (CMD.NAV_WAYPOINT, 300, 0, 50),
            (CMD.NAV_WAYPOINT, 300, 250, 50),
            (CMD.NAV_LOITER_UNLIM, 0, 250, 60),
        )
        with flight.by_the_clock():
            await flight.does("mission_raw", "upload_mission", sent)
        progress = await flight.ground.stream("mission_raw", "subscribe_mission_progress")
        await flight.does("action", "arm")
        await flight.does("mission_raw", "start_mission")
        await flight.hears("flight_mode", "MISSION")
        for current in range(1, 5):
            await progress.until({"current": current, "total": 5}.__eq__)
        await flight.hears("fixedwing_metrics", lambda heard: 12 < heard["airspeed_m_s"] < 25)
        await flight.until(lambda: flight.distance(0, 250) < 90)
        await flies_guided(flight)
        await flight.does("action", "return_to_launch")
        await flight.hears("flight_mode", "RETURN_TO_LAUNCH")
        await flight.until(lambda: flight.distance() < 110)
        await flight.fly(10)
        assert flight.vehicle.autopilot.armed  # it circles
        assert flight.distance() < 140
        await flight.does("action", "kill")
        await flight.hears("armed", False)


async def flies_guided(flight) -> None:
    await flight.does("action", "goto_location", *flight.place(-200, 100, 80), nan)
    assert flight.vehicle.autopilot.mode.name == "GUIDED"  # MAVSDK has no name for a plane's
    await flight.until(lambda: flight.distance(-200, 100) < 90 and flight.height > 72)
    await flight.does("action", "hold")
    await flight.hears("flight_mode", "HOLD")


@pytest.mark.parametrize("firmware", ["px4", "ardupilot"])
async def test_a_quadplane_changes_over(firmware: str) -> None:
    async with in_flight("vtol", firmware, **{"px4": {}, "ardupilot": {"Q_RTL_MODE": 1}}[firmware]) as flight:
        await flight.hears("health_all_ok", True)
        await flight.does("telemetry", "set_rate_vtol_state", 4.0)
        await flight.hears("vtol_state", "MC")
        if firmware == "ardupilot":
            await flight.refuses("FAILED", "action", "takeoff")
        await flight.does("action", "set_takeoff_altitude", 30.0)
        await flight.does("action", "arm")
        await flight.does("action", "takeoff")
        await flight.until(lambda: flight.height > 28)
        if firmware == "px4":
            await flight.hears("flight_mode", "HOLD")
        await flight.does("action", "transition_to_fixedwing")
        await flight.hears("vtol_state", "TRANSITION_TO_FW", "FW")
        await flight.until(lambda: flight.speed > 14)
        await flight.does("action", "transition_to_multicopter")
        await flight.hears("vtol_state", "TRANSITION_TO_MC", "MC")
        await flight.until(lambda: flight.speed < 2)
        if firmware == "px4":
            await flight.does("action", "land")
        else:
            await flight.refuses("UNSUPPORTED", "action", "land")
            await flight.does("action", "return_to_launch")
        await flight.hears("landed_state", "LANDING", "ON_GROUND")
        await flight.hears("armed", False)
