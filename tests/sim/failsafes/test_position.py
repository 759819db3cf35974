"""GPS loss and spoofing, compass errors and motor failures: reactions and status texts."""

from __future__ import annotations

from math import hypot
from typing import Any

import pytest

from tests.sim.failsafes.cases import Case, run_cases
from tests.sim.harness import VehicleHarness, airborne, grounded

#: One worker flies the cases, all at the same time.
pytestmark = pytest.mark.xdist_group("failsafes of position")

GLITCH, CLEARED = "GPS Glitch or Compass error", "Glitch cleared"
VARIANCE, FAILSAFE = "EKF variance", "EKF failsafe"
TO_LAND, TO_ALT_HOLD = "EKF Failsafe: changed to LAND Mode", "EKF Failsafe: changed to ALT_HOLD Mode"
DESCEND = "Failsafe activated: Autopilot disengaged, switching to Descend"
OFF = ("gps off",)


def open_throttle(harness: VehicleHarness) -> None:
    harness.autopilot.radio.move(3, 1500)


def gps_loss(
    name: str,
    kind: str,
    mode: str,
    *texts: str,
    begin: str | None = None,
    action: float | None = None,
    **more: Any,
) -> Case:
    parameters = {} if action is None else {"FS_EKF_ACTION": action}
    return Case(
        name,
        kind,
        parameters | more.pop("parameters", {}),
        more.pop("faults", OFF),
        begin,
        mode=mode,
        texts=texts,
        **more,
    )


ARDUPILOT = [
    gps_loss("copter-land", "copter", "LAND", GLITCH, VARIANCE, TO_LAND, "EKF3 IMU0 stopped aiding"),
    gps_loss("copter-land-1", "copter", "LAND", VARIANCE, TO_LAND, action=1, begin="RTL"),
    gps_loss("copter-alt-hold", "copter", "ALT_HOLD", VARIANCE, TO_ALT_HOLD, action=2, before=open_throttle),
    gps_loss("copter-alt-hold-without-radio", "copter", "LAND", VARIANCE, TO_LAND, action=2,
         faults=("gps off", "radio off"), parameters={"FS_THR_ENABLE": 1, "RC_FS_TIMEOUT": 1}),
    gps_loss("copter-by-hand", "copter", "STABILIZE", VARIANCE, begin="STABILIZE", before=open_throttle),
    gps_loss("copter-land-even-by-hand", "copter", "LAND", VARIANCE, TO_LAND, begin="STABILIZE", action=3,
         before=open_throttle),
    gps_loss("copter-disabled", "copter", "GUIDED", GLITCH, parameters={"FS_EKF_THRESH": 0}),
    gps_loss("copter-disarmed", "copter", "STABILIZE", GLITCH, VARIANCE, arms=False, armed=False),
    gps_loss("copter-compass", "copter", "LAND", GLITCH, VARIANCE, TO_LAND, faults=("compass 120",)),
    gps_loss("copter-compass-a-little", "copter", "GUIDED", faults=("compass 20",)),
    gps_loss("rover-hold", "rover", "HOLD", VARIANCE, FAILSAFE),
    gps_loss("rover-0", "rover", "GUIDED", VARIANCE, action=0),
    gps_loss("rover-report", "rover", "GUIDED", VARIANCE, FAILSAFE, action=2),
    gps_loss("rover-by-hand", "rover", "MANUAL", VARIANCE, begin="MANUAL"),
    gps_loss("rover-disarmed", "rover", "HOLD", begin="HOLD", arms=False, armed=False),
    gps_loss("boat-hold", "boat", "HOLD", VARIANCE, FAILSAFE),
    gps_loss("vtol-hovering", "vtol", "QHOVER", VARIANCE, begin="QLOITER", before=open_throttle),
    gps_loss("plane", "plane", "LOITER", "EKF3 IMU0 stopped aiding", begin="LOITER"),
]  # fmt: skip
for _case in ARDUPILOT:
    if _case.name == "rover-disarmed":
        _case.mode = "MANUAL"
PX4 = [
    gps_loss("copter", "copter", "Descend", DESCEND, "Failsafe activated"),
    gps_loss("copter-return", "copter", "Descend", DESCEND, begin="Return"),
    gps_loss("copter-land", "copter", "Descend", DESCEND, begin="Land"),
    gps_loss("copter-terminate", "copter", "Termination", "Failsafe activated", armed=False,
         parameters={"COM_POS_FS_ACT": 1}),
    gps_loss("copter-disarmed", "copter", "Hold", arms=False, armed=False),
    gps_loss("plane", "plane", "Descend", DESCEND),
    gps_loss("vtol", "vtol", "Descend", DESCEND),
    gps_loss("rover", "rover", "Descend", DESCEND),
    gps_loss("boat", "boat", "Descend", DESCEND),
    gps_loss("sub", "sub", "Descend", DESCEND),
]  # fmt: skip


@pytest.fixture(scope="module")
def ardupilot() -> dict[str, VehicleHarness]:
    return run_cases(ARDUPILOT, "ardupilot", 7.5)


@pytest.fixture(scope="module")
def px4() -> dict[str, VehicleHarness]:
    return run_cases(PX4, "px4", 7.0)


def check(harness: VehicleHarness, case: Case) -> None:
    assert (harness.mode, harness.armed) == (case.mode, case.armed), list(harness.texts)
    assert set(case.texts) <= set(harness.texts), list(harness.texts)


