"""Flying by PX4's commands: take-off, landing, going somewhere, coming home, orbits, missions."""

from __future__ import annotations

import re
from math import hypot, nan

import pytest

from mavstack.dialects import common
from mavstack.services.mission import MissionItem
from tests.sim.px4.pilot import CMD, FIELD_ALTITUDE, RESULT, Pilot

LATITUDE, LONGITUDE = 47.3977418, 8.5455939
F = common.MavFrame


def place(pilot: Pilot, north: float, east: float) -> tuple[float, float]:
    latitude, longitude, _ = pilot.vehicle.body.frame.to_global(north, east, 0.0)
    return latitude, longitude


def distance(pilot: Pilot, north: float, east: float) -> float:
    truth = pilot.vehicle.body.truth
    return hypot(truth.north - north, truth.east - east)


def test_a_take_off_without_an_altitude_goes_by_its_parameter_and_ends_in_hold() -> None:
    pilot = Pilot()
    pilot.command(CMD.NAV_TAKEOFF, 0, 0, 0, nan, nan, nan, nan)
    pilot.arm()
    pilot.run(2.5)
    assert pilot.texts[-3:] == [
        "Armed by external command",
        "Using default takeoff altitude: 2.5 m",
        "Takeoff detected",
    ]
    assert pilot.heartbeat[1] == (4, 2)
    pilot.run_until(lambda: pilot.mode == "Hold")
    pilot.run(3.0)
    assert pilot.height == pytest.approx(2.5, abs=0.7)


def test_the_altitude_of_a_take_off_is_above_the_sea() -> None:
    pilot = Pilot().in_the_air(12)
    pilot.run(3.0)
    assert pilot.height == pytest.approx(12, abs=1)


def test_a_take_off_never_goes_down() -> None:
    pilot = Pilot().in_the_air(15)
    assert pilot.command(CMD.NAV_TAKEOFF, 0, 0, 0, nan, nan, nan, FIELD_ALTITUDE + 3) == RESULT.ACCEPTED
    pilot.run(5.0)
    assert "Already higher than takeoff altitude" in pilot.texts
    assert pilot.height > 14
    assert pilot.mode == "Hold"


def test_landing_is_told_and_ends_disarmed_in_hold() -> None:
    pilot = Pilot().in_the_air(6)
    assert pilot.command(CMD.NAV_LAND) == RESULT.ACCEPTED
    assert pilot.texts[-1] == "Landing at current position"
    pilot.run_until(lambda: not pilot.autopilot.armed)
    assert pilot.texts[-2:] == ["Landing detected", "Disarmed by landing"]
    assert pilot.mode == "Hold"


def test_after_a_landing_it_stays_armed_without_com_disarm_land() -> None:
    pilot = Pilot()
    pilot.vehicle.parameters.set("COM_DISARM_LAND", -1.0)
    pilot.in_the_air(4)
    pilot.command(CMD.NAV_LAND)
    pilot.run_until(lambda: "Landing detected" in pilot.texts)
    pilot.run(5.0)
    assert pilot.autopilot.armed


def test_coming_home_is_told_and_lands() -> None:
    pilot = Pilot().in_the_air(20)
    latitude, longitude = place(pilot, 60, 20)
    pilot.command(CMD.DO_REPOSITION, -1, 1, 0, nan, latitude, longitude, nan)
    pilot.run_until(lambda: distance(pilot, 60, 20) < 3)
    assert pilot.command(CMD.NAV_RETURN_TO_LAUNCH) == RESULT.ACCEPTED
    pilot.run(0.5)
    assert pilot.texts[-2] == "Returning to launch"
    assert re.fullmatch(r"RTL: start return at 51[89] m \(3[01] m above destination\)", pilot.texts[-1])
    pilot.run_until(lambda: not pilot.autopilot.armed, timeout=120)
    assert pilot.texts[-3:] == ["RTL: land at destination", "Landing detected", "Disarmed by landing"]
    assert distance(pilot, 0, 0) < 2


def test_armed_again_at_once_after_landing_it_stays_armed() -> None:
    pilot = Pilot().in_the_air(5)
    pilot.command(CMD.NAV_LAND)
    pilot.run_until(lambda: not pilot.autopilot.armed, timeout=60)
    assert pilot.vehicle.autopilot.arm() == []  # before anything looked at it disarmed
    pilot.run(3)
    assert pilot.autopilot.armed


