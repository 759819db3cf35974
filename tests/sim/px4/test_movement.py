"""PX4's flight commands: take-off, landing, reposition, return, orbits, missions."""

from __future__ import annotations

import re
from math import hypot, nan

import pytest

from mavstack.dialects import common
from mavstack.services.mission import MissionItem
from tests.sim.px4.harness import CMD, FIELD_ALTITUDE, RESULT, Px4Harness

LATITUDE, LONGITUDE = 47.3977418, 8.5455939
FRAME = common.MavFrame


def position(harness: Px4Harness, north: float, east: float) -> tuple[float, float]:
    latitude, longitude, _ = harness.vehicle.body.frame.to_global(north, east, 0.0)
    return latitude, longitude


def distance(harness: Px4Harness, north: float, east: float) -> float:
    truth = harness.vehicle.body.truth
    return hypot(truth.north - north, truth.east - east)


@pytest.mark.flight
def test_takeoff_without_altitude_uses_mis_takeoff_alt() -> None:
    harness = Px4Harness()
    harness.command(CMD.NAV_TAKEOFF, 0, 0, 0, nan, nan, nan, nan)
    harness.arm()
    harness.run(2.5)
    assert harness.texts[-3:] == [
        "Armed by external command",
        "Using default takeoff altitude: 2.5 m",
        "Takeoff detected",
    ]
    assert harness.heartbeat[1] == (4, 2)
    harness.run_until(lambda: harness.mode == "Hold")
    harness.run(3.0)
    assert harness.height == pytest.approx(2.5, abs=0.7)


@pytest.mark.flight
def test_takeoff_altitude_is_above_mean_sea_level() -> None:
    harness = Px4Harness().take_off(12)
    harness.run(3.0)
    assert harness.height == pytest.approx(12, abs=1)


@pytest.mark.flight
def test_takeoff_never_descends() -> None:
    harness = Px4Harness().take_off(15)
    assert harness.command(CMD.NAV_TAKEOFF, 0, 0, 0, nan, nan, nan, FIELD_ALTITUDE + 3) == RESULT.ACCEPTED
    harness.run(5.0)
    assert "Already higher than takeoff altitude" in harness.texts
    assert harness.height > 14
    assert harness.mode == "Hold"


@pytest.mark.flight
def test_landing_is_reported_and_ends_disarmed_in_hold() -> None:
    harness = Px4Harness().take_off(6)
    assert harness.command(CMD.NAV_LAND) == RESULT.ACCEPTED
    assert harness.texts[-1] == "Landing at current position"
    harness.run_until(lambda: not harness.autopilot.armed)
    assert harness.texts[-2:] == ["Landing detected", "Disarmed by landing"]
    assert harness.mode == "Hold"


@pytest.mark.flight
def test_stays_armed_after_landing_without_com_disarm_land() -> None:
    harness = Px4Harness()
    harness.vehicle.parameters.set("COM_DISARM_LAND", -1.0)
    harness.take_off(4)
    harness.command(CMD.NAV_LAND)
    harness.run_until(lambda: "Landing detected" in harness.texts)
    harness.run(5.0)
    assert harness.autopilot.armed


@pytest.mark.flight
def test_return_is_reported_and_lands() -> None:
    harness = Px4Harness().take_off(20)
    latitude, longitude = position(harness, 60, 20)
    harness.command(CMD.DO_REPOSITION, -1, 1, 0, nan, latitude, longitude, nan)
    harness.run_until(lambda: distance(harness, 60, 20) < 3)
    assert harness.command(CMD.NAV_RETURN_TO_LAUNCH) == RESULT.ACCEPTED
    harness.run(0.5)
    assert harness.texts[-2] == "Returning to launch"
    assert re.fullmatch(r"RTL: start return at 51[89] m \(3[01] m above destination\)", harness.texts[-1])
    harness.run_until(lambda: not harness.autopilot.armed, timeout=120)
    assert harness.texts[-3:] == ["RTL: land at destination", "Landing detected", "Disarmed by landing"]
    assert distance(harness, 0, 0) < 2


@pytest.mark.flight
def test_rearming_right_after_landing_stays_armed() -> None:
    harness = Px4Harness().take_off(5)
    harness.command(CMD.NAV_LAND)
    harness.run_until(lambda: not harness.autopilot.armed, timeout=60)
    assert harness.vehicle.autopilot.arm() == []  # before the next periodic check
    harness.run(3)
    assert harness.autopilot.armed


