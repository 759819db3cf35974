"""ArduPilot's profile: modes, identity, status texts, flight parameters."""

from __future__ import annotations

from math import inf

import pytest

from mavstack.dialects import ardupilotmega, common
from mavstack.services.modes import mode_names
from mavstack.services.modes.names import mode_number
from mavstack.services.version import AutopilotVersion
from mavstack.sim.ardupilot.modes import MODES
from mavstack.sim.vehicle_types import Firmware, VehicleType

from .harness import CMD, RESULT, ArdupilotHarness

REQUIRED_MODES = {
    "copter": "STABILIZE ACRO ALT_HOLD AUTO GUIDED LOITER RTL CIRCLE LAND POSHOLD BRAKE SMART_RTL AUTO_RTL",
    "plane": "MANUAL CIRCLE STABILIZE TRAINING ACRO FBWA FBWB CRUISE AUTO RTL LOITER TAKEOFF GUIDED",
    "vtol": "QSTABILIZE QHOVER QLOITER QLAND QRTL FBWA AUTO RTL GUIDED",
    "rover": "MANUAL ACRO STEERING HOLD LOITER AUTO RTL SMART_RTL GUIDED",
    "boat": "MANUAL ACRO STEERING HOLD LOITER AUTO RTL SMART_RTL GUIDED",
    "sub": "STABILIZE ACRO ALT_HOLD AUTO GUIDED CIRCLE SURFACE POSHOLD MANUAL",
}


@pytest.mark.parametrize("vehicle_type", list(VehicleType))
def test_mode_numbers_match_their_names(vehicle_type: VehicleType) -> None:
    autopilot = Firmware.ARDUPILOT.mav_autopilot
    names = {mode.name for mode in MODES[vehicle_type]}
    assert names >= set(REQUIRED_MODES[vehicle_type].split())
    for mode in MODES[vehicle_type]:
        assert mode_number(autopilot, vehicle_type.mav_type, mode.name) == mode.number
        assert mode.number in mode_names(autopilot, vehicle_type.mav_type)


@pytest.mark.flight_cases(1)
@pytest.mark.fast_cases(1)
@pytest.mark.parametrize("vehicle_type", list(VehicleType))
def test_every_mode_can_be_entered(vehicle_type: VehicleType) -> None:
    harness = ArdupilotHarness(vehicle_type)
    harness.take_off(40.0)
    for mode in MODES[vehicle_type]:
        if mode.name in ("AUTO", "AUTO_RTL", "FOLLOW"):
            continue  # covered by the tests of missions and of following
        harness.set_mode("GUIDED")
        if vehicle_type in ("copter", "vtol"):
            harness.vehicle.body.place(0.0, 0.0, -40.0, 0.0)
        assert harness.set_mode(mode.name) == RESULT.ACCEPTED, mode.name
        harness.run(1)
        heartbeat = [message for message in harness.received if isinstance(message, common.Heartbeat)][-1]
        assert heartbeat.custom_mode == mode.number
        assert heartbeat.base_mode & common.MavModeFlag.SAFETY_ARMED


@pytest.mark.flight
def test_mode_that_needs_a_position_is_refused_without_one() -> None:
    harness = ArdupilotHarness("copter")
    harness.take_off()
    harness.set_mode("ALT_HOLD")
    harness.vehicle.body.fail_gps(True)
    harness.run_until(lambda: not harness.autopilot.has_position)
    assert harness.set_mode("LOITER") == RESULT.FAILED
    assert "Mode change to LOITER failed: requires position" in harness.received_texts
    assert harness.command(CMD.NAV_RETURN_TO_LAUNCH) == RESULT.FAILED
    assert "Mode change to RTL failed: requires position" in harness.received_texts


def test_fltmode_gcsblock() -> None:
    harness = ArdupilotHarness("copter")
    harness.vehicle.parameters.set("FLTMODE_GCSBLOCK", 1 << 4)
    assert harness.set_mode("GUIDED") == RESULT.FAILED
    assert harness.received_texts[-1].startswith("Mode change to GUIDED failed: GCS entry disabled")
    assert harness.set_mode("LOITER") == RESULT.ACCEPTED


