"""Arming and disarming of PX4: answers and status texts."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from tests.sim.px4.harness import CMD, RESULT, Px4Harness

ARMING_DENIED = "Arming denied: Resolve system health failures first"
FORCE = 21196


@pytest.mark.flight
def test_armed_vehicle_disarms_without_takeoff() -> None:
    harness = Px4Harness()
    harness.arm()
    assert harness.texts[-1] == "Armed by external command"
    harness.run(10.5)
    assert harness.autopilot.armed
    harness.run(1.0)
    assert not harness.autopilot.armed
    assert harness.texts[-1] == "Disarmed by auto preflight disarming"


@pytest.mark.flight
def test_stays_armed_without_com_disarm_prflt() -> None:
    harness = Px4Harness()
    harness.vehicle.parameters.set("COM_DISARM_PRFLT", -1.0)
    harness.arm()
    harness.run(20.0)
    assert harness.autopilot.armed


def test_disarmed_by_command_on_the_ground() -> None:
    harness = Px4Harness()
    harness.arm()
    assert harness.command(CMD.COMPONENT_ARM_DISARM, 0) == RESULT.ACCEPTED
    assert harness.texts[-1] == "Disarmed by external command"


@pytest.mark.flight
def test_disarming_in_the_air_is_denied_unless_forced() -> None:
    harness = Px4Harness().take_off()
    assert harness.command(CMD.COMPONENT_ARM_DISARM, 0) == RESULT.TEMPORARILY_REJECTED
    assert harness.texts[-1] == "Disarming denied: not landed"
    assert harness.command(CMD.COMPONENT_ARM_DISARM, 0, FORCE) == RESULT.ACCEPTED
    assert not harness.autopilot.armed
    harness.run_until(lambda: harness.height < 0.1, timeout=20)


def test_invalid_arm_parameter_is_reported() -> None:
    harness = Px4Harness()
    assert harness.command(CMD.COMPONENT_ARM_DISARM, 7) == RESULT.UNSUPPORTED
    assert harness.texts[-1] == "Unsupported ARM_DISARM param: 7.000"


def test_arming_is_denied_before_the_estimate_is_valid() -> None:
    harness = Px4Harness(ready=False)
    harness.run(0.5)
    assert harness.command(CMD.COMPONENT_ARM_DISARM, 1) == RESULT.TEMPORARILY_REJECTED
    assert harness.texts[-2:] == ["Preflight Fail: ekf2 missing data", ARMING_DENIED]
    assert harness.command(CMD.COMPONENT_ARM_DISARM, 1, FORCE) == RESULT.TEMPORARILY_REJECTED


@pytest.mark.fast_cases(3)
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
def test_fault_prevents_arming_and_is_reported(fault: str, reason: str) -> None:
    harness = Px4Harness()
    harness.vehicle.faults.inject(fault)
    harness.run_until(lambda: reason in harness.texts, timeout=40)
    assert harness.heartbeat[2] in (common.MavState.UNINIT, common.MavState.STANDBY)
    harness.texts.clear()
    assert harness.command(CMD.COMPONENT_ARM_DISARM, 1) == RESULT.TEMPORARILY_REJECTED
    assert reason in harness.texts
    assert harness.texts[-1] == ARMING_DENIED
    harness.run(1.5)
    assert harness.heartbeat[2] == common.MavState.UNINIT


@pytest.mark.parametrize(
    ("mode", "reason"),
    [
        ((1, 0), "Preflight Fail: No manual control input"),
        ((4, 4), "Preflight Fail: No valid mission available"),
        ((4, 5), "Preflight Fail: Mode not suitable for arming"),
        ((6, 0), "Preflight Fail: No offboard signal"),
    ],
)
def test_arming_depends_on_the_mode(mode: tuple[int, int], reason: str) -> None:
    harness = Px4Harness()
    assert harness.set_mode(*mode) == RESULT.ACCEPTED
    assert harness.command(CMD.COMPONENT_ARM_DISARM, 1) == RESULT.TEMPORARILY_REJECTED
    assert harness.texts[-2:] == [reason, ARMING_DENIED]


@pytest.mark.flight
def test_com_arm_wo_gps_requires_gps() -> None:
    harness = Px4Harness()
    harness.vehicle.parameters.set("COM_ARM_WO_GPS", 0)
    harness.vehicle.faults.inject("gps off")
    harness.set_mode(7)
    harness.run(3.0)
    assert "Preflight Fail: GPS fix too low" in harness.texts


def test_nav_dll_act_requires_a_ground_station() -> None:
    harness = Px4Harness(ready=False)
    harness.vehicle.parameters.set("NAV_DLL_ACT", 2)
    for _ in range(200):
        harness.simulation.step()
    assert "Preflight Fail: No connection to the GCS" in list(
        harness.vehicle.profile.arming_problems(harness.autopilot)
    )
    harness.run(1.0)
    assert not list(harness.vehicle.profile.arming_problems(harness.autopilot))


@pytest.mark.flight
def test_arming_is_denied_while_calibrating() -> None:
    harness = Px4Harness()
    assert harness.command(CMD.PREFLIGHT_CALIBRATION, 1) == RESULT.ACCEPTED
    harness.run(0.5)
    assert harness.command(CMD.COMPONENT_ARM_DISARM, 1) == RESULT.TEMPORARILY_REJECTED
    assert harness.texts[-1] == "Arming denied: calibrating"
    harness.run(1.0)
    assert harness.heartbeat[2] == common.MavState.CALIBRATING
    harness.run(3.0)
    assert harness.texts[-1] == "[cal] calibration done: gyro"
    assert [text for text in harness.texts if "started" in text] == ["[cal] calibration started: 2 gyro"]
    harness.arm()
    assert harness.command(CMD.PREFLIGHT_CALIBRATION, 1) == RESULT.TEMPORARILY_REJECTED


@pytest.mark.flight
def test_flight_termination_is_final() -> None:
    harness = Px4Harness()
    assert harness.command(CMD.DO_FLIGHTTERMINATION, 1) == RESULT.DENIED
    harness.take_off()
    assert harness.command(CMD.DO_FLIGHTTERMINATION, 1) == RESULT.ACCEPTED
    harness.run(5.0)
    assert harness.heartbeat[1:] == ((10, 0), common.MavState.FLIGHT_TERMINATION)
    assert harness.height < 0.5
    assert harness.set_mode(4, 3) == RESULT.TEMPORARILY_REJECTED
    assert harness.command(CMD.COMPONENT_ARM_DISARM, 1) == RESULT.TEMPORARILY_REJECTED