@pytest.mark.flight
def test_reposition_needs_hold_or_the_change_mode_flag() -> None:
    harness = Px4Harness().take_off()
    harness.command(CMD.NAV_RETURN_TO_LAUNCH)
    assert harness.command(CMD.DO_REPOSITION, -1, 0, 0, nan, LATITUDE, LONGITUDE, nan) == RESULT.DENIED
    assert harness.command(CMD.DO_REPOSITION, -1, 1, 0, nan, LATITUDE, LONGITUDE, nan) == RESULT.ACCEPTED
    assert harness.mode == "Hold"


@pytest.mark.fast_cases(2)
@pytest.mark.parametrize("frame", [FRAME.GLOBAL, FRAME.GLOBAL_RELATIVE_ALT, FRAME.GLOBAL_INT])
def test_reposition_altitude_is_above_mean_sea_level_in_any_frame(frame: int) -> None:
    harness = Px4Harness().take_off()
    harness.command(CMD.DO_REPOSITION, -1, 1, 0, nan, LATITUDE, LONGITUDE, FIELD_ALTITUDE + 22, frame=frame)
    harness.run(8.0)
    assert harness.height == pytest.approx(22, abs=1.5)


@pytest.mark.flight
def test_reposition_without_position_keeps_the_position() -> None:
    harness = Px4Harness().take_off()
    latitude, longitude = position(harness, 30, 0)
    harness.command(CMD.DO_REPOSITION, -1, 1, 0, nan, latitude, longitude, nan)
    harness.run_until(lambda: distance(harness, 30, 0) < 2)
    harness.command(CMD.DO_REPOSITION, -1, 1, 0, nan, nan, nan, FIELD_ALTITUDE + 25)
    harness.run(10.0)
    assert distance(harness, 30, 0) < 2
    assert harness.height == pytest.approx(25, abs=1.5)


@pytest.mark.flight_cases(1)
@pytest.mark.flight
@pytest.mark.parametrize("clockwise", [1, -1])
def test_orbit_radius_and_direction(clockwise: int) -> None:
    harness = Px4Harness().take_off()
    latitude, longitude = position(harness, 0, 0)
    altitude = FIELD_ALTITUDE + 15
    assert (
        harness.command(CMD.DO_ORBIT, clockwise * 12, 3, 0, nan, latitude, longitude, altitude)
        == RESULT.ACCEPTED
    )
    harness.run(20.0)
    assert harness.heartbeat[:2] == (0b10001, (3, 1))
    for _ in range(10):
        harness.run(1.0)
        assert distance(harness, 0, 0) == pytest.approx(12, abs=2)
        truth = harness.vehicle.body.truth
        turning = truth.north * truth.velocity_east - truth.east * truth.velocity_north
        assert turning * clockwise > 0


@pytest.mark.flight
def test_orbit_radius_is_limited() -> None:
    harness = Px4Harness().take_off()
    harness.vehicle.parameters.set("MC_ORBIT_RAD_MAX", 30.0)
    harness.command(CMD.DO_ORBIT, 500, 3, 0, nan, LATITUDE, LONGITUDE, FIELD_ALTITUDE + 15)
    assert harness.texts[-1] == "Orbit radius limit exceeded"
    harness.run(20.0)
    assert distance(harness, 0, 0) == pytest.approx(30, abs=3)


@pytest.mark.nightly
def test_plane_orbits_in_hold() -> None:
    harness = Px4Harness("plane").take_off(50)
    assert harness.command(CMD.DO_ORBIT, -90, 0, 0, nan, LATITUDE, LONGITUDE, 548) == RESULT.ACCEPTED
    assert harness.mode == "Hold"
    harness.run(50.0)
    for _ in range(5):
        harness.run(3.0)
        assert distance(harness, 0, 0) == pytest.approx(90, abs=12)


@pytest.mark.flight
def test_change_speed_and_restore_the_default() -> None:
    harness = Px4Harness().take_off()
    harness.command(CMD.DO_CHANGE_SPEED, 1, 8)
    latitude, longitude = position(harness, 300, 0)
    harness.command(CMD.DO_REPOSITION, -1, 1, 0, nan, latitude, longitude, nan)
    harness.run(12.0)
    assert harness.vehicle.body.truth.velocity_north == pytest.approx(8, abs=1)
    harness.command(CMD.DO_CHANGE_SPEED, 1, -1)
    harness.run(8.0)
    assert harness.vehicle.body.truth.velocity_north == pytest.approx(5, abs=1)


def items(*commands: tuple[int, float, float, float]) -> list[MissionItem]:
    return [
        MissionItem(
            command,
            param4=nan,
            param5=LATITUDE + north / 111_120,
            param6=LONGITUDE + east / 75_400,
            param7=altitude,
            frame=FRAME.GLOBAL_RELATIVE_ALT,
        )
        for command, north, east, altitude in commands
    ]


