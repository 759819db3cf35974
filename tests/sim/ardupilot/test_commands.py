"""Commands of ArduPilot on every type: accepted ones act, others are UNSUPPORTED."""

from __future__ import annotations

from math import nan

import pytest

from mavstack.dialects import ardupilotmega, common, development
from mavstack.sim.vehicle_types import VehicleType

from .effects import CASES, arm, take_off
from .harness import CMD, RELATIVE, RESULT, ArdupilotHarness

SUCCESS = ardupilotmega.AccelcalVehiclePos.SUCCESS

TYPES = list(VehicleType)
#: Supported, but never ACCEPTED: there are no standard modes, and a plane takes off in a mode.
NEVER_ACCEPTED = {CMD.DO_SET_STANDARD_MODE, CMD.REQUEST_FLIGHT_INFORMATION}
#: Accepted without an effect, because the EKF has its own estimate.
WIND = development.MavCmd.EXTERNAL_WIND_ESTIMATE


def cases() -> list[tuple[VehicleType, int]]:
    return [
        (vehicle_type, command)
        for vehicle_type in TYPES
        for command in sorted(ArdupilotHarness(vehicle_type, settle=0).vehicle.commands.supported)
        if vehicle_type != "boat"  # same firmware as the rover
        and command not in {*NEVER_ACCEPTED, WIND}
        and not (vehicle_type == "plane" and command == CMD.NAV_TAKEOFF)
    ]


@pytest.mark.flight_cases(80)
@pytest.mark.fast_cases(4)
@pytest.mark.parametrize(
    ("vehicle_type", "command"), cases(), ids=lambda value: str(getattr(value, "name", value))
)
def test_every_accepted_command_acts(vehicle_type: VehicleType, command: int) -> None:
    case = CASES[CMD(command)]
    harness = ArdupilotHarness(vehicle_type)
    case.prepare(harness)
    harness.received.clear()
    params = case.params(harness) if callable(case.params) else case.params
    before = case.has_acted(harness)
    assert harness.command(command, *params, frame=case.frame, wait=case.wait) == RESULT.ACCEPTED, (
        harness.texts
    )
    harness.run_until(lambda: case.has_acted(harness), timeout=20)
    assert not before, "the case would pass without the command"


@pytest.mark.fast_cases(3)
@pytest.mark.parametrize("vehicle_type", TYPES)
def test_every_other_command_is_unsupported(vehicle_type: VehicleType) -> None:
    harness = ArdupilotHarness(vehicle_type)
    for command in CMD:
        if command not in harness.vehicle.commands.supported:
            assert harness.command(command, wait=0) == RESULT.UNSUPPORTED, command
            assert harness.command(command, frame=RELATIVE, wait=0) == RESULT.UNSUPPORTED, command
    assert harness.command(CMD.DO_SET_STANDARD_MODE, 1) == RESULT.UNSUPPORTED


def test_boat_supports_the_commands_of_a_rover() -> None:
    rover, boat = (
        ArdupilotHarness(vehicle_type, settle=0).vehicle.commands.supported
        for vehicle_type in ("rover", "boat")
    )
    assert rover == boat


@pytest.mark.flight
def test_takeoff_needs_guided_armed_and_a_height() -> None:
    harness = ArdupilotHarness("copter")
    takeoff = (CMD.NAV_TAKEOFF, 0, 0, 0, 0, 0, 0)
    assert harness.command(*takeoff, 10) == RESULT.FAILED
    harness.set_mode("GUIDED")
    assert harness.command(*takeoff, 10) == RESULT.FAILED
    arm(harness)
    assert harness.command(*takeoff, -5) == RESULT.FAILED
    assert harness.command(*takeoff, 10, frame=common.MavFrame.GLOBAL) == RESULT.DENIED
    assert harness.command(*takeoff, 10, frame=RELATIVE) == RESULT.ACCEPTED
    harness.run(8)
    assert harness.command(*takeoff, 20) == RESULT.FAILED