def test_repositioning_needs_hold_or_leave_to_enter_it() -> None:
    pilot = Pilot().in_the_air()
    pilot.command(CMD.NAV_RETURN_TO_LAUNCH)
    assert pilot.command(CMD.DO_REPOSITION, -1, 0, 0, nan, LATITUDE, LONGITUDE, nan) == RESULT.DENIED
    assert pilot.command(CMD.DO_REPOSITION, -1, 1, 0, nan, LATITUDE, LONGITUDE, nan) == RESULT.ACCEPTED
    assert pilot.mode == "Hold"


@pytest.mark.parametrize("frame", [F.GLOBAL, F.GLOBAL_RELATIVE_ALT, F.GLOBAL_INT])
def test_the_altitude_of_a_command_is_above_the_sea_in_any_frame(frame: int) -> None:
    pilot = Pilot().in_the_air()
    pilot.command(CMD.DO_REPOSITION, -1, 1, 0, nan, LATITUDE, LONGITUDE, FIELD_ALTITUDE + 22, frame=frame)
    pilot.run(8.0)
    assert pilot.height == pytest.approx(22, abs=1.5)


def test_a_reposition_of_only_an_altitude_keeps_the_place() -> None:
    pilot = Pilot().in_the_air()
    latitude, longitude = place(pilot, 30, 0)
    pilot.command(CMD.DO_REPOSITION, -1, 1, 0, nan, latitude, longitude, nan)
    pilot.run_until(lambda: distance(pilot, 30, 0) < 2)
    pilot.command(CMD.DO_REPOSITION, -1, 1, 0, nan, nan, nan, FIELD_ALTITUDE + 25)
    pilot.run(10.0)
    assert distance(pilot, 30, 0) < 2
    assert pilot.height == pytest.approx(25, abs=1.5)


@pytest.mark.parametrize("clockwise", [1, -1])
def test_an_orbit_has_its_radius_and_its_direction(clockwise: int) -> None:
    pilot = Pilot().in_the_air()
    latitude, longitude = place(pilot, 0, 0)
    altitude = FIELD_ALTITUDE + 15
    assert (
        pilot.command(CMD.DO_ORBIT, clockwise * 12, 3, 0, nan, latitude, longitude, altitude)
        == RESULT.ACCEPTED
    )
    pilot.run(20.0)
    assert pilot.heartbeat[:2] == (0b10001, (3, 1))
    for _ in range(10):
        pilot.run(1.0)
        assert distance(pilot, 0, 0) == pytest.approx(12, abs=2)
        truth = pilot.vehicle.body.truth
        turning = truth.north * truth.velocity_east - truth.east * truth.velocity_north
        assert turning * clockwise > 0


def test_an_orbit_too_wide_is_told_and_made_smaller() -> None:
    pilot = Pilot().in_the_air()
    pilot.vehicle.parameters.set("MC_ORBIT_RAD_MAX", 30.0)
    pilot.command(CMD.DO_ORBIT, 500, 3, 0, nan, LATITUDE, LONGITUDE, FIELD_ALTITUDE + 15)
    assert pilot.texts[-1] == "Orbit radius limit exceeded"
    pilot.run(20.0)
    assert distance(pilot, 0, 0) == pytest.approx(30, abs=3)


def test_a_plane_orbits_in_hold() -> None:
    pilot = Pilot("plane").in_the_air(50)
    assert pilot.command(CMD.DO_ORBIT, -90, 0, 0, nan, LATITUDE, LONGITUDE, 548) == RESULT.ACCEPTED
    assert pilot.mode == "Hold"
    pilot.run(50.0)
    for _ in range(5):
        pilot.run(3.0)
        assert distance(pilot, 0, 0) == pytest.approx(90, abs=12)


def test_speed_is_chosen_and_given_back() -> None:
    pilot = Pilot().in_the_air()
    pilot.command(CMD.DO_CHANGE_SPEED, 1, 8)
    latitude, longitude = place(pilot, 300, 0)
    pilot.command(CMD.DO_REPOSITION, -1, 1, 0, nan, latitude, longitude, nan)
    pilot.run(12.0)
    assert pilot.vehicle.body.truth.velocity_north == pytest.approx(8, abs=1)
    pilot.command(CMD.DO_CHANGE_SPEED, 1, -1)
    pilot.run(8.0)
    assert pilot.vehicle.body.truth.velocity_north == pytest.approx(5, abs=1)


def items(*commands: tuple[int, float, float, float]) -> list[MissionItem]:
    return [
        MissionItem(
            command,
            param4=nan,
            param5=LATITUDE + north / 111_120,
            param6=LONGITUDE + east / 75_400,
            param7=altitude,
            frame=F.GLOBAL_RELATIVE_ALT,
        )
        for command, north, east, altitude in commands
    ]