@pytest.mark.flight
def test_mission_with_landing_stays_in_mission_and_disarms() -> None:
    harness = Px4Harness()
    plan = items(
        (CMD.NAV_TAKEOFF, 0, 0, 10),
        (CMD.NAV_WAYPOINT, 30, 0, 10),
        (CMD.NAV_WAYPOINT, 30, 25, 12),
        (CMD.NAV_LAND, 20, 0, 0),
    )
    assert harness.upload(plan) == common.MavMissionResult.ACCEPTED
    assert harness.command(CMD.MISSION_START, 0, 0) == RESULT.ACCEPTED
    harness.run(0.5)
    assert harness.texts[:3] == [
        "Armed by mission start",
        "Executing Mission",
        "Climb to 10.0 meters above home",
    ]
    harness.run_until(lambda: not harness.autopilot.armed, timeout=120)
    assert harness.texts[-1] == "Disarmed by landing"
    assert "Mission finished, landed" in harness.texts
    assert harness.mode == "Mission"
    assert distance(harness, 20, 0) < 4
    reached = [message.seq for message in harness.received_of(common.MissionItemReached)]
    assert list(dict.fromkeys(reached)) == [0, 1, 2, 3]


@pytest.mark.flight
def test_mission_that_ends_in_the_air_holds() -> None:
    harness = Px4Harness()
    harness.upload(items((CMD.NAV_TAKEOFF, 0, 0, 10), (CMD.NAV_WAYPOINT, 30, 0, 10)))
    harness.command(CMD.MISSION_START, 0, 0)
    harness.run_until(lambda: harness.mode == "Hold", timeout=90)
    assert harness.texts[-1] == "Mission finished, loitering"


def test_mission_start_without_a_mission_is_denied() -> None:
    harness = Px4Harness()
    assert harness.command(CMD.MISSION_START, 0, 0) == RESULT.DENIED
    assert harness.texts[-1] == "Mission start denied! No valid mission"
    assert not harness.autopilot.armed
    assert harness.command(CMD.DO_LAND_START) == RESULT.CANCELLED


def test_mission_that_starts_with_a_landing_is_denied() -> None:
    harness = Px4Harness()
    harness.upload(items((CMD.NAV_LAND, 0, 0, 0)))
    assert harness.command(CMD.MISSION_START, 0, 0) == RESULT.DENIED


@pytest.mark.flight_cases(1)
@pytest.mark.flight
@pytest.mark.parametrize("vehicle_type", ["plane", "vtol", "rover", "boat", "sub"])
def test_every_type_repositions(vehicle_type: str) -> None:
    harness = Px4Harness(vehicle_type)
    if harness.vehicle.vehicle_type.flies:
        harness.take_off(50)
    else:
        harness.arm()
    latitude, longitude = position(harness, 20, 12)
    altitude = {"plane": 540.0, "vtol": 540.0, "sub": 480.0}.get(vehicle_type, nan)
    assert harness.command(CMD.DO_REPOSITION, -1, 1, 0, nan, latitude, longitude, altitude) == RESULT.ACCEPTED
    near = 95.0 if vehicle_type == "plane" else 3.0
    harness.run(15.0)
    harness.run_until(lambda: distance(harness, 20, 12) < near, timeout=150)
    if vehicle_type == "sub":
        harness.run_until(lambda: abs(harness.height + 8) < 1, timeout=60)


@pytest.mark.flight_cases(1)
@pytest.mark.flight
@pytest.mark.parametrize("vehicle_type", ["copter", "plane", "sub"])
def test_descends_without_a_position(vehicle_type: str) -> None:
    harness = Px4Harness(vehicle_type)
    if vehicle_type == "sub":
        harness.arm()
    else:
        harness.take_off(20 if vehicle_type == "copter" else 40)
    harness.vehicle.faults.inject("gps off")
    harness.run_until(lambda: harness.mode == "Descend", timeout=60)
    assert "Failsafe activated" in harness.texts
    harness.run(1.5)
    assert harness.heartbeat[1:] == ((4, 20), int(common.MavState.CRITICAL))
    if vehicle_type != "sub":
        harness.run_until(lambda: not harness.autopilot.armed, timeout=90)
        assert "Disarmed by landing" in harness.texts


@pytest.mark.flight
def test_landing_without_a_position_becomes_descend() -> None:
    harness = Px4Harness().take_off(10)
    harness.vehicle.parameters.set("COM_DISARM_LAND", 2.0)
    harness.vehicle.faults.inject("gps off")
    harness.run_until(lambda: not harness.autopilot.has_position, timeout=60)
    assert harness.command(CMD.NAV_LAND) == RESULT.ACCEPTED
    assert harness.mode == "Descend"