@pytest.mark.fast_cases(4)
@pytest.mark.parametrize("vehicle_type", TYPES)
def test_invalid_reposition_is_refused(vehicle_type: VehicleType) -> None:
    harness = ArdupilotHarness(vehicle_type)
    take_off(harness)
    here = harness.at(10, 10)
    assert harness.command(CMD.DO_REPOSITION, -1, 1, 0, nan, *here, 10) == RESULT.UNSUPPORTED
    for frame in (99, common.MavFrame.BODY_NED, common.MavFrame.MISSION):
        assert harness.command(CMD.DO_REPOSITION, -1, 1, 0, nan, *here, 10, frame=frame) == RESULT.DENIED
    assert harness.command(CMD.DO_REPOSITION, -1, 1, 0, nan, 95.0, 0.0, 10, frame=RELATIVE) == RESULT.DENIED
    assert harness.command(CMD.DO_REPOSITION, -1, 1, 0, nan, *here, nan, frame=RELATIVE) == RESULT.DENIED
    harness.set_mode("RTL" if vehicle_type != "sub" else "POSHOLD")
    assert harness.command(CMD.DO_REPOSITION, -1, 0, 0, nan, *here, 10, frame=RELATIVE) == RESULT.DENIED
    assert harness.mode != "GUIDED"


def test_commands_refused_in_the_air() -> None:
    harness = ArdupilotHarness("copter")
    take_off(harness)
    assert harness.command(CMD.COMPONENT_ARM_DISARM, 0) == RESULT.FAILED
    assert harness.command(CMD.PREFLIGHT_CALIBRATION, 0, 0, 1) == RESULT.FAILED
    assert harness.texts[-1] == "Disarm to allow calibration"
    assert harness.command(CMD.PREFLIGHT_REBOOT_SHUTDOWN, 1) == RESULT.FAILED
    assert harness.command(CMD.DO_MOTOR_TEST, 1, 0, 20, 1) == RESULT.FAILED
    assert harness.autopilot.armed
    assert harness.command(CMD.COMPONENT_ARM_DISARM, 0, 21196) == RESULT.ACCEPTED
    assert not harness.autopilot.armed


def test_disabled_payloads_fail() -> None:
    harness = ArdupilotHarness("copter")
    for command in (
        CMD.DO_GRIPPER,
        CMD.DO_WINCH,
        CMD.DO_SPRAYER,
        CMD.IMAGE_START_CAPTURE,
        CMD.DO_MOUNT_CONTROL,
    ):
        assert harness.command(command, 0, 1, 1) == RESULT.FAILED


@pytest.mark.flight
def test_invalid_numbers_raise_no_error() -> None:
    harness = ArdupilotHarness("copter")
    take_off(harness)
    excluded = {CMD.DO_FLIGHTTERMINATION, CMD.PREFLIGHT_REBOOT_SHUTDOWN}
    for command in sorted(harness.vehicle.commands.supported - excluded):
        for value in (nan, float("inf"), -1e30, 3e38):
            harness.command(command, *(value,) * 7, wait=0.02)
            harness.command(command, *(value,) * 4, frame=RELATIVE, wait=0.02)


@pytest.mark.flight
def test_change_speed_in_flight() -> None:
    harness = ArdupilotHarness("copter")
    take_off(harness)
    harness.reposition(400, 0, 10)
    harness.run(8)
    assert harness.vehicle.body.truth.velocity_north == pytest.approx(10, abs=1)
    harness.accepted(CMD.DO_CHANGE_SPEED, 1, 4)
    harness.run(8)
    assert harness.vehicle.body.truth.velocity_north == pytest.approx(4, abs=0.7)
    harness.vehicle.parameters.set("WPNAV_SPEED", 600)
    harness.reposition(500, 0, 10)
    harness.run(5)
    assert harness.vehicle.body.truth.velocity_north == pytest.approx(4, abs=0.7), "the chosen speed persists"