def test_a_mission_that_lands_stays_in_its_mode_and_is_disarmed() -> None:
    pilot = Pilot()
    plan = items(
        (CMD.NAV_TAKEOFF, 0, 0, 10),
        (CMD.NAV_WAYPOINT, 30, 0, 10),
        (CMD.NAV_WAYPOINT, 30, 25, 12),
        (CMD.NAV_LAND, 20, 0, 0),
    )
    assert pilot.upload(plan) == common.MavMissionResult.ACCEPTED
    assert pilot.command(CMD.MISSION_START, 0, 0) == RESULT.ACCEPTED
    pilot.run(0.5)
    assert pilot.texts[:3] == [
        "Armed by mission start",
        "Executing Mission",
        "Climb to 10.0 meters above home",
    ]
    pilot.run_until(lambda: not pilot.autopilot.armed, timeout=120)
    assert pilot.texts[-1] == "Disarmed by landing"
    assert "Mission finished, landed" in pilot.texts
    assert pilot.mode == "Mission"
    assert distance(pilot, 20, 0) < 4
    reached = [message.seq for message in pilot.all_of(common.MissionItemReached)]
    assert list(dict.fromkeys(reached)) == [0, 1, 2, 3]


def test_a_mission_that_ends_in_the_air_holds() -> None:
    pilot = Pilot()
    pilot.upload(items((CMD.NAV_TAKEOFF, 0, 0, 10), (CMD.NAV_WAYPOINT, 30, 0, 10)))
    pilot.command(CMD.MISSION_START, 0, 0)
    pilot.run_until(lambda: pilot.mode == "Hold", timeout=90)
    assert pilot.texts[-1] == "Mission finished, loitering"


def test_there_is_no_mission_to_start() -> None:
    pilot = Pilot()
    assert pilot.command(CMD.MISSION_START, 0, 0) == RESULT.DENIED
    assert pilot.texts[-1] == "Mission start denied! No valid mission"
    assert not pilot.autopilot.armed
    assert pilot.command(CMD.DO_LAND_START) == RESULT.CANCELLED


def test_a_mission_that_begins_with_a_landing_is_not_started() -> None:
    pilot = Pilot()
    pilot.upload(items((CMD.NAV_LAND, 0, 0, 0)))
    assert pilot.command(CMD.MISSION_START, 0, 0) == RESULT.DENIED


@pytest.mark.parametrize("kind", ["plane", "vtol", "rover", "boat", "sub"])
def test_every_type_goes_where_it_is_told(kind: str) -> None:
    pilot = Pilot(kind)
    if pilot.vehicle.type.flies:
        pilot.in_the_air(50)
    else:
        pilot.arm()
    latitude, longitude = place(pilot, 20, 12)
    altitude = {"plane": 540.0, "vtol": 540.0, "sub": 480.0}.get(kind, nan)
    assert pilot.command(CMD.DO_REPOSITION, -1, 1, 0, nan, latitude, longitude, altitude) == RESULT.ACCEPTED
    near = 95.0 if kind == "plane" else 3.0
    pilot.run(15.0)
    pilot.run_until(lambda: distance(pilot, 20, 12) < near, timeout=150)
    if kind == "sub":
        pilot.run_until(lambda: abs(pilot.height + 8) < 1, timeout=60)


@pytest.mark.parametrize("kind", ["copter", "plane", "sub"])
def test_without_its_position_it_descends(kind: str) -> None:
    pilot = Pilot(kind)
    if kind == "sub":
        pilot.arm()
    else:
        pilot.in_the_air(20 if kind == "copter" else 40)
    pilot.vehicle.faults.inject("gps off")
    pilot.run_until(lambda: pilot.mode == "Descend", timeout=60)
    assert "Failsafe activated" in pilot.texts
    pilot.run(1.5)
    assert pilot.heartbeat[1:] == ((4, 20), int(common.MavState.CRITICAL))
    if kind != "sub":
        pilot.run_until(lambda: not pilot.autopilot.armed, timeout=90)
        assert "Disarmed by landing" in pilot.texts


def test_a_landing_without_a_position_is_a_descent() -> None:
    pilot = Pilot().in_the_air(10)
    pilot.vehicle.parameters.set("COM_DISARM_LAND", 2.0)
    pilot.vehicle.faults.inject("gps off")
    pilot.run_until(lambda: not pilot.autopilot.has_position, timeout=60)
    assert pilot.command(CMD.NAV_LAND) == RESULT.ACCEPTED
    assert pilot.mode == "Descend"
