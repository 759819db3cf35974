"""Whatever is ACCEPTED acts, and whatever is not taken is UNSUPPORTED: every command on every type."""

from __future__ import annotations

from math import nan

import pytest

from mavstack.dialects import common
from mavstack.sim.vehicle_types import VehicleType

from .effects import CASES, armed, flying
from .harness import CMD, RELATIVE, RESULT, ArdupilotHarness

TYPES = list(VehicleType)
#: Answered, but never ACCEPTED: none of the modes is a standard one; a plane takes off in a mode.
NEVER = {CMD.DO_SET_STANDARD_MODE, CMD.REQUEST_FLIGHT_INFORMATION}


def cases() -> list[tuple[VehicleType, int]]:
    return [
        (kind, command)
        for kind in TYPES
        for command in sorted(ArdupilotHarness(kind, settle=0).vehicle.commands.supported)
        if kind != "boat"  # it is a rover afloat
        and command not in NEVER
        and not (kind == "plane" and command == CMD.NAV_TAKEOFF)
    ]


@pytest.mark.parametrize(("kind", "command"), cases(), ids=lambda value: str(getattr(value, "name", value)))
def test_every_accepted_command_acts(kind: VehicleType, command: int) -> None:
    case = CASES[CMD(command)]
    bench = ArdupilotHarness(kind)
    case.ready(bench)
    bench.received.clear()
    params = case.params(bench) if callable(case.params) else case.params
    before = case.seen(bench)
    assert bench.command(command, *params, frame=case.frame, wait=case.wait) == RESULT.ACCEPTED, bench.texts
    bench.run_until(lambda: case.seen(bench), timeout=20)
    assert not before, "the case would pass without the command"


@pytest.mark.parametrize("kind", TYPES)
def test_every_other_command_is_unsupported(kind: VehicleType) -> None:
    bench = ArdupilotHarness(kind)
    for command in CMD:
        if command not in bench.vehicle.commands.supported:
            assert bench.command(command, wait=0) == RESULT.UNSUPPORTED, command
            assert bench.command(command, frame=RELATIVE, wait=0) == RESULT.UNSUPPORTED, command
    assert bench.command(CMD.DO_SET_STANDARD_MODE, 1) == RESULT.UNSUPPORTED


def test_a_boat_takes_what_a_rover_takes() -> None:
    rover, boat = (ArdupilotHarness(kind, settle=0).vehicle.commands.supported for kind in ("rover", "boat"))
    assert rover == boat


def test_takeoff_needs_guided_arms_and_a_height() -> None:
    bench = ArdupilotHarness("copter")
    takeoff = (CMD.NAV_TAKEOFF, 0, 0, 0, 0, 0, 0)
    assert bench.command(*takeoff, 10) == RESULT.FAILED
    bench.set_mode("GUIDED")
    assert bench.command(*takeoff, 10) == RESULT.FAILED
    armed(bench)
    assert bench.command(*takeoff, -5) == RESULT.FAILED
    assert bench.command(*takeoff, 10, frame=common.MavFrame.GLOBAL) == RESULT.DENIED
    assert bench.command(*takeoff, 10, frame=RELATIVE) == RESULT.ACCEPTED
    bench.run(8)
    assert bench.command(*takeoff, 20) == RESULT.FAILED


@pytest.mark.parametrize("kind", TYPES)
def test_reposition_says_no_where_it_means_nothing(kind: VehicleType) -> None:
    bench = ArdupilotHarness(kind)
    flying(bench)
    here = bench.at(10, 10)
    assert bench.command(CMD.DO_REPOSITION, -1, 1, 0, nan, *here, 10) == RESULT.UNSUPPORTED
    for frame in (99, common.MavFrame.BODY_NED, common.MavFrame.MISSION):
        assert bench.command(CMD.DO_REPOSITION, -1, 1, 0, nan, *here, 10, frame=frame) == RESULT.DENIED
    assert bench.command(CMD.DO_REPOSITION, -1, 1, 0, nan, 95.0, 0.0, 10, frame=RELATIVE) == RESULT.DENIED
    assert bench.command(CMD.DO_REPOSITION, -1, 1, 0, nan, *here, nan, frame=RELATIVE) == RESULT.DENIED
    bench.set_mode("RTL" if kind != "sub" else "POSHOLD")
    assert bench.command(CMD.DO_REPOSITION, -1, 0, 0, nan, *here, 10, frame=RELATIVE) == RESULT.DENIED
    assert bench.mode != "GUIDED"