def test_commanded_home_survives_arming() -> None:
    harness = ArdupilotHarness("copter")
    harness.accepted(CMD.DO_SET_HOME, 0, 0, 0, 0, *harness.at(100, 0), 500, frame=common.MavFrame.GLOBAL)
    harness.accepted(CMD.COMPONENT_ARM_DISARM, 1)
    assert harness.autopilot.home_position[0] == pytest.approx(100, abs=0.1)
    assert harness.command(CMD.DO_SET_HOME, 0, 0, 0, 0, *harness.at(5, 0), 500, frame=99) == RESULT.DENIED


@pytest.mark.flight
def test_cancel_calibration() -> None:
    harness = ArdupilotHarness("copter")
    assert harness.command(CMD.PREFLIGHT_CALIBRATION, 0, 0, 1) == RESULT.IN_PROGRESS
    harness.send(common.CommandCancel(target_system=1, target_component=1, command=CMD.PREFLIGHT_CALIBRATION))
    harness.run(0.3)
    answers = [message.result for message in harness.received if isinstance(message, common.CommandAck)]
    assert answers[-1] == RESULT.CANCELLED
    assert harness.command(CMD.PREFLIGHT_CALIBRATION, 0, 0, 1, wait=4) == RESULT.ACCEPTED


def test_accelerometer_calibration_in_six_positions() -> None:
    harness = ArdupilotHarness("copter")
    harness.accepted(CMD.PREFLIGHT_CALIBRATION, 0, 0, 0, 0, 1, wait=3)
    assert requested_positions(harness).count(1) >= 2
    for position in range(1, 7):
        assert harness.command(CMD.ACCELCAL_VEHICLE_POS, position % 6 + 1) == RESULT.FAILED
        harness.accepted(CMD.ACCELCAL_VEHICLE_POS, position)
        assert harness.command(CMD.ACCELCAL_VEHICLE_POS, position) == RESULT.FAILED  # it is measured
        harness.run(0.6)
    assert placing_texts(harness) == ["Place vehicle level and press any key."]
    assert harness.texts[-1] == "Calibration successful"
    assert harness.command(CMD.ACCELCAL_VEHICLE_POS, 1) == RESULT.FAILED
    harness.received.clear()
    harness.run(3.2)
    assert requested_positions(harness)[-3:] == [SUCCESS] * 3  # until the next calibration


def test_accelerometer_calibration_by_acknowledgements() -> None:
    """Older ground stations answer the texts: only this result, and commands up to 6, count."""
    harness = ArdupilotHarness("copter")
    harness.accepted(CMD.PREFLIGHT_CALIBRATION, 0, 0, 0, 0, 1)
    for count in range(1, 7):
        harness.accepted(CMD.PREFLIGHT_CALIBRATION, 0, 0, 0, 0, 1)  # it runs already, and goes on
        for command, result in ((7, 1), (count, 0), (count, 1), (count, 1)):
            harness.send(common.CommandAck(command=command, result=result))
        harness.run(1.2)
        if count < 6:
            assert requested_positions(harness)[-1] == count + 1
    assert len(placing_texts(harness)) == 6
    assert harness.texts[-1] == "Calibration successful"


def requested_positions(harness: ArdupilotHarness) -> list[float]:
    commands = harness.received_of(common.CommandLong)
    return [each.param1 for each in commands if each.command == CMD.ACCELCAL_VEHICLE_POS]


def placing_texts(harness: ArdupilotHarness) -> list[str]:
    return [text for text in harness.texts if text.startswith("Place vehicle")]


def test_the_heartbeat_is_armed_during_a_motor_test() -> None:
    harness = ArdupilotHarness("copter")
    harness.accepted(CMD.DO_MOTOR_TEST, 1, 0, 20, 2)
    assert is_armed(harness)
    assert not harness.autopilot.armed
    harness.run(2.5)
    assert not is_armed(harness)


def is_armed(harness: ArdupilotHarness) -> bool:
    return bool(harness.received_of(common.Heartbeat)[-1].base_mode & common.MavModeFlag.SAFETY_ARMED)
