"""Arming and disarming: what PX4 answers, and what it says."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from tests.sim.px4.pilot import CMD, RESULT, Pilot

REFUSED = "Arming denied: Resolve system health failures first"
FORCE = 21196


def test_armed_by_command_and_disarmed_when_nothing_happens() -> None:
    pilot = Pilot()
    pilot.arm()
    assert pilot.texts[-1] == "Armed by external command"
    pilot.run(10.5)
    assert pilot.autopilot.armed
    pilot.run(1.0)
    assert not pilot.autopilot.armed
    assert pilot.texts[-1] == "Disarmed by auto preflight disarming"


def test_it_stays_armed_if_its_parameter_says_so() -> None:
    pilot = Pilot()
    pilot.vehicle.parameters.set("COM_DISARM_PRFLT", -1.0)
    pilot.arm()
    pilot.run(20.0)
    assert pilot.autopilot.armed


def test_disarmed_by_command_on_the_ground() -> None:
    pilot = Pilot()
    pilot.arm()
    assert pilot.command(CMD.COMPONENT_ARM_DISARM, 0) == RESULT.ACCEPTED
    assert pilot.texts[-1] == "Disarmed by external command"


def test_disarming_in_the_air_is_denied_unless_forced() -> None:
    pilot = Pilot().in_the_air()
    assert pilot.command(CMD.COMPONENT_ARM_DISARM, 0) == RESULT.TEMPORARILY_REJECTED
    assert pilot.texts[-1] == "Disarming denied: not landed"
    assert pilot.command(CMD.COMPONENT_ARM_DISARM, 0, FORCE) == RESULT.ACCEPTED
    assert not pilot.autopilot.armed
    pilot.run_until(lambda: pilot.height < 0.1, timeout=20)


def test_a_number_that_is_no_order_is_told() -> None:
    pilot = Pilot()
    assert pilot.command(CMD.COMPONENT_ARM_DISARM, 7) == RESULT.UNSUPPORTED
    assert pilot.texts[-1] == "Unsupported ARM_DISARM param: 7.000"


def test_nothing_is_armed_before_the_estimate_is_there() -> None:
    pilot = Pilot(ready=False)
    pilot.run(0.5)
    assert pilot.command(CMD.COMPONENT_ARM_DISARM, 1) == RESULT.TEMPORARILY_REJECTED
    assert pilot.texts[-2:] == ["Preflight Fail: ekf2 missing data", REFUSED]
    assert pilot.command(CMD.COMPONENT_ARM_DISARM, 1, FORCE) == RESULT.TEMPORARILY_REJECTED


@pytest.mark.parametrize(
    ("fault", "reason"),
    [
        ("compass 120", "Preflight Fail: heading estimate invalid"),
        ("gps off", "Preflight Fail: No valid global position estimate"),
        ("battery 10", "Low battery"),
        ("battery 6", "Critical battery"),
        ("battery 2", "Emergency battery level"),
    ],
)
def test_a_fault_keeps_it_from_arming_and_is_told_when_it_arises(fault: str, reason: str) -> None:
    pilot = Pilot()
    pilot.vehicle.faults.inject(fault)
    pilot.run_until(lambda: reason in pilot.texts, timeout=40)
    assert pilot.heartbeat[2] in (common.MavState.UNINIT, common.MavState.STANDBY)
    pilot.texts.clear()
    assert pilot.command(CMD.COMPONENT_ARM_DISARM, 1) == RESULT.TEMPORARILY_REJECTED
    assert reason in pilot.texts
    assert pilot.texts[-1] == REFUSED
    pilot.run(1.5)
    assert pilot.heartbeat[2] == common.MavState.UNINIT


@pytest.mark.parametrize(
    ("mode", "reason"),
    [
        ((1, 0), "Preflight Fail: No manual control input"),
        ((4, 4), "Preflight Fail: No valid mission available"),
        ((4, 5), "Preflight Fail: Mode not suitable for arming"),
        ((6, 0), "Preflight Fail: No offboard signal"),
    ],
)
def test_the_mode_must_be_one_to_arm_in(mode: tuple[int, int], reason: str) -> None:
    pilot = Pilot()
    assert pilot.set_mode(*mode) == RESULT.ACCEPTED
    assert pilot.command(CMD.COMPONENT_ARM_DISARM, 1) == RESULT.TEMPORARILY_REJECTED
    assert pilot.texts[-2:] == [reason, REFUSED]


def test_satellites_are_needed_if_the_parameter_says_so() -> None:
    pilot = Pilot()
    pilot.vehicle.parameters.set("COM_ARM_WO_GPS", 0)
    pilot.vehicle.faults.inject("gps off")
    pilot.set_mode(7)
    pilot.run(3.0)
    assert "Preflight Fail: GPS fix too low" in pilot.texts


def test_a_ground_station_is_needed_if_its_loss_would_count() -> None:
    pilot = Pilot(ready=False)
    pilot.vehicle.parameters.set("NAV_DLL_ACT", 2)
    for _ in range(200):
        pilot.simulation.step()
    assert "Preflight Fail: No connection to the GCS" in list(
        pilot.vehicle.profile.arming_problems(pilot.autopilot)
    )
    pilot.run(1.0)
    assert not list(pilot.vehicle.profile.arming_problems(pilot.autopilot))


def test_it_is_not_armed_while_it_is_calibrated() -> None:
    pilot = Pilot()
    assert pilot.command(CMD.PREFLIGHT_CALIBRATION, 1) == RESULT.ACCEPTED
    pilot.run(0.5)
    assert pilot.command(CMD.COMPONENT_ARM_DISARM, 1) == RESULT.TEMPORARILY_REJECTED
    assert pilot.texts[-1] == "Arming denied: calibrating"
    pilot.run(1.0)
    assert pilot.heartbeat[2] == common.MavState.CALIBRATING
    pilot.run(3.0)
    assert pilot.texts[-1] == "[cal] calibration done: gyro"
    assert [text for text in pilot.texts if "started" in text] == ["[cal] calibration started: 2 gyro"]
    pilot.arm()
    assert pilot.command(CMD.PREFLIGHT_CALIBRATION, 1) == RESULT.TEMPORARILY_REJECTED


def test_a_terminated_flight_is_over_for_good() -> None:
    pilot = Pilot()
    assert pilot.command(CMD.DO_FLIGHTTERMINATION, 1) == RESULT.DENIED
    pilot.in_the_air()
    assert pilot.command(CMD.DO_FLIGHTTERMINATION, 1) == RESULT.ACCEPTED
    pilot.run(5.0)
    assert pilot.heartbeat[1:] == ((10, 0), common.MavState.FLIGHT_TERMINATION)
    assert pilot.height < 0.5
    assert pilot.set_mode(4, 3) == RESULT.TEMPORARILY_REJECTED
    assert pilot.command(CMD.COMPONENT_ARM_DISARM, 1) == RESULT.TEMPORARILY_REJECTED
