"""Flights of each type by commands: arm, take off, reposition, return."""

from __future__ import annotations

from math import hypot, nan

import pytest

from mavstack.dialects import common
from mavstack.services.setpoints import GlobalSetpoint, LocalSetpoint
from mavstack.services.version import FirmwareVersion

from .harness import CMD, RELATIVE, RESULT, ArdupilotHarness


def position(harness: ArdupilotHarness) -> tuple[float, float, float]:
    here = harness.vehicle.body.truth
    return here.north, here.east, here.down


@pytest.mark.nightly
@pytest.mark.flight
def test_copter_takes_off_repositions_and_returns() -> None:
    harness = ArdupilotHarness("copter")
    assert harness.set_mode("GUIDED") == RESULT.ACCEPTED
    harness.accepted(CMD.COMPONENT_ARM_DISARM, 1)
    harness.accepted(CMD.NAV_TAKEOFF, 0, 0, 0, 0, 0, 0, 10)
    harness.run_until(lambda: harness.autopilot.altitude > 9.5)
    assert harness.autopilot.landed_state in (common.MavLandedState.IN_AIR, common.MavLandedState.TAKEOFF)
    assert harness.reposition(40, 20, 20) == RESULT.ACCEPTED
    harness.run(20)
    north, east, down = position(harness)
    assert hypot(north - 40, east - 20) < 2
    assert down == pytest.approx(-20, abs=2)
    harness.accepted(CMD.NAV_RETURN_TO_LAUNCH)
    harness.run_until(lambda: not harness.autopilot.armed)
    north, east, _ = position(harness)
    assert hypot(north, east) < 2
    assert harness.texts[-1] == "Disarming motors"


@pytest.mark.nightly
def test_plane_takes_off_in_takeoff_mode_and_circles() -> None:
    harness = ArdupilotHarness("plane")
    assert harness.command(CMD.NAV_TAKEOFF, 0, 0, 0, 0, 0, 0, 50) == RESULT.FAILED
    assert harness.set_mode("TAKEOFF") == RESULT.ACCEPTED
    harness.accepted(CMD.COMPONENT_ARM_DISARM, 1)
    harness.run_until(lambda: harness.autopilot.altitude > 45)
    assert harness.reposition(300, 100, 80) == RESULT.ACCEPTED
    harness.run(40)
    north, east, down = position(harness)
    assert 30 < hypot(north - 300, east - 100) < 100
    assert down == pytest.approx(-80, abs=10)
    harness.accepted(CMD.NAV_RETURN_TO_LAUNCH)
    harness.run(40)
    north, east, down = position(harness)
    assert hypot(north, east) < 110
    assert down == pytest.approx(-100, abs=15)


@pytest.mark.nightly
def test_quadplane_takes_off_transitions_and_lands_in_hover() -> None:
    harness = ArdupilotHarness("vtol")
    assert harness.set_mode("GUIDED") == RESULT.ACCEPTED
    assert harness.command(CMD.NAV_TAKEOFF, 0, 0, 0, 0, 0, 0, 20) == RESULT.FAILED
    assert "Must be armed for takeoff" in harness.texts
    harness.accepted(CMD.COMPONENT_ARM_DISARM, 1)
    harness.accepted(CMD.NAV_TAKEOFF, 0, 0, 0, 0, 0, 0, 20)
    harness.run_until(lambda: harness.autopilot.altitude > 19)
    assert harness.vehicle.body.transition == 0
    assert harness.reposition(400, 0, 40) == RESULT.ACCEPTED
    harness.run(25)
    assert harness.vehicle.body.transition == pytest.approx(1, abs=0.05)
    assert harness.set_mode("QRTL") == RESULT.ACCEPTED
    harness.run_until(lambda: not harness.autopilot.armed, timeout=240)
    north, east, _ = position(harness)
    assert hypot(north, east) < 5


@pytest.mark.flight_cases(1)
@pytest.mark.flight
@pytest.mark.parametrize("vehicle_type", ["rover", "boat"])
def test_surface_vehicle_repositions_and_returns(vehicle_type: str) -> None:
    harness = ArdupilotHarness(vehicle_type)
    harness.accepted(CMD.COMPONENT_ARM_DISARM, 1)
    assert harness.reposition(15, 6, 0) == RESULT.ACCEPTED
    harness.run(18)
    north, east, _ = position(harness)
    assert hypot(north - 15, east - 6) < 3
    harness.accepted(CMD.NAV_RETURN_TO_LAUNCH)
    harness.run_until(lambda: hypot(*position(harness)[:2]) < 4, timeout=40)