def test_what_may_not_be_done_in_the_air() -> None:
    bench = ArdupilotHarness("copter")
    flying(bench)
    assert bench.command(CMD.COMPONENT_ARM_DISARM, 0) == RESULT.FAILED
    assert bench.command(CMD.PREFLIGHT_CALIBRATION, 0, 0, 1) == RESULT.FAILED
    assert bench.texts[-1] == "Disarm to allow calibration"
    assert bench.command(CMD.PREFLIGHT_REBOOT_SHUTDOWN, 1) == RESULT.FAILED
    assert bench.command(CMD.DO_MOTOR_TEST, 1, 0, 20, 1) == RESULT.FAILED
    assert bench.autopilot.armed
    assert bench.command(CMD.COMPONENT_ARM_DISARM, 0, 21196) == RESULT.ACCEPTED
    assert not bench.autopilot.armed


def test_what_is_not_fitted_failed() -> None:
    bench = ArdupilotHarness("copter")
    for command in (
        CMD.DO_GRIPPER,
        CMD.DO_WINCH,
        CMD.DO_SPRAYER,
        CMD.IMAGE_START_CAPTURE,
        CMD.DO_MOUNT_CONTROL,
    ):
        assert bench.command(command, 0, 1, 1) == RESULT.FAILED


def test_numbers_that_are_none_are_refused() -> None:
    bench = ArdupilotHarness("copter")
    flying(bench)
    harmless = {CMD.DO_FLIGHTTERMINATION, CMD.PREFLIGHT_REBOOT_SHUTDOWN}
    for command in sorted(bench.vehicle.commands.supported - harmless):
        for value in (nan, float("inf"), -1e30, 3e38):
            bench.command(command, *(value,) * 7, wait=0.02)
            bench.command(command, *(value,) * 4, frame=RELATIVE, wait=0.02)


def test_a_changed_speed_counts_on_the_way() -> None:
    bench = ArdupilotHarness("copter")
    flying(bench)
    bench.reposition(400, 0, 10)
    bench.run(8)
    assert bench.vehicle.body.truth.velocity_north == pytest.approx(10, abs=1)
    bench.accepted(CMD.DO_CHANGE_SPEED, 1, 4)
    bench.run(8)
    assert bench.vehicle.body.truth.velocity_north == pytest.approx(4, abs=0.7)
    bench.vehicle.parameters.set("WPNAV_SPEED", 600)
    bench.reposition(500, 0, 10)
    bench.run(5)
    assert bench.vehicle.body.truth.velocity_north == pytest.approx(4, abs=0.7), "the choice stays"


def test_home_that_was_set_stays_when_the_motors_are_armed() -> None:
    bench = ArdupilotHarness("copter")
    bench.accepted(CMD.DO_SET_HOME, 0, 0, 0, 0, *bench.at(100, 0), 500, frame=common.MavFrame.GLOBAL)
    bench.accepted(CMD.COMPONENT_ARM_DISARM, 1)
    assert bench.autopilot.home_position[0] == pytest.approx(100, abs=0.1)
    assert bench.command(CMD.DO_SET_HOME, 0, 0, 0, 0, *bench.at(5, 0), 500, frame=99) == RESULT.DENIED


def test_a_cancelled_calibration_is_cancelled() -> None:
    bench = ArdupilotHarness("copter")
    assert bench.command(CMD.PREFLIGHT_CALIBRATION, 0, 0, 1) == RESULT.IN_PROGRESS
    bench.send(common.CommandCancel(target_system=1, target_component=1, command=CMD.PREFLIGHT_CALIBRATION))
    bench.run(0.3)
    answers = [message.result for message in bench.received if isinstance(message, common.CommandAck)]
    assert answers[-1] == RESULT.CANCELLED
    assert bench.command(CMD.PREFLIGHT_CALIBRATION, 0, 0, 1, wait=4) == RESULT.ACCEPTED


def test_accelerometers_are_calibrated_in_six_positions() -> None:
    bench = ArdupilotHarness("copter")
    bench.accepted(CMD.PREFLIGHT_CALIBRATION, 0, 0, 0, 0, 1, wait=3)
    asked = [m for m in bench.received if isinstance(m, common.CommandLong) and m.param1 == 1]
    assert len(asked) >= 2
    for position in range(1, 7):
        bench.accepted(CMD.ACCELCAL_VEHICLE_POS, position)
    assert "Place vehicle on its BACK and press any key." in bench.texts
    assert bench.texts[-1] == "Calibration successful"
    assert bench.command(CMD.ACCELCAL_VEHICLE_POS, 1) == RESULT.FAILED