@pytest.mark.flight_cases(8)
@pytest.mark.flight
@pytest.mark.parametrize("case", ARDUPILOT, ids=lambda case: case.name)
def test_ardupilot_executes_fs_ekf_action(ardupilot, case) -> None:
    harness = ardupilot[case.name]
    check(harness, case)
    without_failsafe = {"copter-disabled", "copter-compass-a-little", "plane"}
    assert harness.critical == (harness.armed and case.name not in without_failsafe)


@pytest.mark.flight
@pytest.mark.parametrize("case", PX4, ids=lambda case: case.name)
def test_px4_descends_without_a_position(px4, case) -> None:
    check(px4[case.name], case)
    assert px4[case.name].critical == case.armed


@pytest.mark.flight
def test_ardupilot_acts_six_seconds_after_the_last_fix() -> None:
    copter = airborne()
    start = copter.vehicle.now
    copter.inject("gps off").run(7)
    assert copter.texts.time_of(VARIANCE) - start == pytest.approx(6.0, abs=0.3)
    assert copter.texts.time_of(GLITCH) < copter.texts.time_of(VARIANCE)


@pytest.mark.flight
def test_ardupilot_reports_recovery_and_keeps_the_mode() -> None:
    copter, rover = airborne(), airborne("rover")
    for harness in (copter, rover):
        harness.inject("gps off").run(7).inject("gps on").run(2.5)
        assert not harness.critical
    assert {"EKF Failsafe Cleared", CLEARED, "EKF3 IMU0 is using GPS"} <= set(copter.texts)
    assert copter.mode == "LAND"
    assert rover.texts[-1] == "EKF failsafe cleared"
    assert rover.mode == "HOLD"


@pytest.mark.flight
def test_px4_resumes_the_chosen_mode_after_recovery() -> None:
    copter = airborne("copter", "px4").inject("gps off").run(6)
    assert copter.mode == "Descend"
    copter.inject("gps on").run(1)
    assert copter.mode == "Hold"
    assert not copter.critical


@pytest.mark.flight
def test_px4_with_manual_control_enters_altitude_mode() -> None:
    from mavstack.dialects import common

    copter = airborne("copter", "px4")
    copter.repeated_message = lambda: common.ManualControl(target=1, x=0, y=0, z=500, r=0)
    copter.enter("Position").run(1).inject("gps off").run(6)
    assert copter.mode == "Altitude"
    assert "Failsafe activated: Autopilot disengaged, switching to Altitude mode" in copter.texts


@pytest.mark.flight
def test_copter_lands_and_disarms_without_a_position() -> None:
    copter = airborne().inject("gps off")
    copter.run_until(lambda: not copter.armed, timeout=90)
    assert copter.autopilot.landed


@pytest.mark.flight_cases(1)
@pytest.mark.flight
@pytest.mark.parametrize("firmware", ["ardupilot", "px4"])
def test_vehicle_follows_a_spoofed_gps(firmware) -> None:
    copter = airborne("copter", firmware)
    before = copter.vehicle.body.estimate
    copter.inject("gps spoof 60 -30").run(25)
    truth, estimate = copter.vehicle.body.truth, copter.vehicle.body.estimate
    assert hypot(truth.north + 60, truth.east - 30) < 8, "the vehicle follows the offset"
    assert hypot(estimate.north - before.north, estimate.east - before.east) < 8, (
        "the estimate does not change"
    )
    assert copter.mode == ("GUIDED" if firmware == "ardupilot" else "Hold")
    if firmware == "ardupilot":
        assert copter.texts.index(GLITCH) < copter.texts.index(CLEARED)


def test_gps_jump_raises_the_position_variance() -> None:
    copter = airborne()
    assert copter.vehicle.body.health.position_variance < 0.5
    copter.inject("gps spoof 60 0").run(0.2)
    assert copter.vehicle.body.health.position_variance > 5


@pytest.mark.flight
def test_motor_failure_is_detected_as_thrust_loss_and_crash() -> None:
    copter = airborne().inject("motor 2 off")
    copter.run_until(lambda: not copter.armed, timeout=30)
    assert copter.texts.index("Potential Thrust Loss (2)") < copter.texts.index(copter.texts.first("Crash: "))
    assert copter.texts.first("Crash: Disarming: AngErr=")
    assert copter.autopilot.disarm_reason == "crash"
    assert copter.vehicle.body.on_ground


@pytest.mark.flight
def test_stays_armed_without_fs_crash_check() -> None:
    copter = airborne(FS_CRASH_CHECK=0).inject("motor 2 off").run(14)
    assert copter.vehicle.body.on_ground
    assert copter.armed
    assert not copter.texts.first("Crash")


@pytest.mark.flight
def test_gentle_landing_is_no_crash() -> None:
    copter = airborne(mode="LAND", LAND_SPEED=150)
    copter.run_until(lambda: not copter.armed, timeout=60)
    assert not copter.texts.first("Crash")
    assert not copter.texts.first("Potential")


@pytest.mark.flight
def test_arming_without_gps_is_refused() -> None:
    copter = grounded("copter", "ardupilot")
    copter.enter("GUIDED").inject("gps off").run(7)
    assert "Arm: Need Position Estimate" in copter.autopilot.arm()
    px4 = grounded("copter", "px4").inject("gps off").run(7)
    assert "Preflight Fail: No valid global position estimate" in px4.autopilot.arm()