def test_auto_without_a_mission_is_refused_while_armed() -> None:
    harness = ArdupilotHarness("copter")
    harness.accepted(CMD.COMPONENT_ARM_DISARM, 1)
    assert harness.set_mode("AUTO") == RESULT.FAILED
    assert harness.received_texts[-1] == "Mode change to AUTO failed: init failed"


@pytest.mark.fast_cases(4)
@pytest.mark.parametrize("vehicle_type", list(VehicleType))
def test_version_and_banner(vehicle_type: VehicleType) -> None:
    harness = ArdupilotHarness(vehicle_type)
    harness.accepted(CMD.REQUEST_MESSAGE, common.AutopilotVersion.__mavlink_row__[0])
    message = next(message for message in harness.received if isinstance(message, common.AutopilotVersion))
    version = AutopilotVersion.read(message)
    assert (version.flight.major, version.flight.minor) == (4, 6)
    assert version.can(common.MavProtocolCapability.FTP | common.MavProtocolCapability.COMMAND_INT)
    assert len(version.git_hash) == 8
    harness.send(common.ParamRequestList(target_system=1, target_component=1))
    firmware = {"copter": "ArduCopter", "plane": "ArduPlane", "vtol": "ArduPlane", "sub": "ArduSub"}.get(
        vehicle_type, "ArduRover"
    )
    assert any(text.startswith(f"{firmware} V4.6.") for text in harness.texts)


@pytest.mark.flight
def test_boot_and_gps_texts() -> None:
    harness = ArdupilotHarness("copter")
    for text in ("ArduPilot Ready", "EKF3 IMU0 is using GPS", "Field Elevation Set: 488m"):
        assert text in harness.texts
    harness.vehicle.body.fail_gps(True)
    harness.run_until(lambda: "EKF3 IMU0 stopped aiding" in harness.texts)
    harness.vehicle.body.fail_gps(False)
    harness.run_until(lambda: harness.texts.count("EKF3 IMU0 is using GPS") == 2)


def test_flight_parameters_follow_parameters() -> None:
    harness = ArdupilotHarness("copter")
    parameters, flight_parameters = harness.vehicle.parameters, harness.autopilot.flight_parameters
    for name, value in (("WPNAV_SPEED", 750), ("RTL_ALT", 3000), ("LAND_SPEED", 70), ("RTL_ALT_FINAL", 500)):
        parameters.set(name, value)
    assert (
        flight_parameters.cruise_speed,
        flight_parameters.return_altitude,
        flight_parameters.land_speed,
    ) == pytest.approx((7.5, 30.0, 0.7))
    assert flight_parameters.return_loiter_time == inf
    for name in ("WPNAV_SPEED", "RTL_ALT", "WPNAV_RADIUS", "CIRCLE_RADIUS", "GUID_TIMEOUT"):
        parameters.set(name, -5)
        assert flight_parameters.cruise_speed > 0
        assert flight_parameters.acceptance_radius > 0
        assert flight_parameters.return_altitude >= 0
    parameters.set("ANGLE_MAX", 1500)
    assert harness.vehicle.body.limits.tilt == pytest.approx(0.2618, abs=1e-3)


@pytest.mark.flight
def test_reboot_command() -> None:
    harness = ArdupilotHarness("copter")
    harness.accepted(CMD.PREFLIGHT_REBOOT_SHUTDOWN, 1)
    harness.received.clear()
    harness.run(5)
    assert "ArduPilot Ready" in harness.texts
    assert harness.vehicle.uptime < 6
    assert isinstance(
        next(message for message in harness.received if isinstance(message, common.Heartbeat)),
        common.Heartbeat,
    )
    assert harness.autopilot.mode.number == ardupilotmega.CopterMode.STABILIZE