@pytest.mark.flight
def test_sub_dives_and_surfaces() -> None:
    harness = ArdupilotHarness("sub")
    harness.accepted(CMD.COMPONENT_ARM_DISARM, 1)
    assert harness.reposition(10, 5, -6) == RESULT.ACCEPTED
    harness.run(25)
    north, east, down = position(harness)
    assert hypot(north - 10, east - 5) < 2
    assert down == pytest.approx(6, abs=1)
    harness.accepted(CMD.NAV_LAND)
    assert harness.mode == "SURFACE"
    harness.run_until(lambda: position(harness)[2] < 1, timeout=30)


@pytest.mark.nightly
def test_smart_rtl_retraces_the_path() -> None:
    harness = ArdupilotHarness("copter")
    harness.take_off()
    for corner in ((20, 0), (20, 20)):
        harness.reposition(*corner, 10)
        harness.run(8)
    assert harness.set_mode("SMART_RTL") == RESULT.ACCEPTED
    harness.run_until(lambda: position(harness)[1] < 4)
    assert position(harness)[0] > 15, "back along the path, not straight"
    harness.run_until(lambda: not harness.autopilot.armed)
    assert hypot(*position(harness)[:2]) < 3


@pytest.mark.flight
def test_guided_mission_item() -> None:
    harness = ArdupilotHarness("copter")
    harness.take_off()
    latitude, longitude = harness.at(20, -10)
    item = common.MissionItem(
        target_system=1,
        target_component=1,
        frame=common.MavFrame.GLOBAL_RELATIVE_ALT,
        command=common.MavCmd.NAV_WAYPOINT,
        current=2,
        x=latitude,
        y=longitude,
        z=15.0,
    )
    harness.send(item)
    answers = [message.type for message in harness.received if isinstance(message, common.MissionAck)]
    assert answers == [common.MavMissionResult.ACCEPTED]
    harness.run(15)
    north, east, down = position(harness)
    assert (north, east, down) == (
        pytest.approx(20, abs=2),
        pytest.approx(-10, abs=2),
        pytest.approx(-15, abs=2),
    )
    harness.set_mode("LOITER")
    harness.send(item)
    answers = [message.type for message in harness.received if isinstance(message, common.MissionAck)]
    assert answers[-1] == common.MavMissionResult.ERROR


@pytest.mark.parametrize(("version", "radius"), [((4, 2), 60.0), ((4, 3), 90.0)])
def test_the_radius_of_reposition_depends_on_the_version(version: tuple[int, int], radius: float) -> None:
    plane = ArdupilotHarness("plane", version=FirmwareVersion(*version))
    plane.take_off(60.0)
    place = plane.at(0.0, 0.0)
    plane.accepted(CMD.DO_REPOSITION, -1, 1, 90.0, nan, *place, 60.0, frame=RELATIVE)
    plane.run(60.0)
    north, east, _ = plane.autopilot.maneuvers.place
    assert hypot(north, east) == pytest.approx(radius, abs=5.0)


def test_a_plane_takes_the_altitude_of_position_setpoints_only() -> None:
    plane = ArdupilotHarness("plane")
    plane.take_off(60.0)
    plane.accepted(CMD.DO_REPOSITION, -1, 1, 0, nan, *plane.at(0.0, 0.0), 60.0, frame=RELATIVE)
    plane.run(10.0)
    guided, target = plane.autopilot.guided, plane.autopilot.target
    assert not guided.set(LocalSetpoint(velocity=(10.0, 0.0, 0.0)))
    assert not guided.set(LocalSetpoint(position=(500.0, 0.0, -80.0)))
    assert plane.autopilot.target == target
    assert guided.set(GlobalSetpoint(*plane.at(500.0, 0.0), 80.0))
    plane.run(2.0)
    assert plane.autopilot.target == pytest.approx((target[0], target[1], -80.0), abs=0.5)


@pytest.mark.parametrize("kind", ["rover", "boat"])
def test_an_older_rover_reports_the_altitude_above_the_sea_as_the_one_above_home(kind: str) -> None:
    for version, height in ((FirmwareVersion(4, 1), 488.0), (None, 0.0)):
        rover = ArdupilotHarness(kind, version=version)
        rover.run(12.0)
        reported = rover.received_of(common.GlobalPositionInt)[-1]
        assert reported.relative_alt / 1e3 == pytest.approx(height, abs=3.0)
        assert reported.alt / 1e3 == pytest.approx(488.0, abs=3.0)
