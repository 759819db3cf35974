"""GPS loss and spoofing, compass errors and motor failures: reactions and status texts."""

from __future__ import annotations

from math import hypot
from typing import Any

import pytest

from tests.sim.failsafes.cases import Case, run_cases
from tests.sim.harness import VehicleHarness, airborne, grounded

GLITCH, CLEARED = "GPS Glitch or Compass error", "Glitch cleared"
VARIANCE, FAILSAFE = "EKF variance", "EKF failsafe"
TO_LAND, TO_ALT_HOLD = "EKF Failsafe: changed to LAND Mode", "EKF Failsafe: changed to ALT_HOLD Mode"
DESCEND = "Failsafe activated: Autopilot disengaged, switching to Descend"
OFF = ("gps off",)


def open_throttle(one: VehicleHarness) -> None:
    one.autopilot.radio.move(3, 1500)


def lost(
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
    lost("copter-land", "copter", "LAND", GLITCH, VARIANCE, TO_LAND, "EKF3 IMU0 stopped aiding"),
    lost("copter-land-1", "copter", "LAND", VARIANCE, TO_LAND, action=1, begin="RTL"),
    lost("copter-alt-hold", "copter", "ALT_HOLD", VARIANCE, TO_ALT_HOLD, action=2, before=open_throttle),
    lost("copter-alt-hold-without-radio", "copter", "LAND", VARIANCE, TO_LAND, action=2,
         faults=("gps off", "radio off"), parameters={"FS_THR_ENABLE": 1, "RC_FS_TIMEOUT": 1}),
    lost("copter-by-hand", "copter", "STABILIZE", VARIANCE, begin="STABILIZE", before=open_throttle),
    lost("copter-land-even-by-hand", "copter", "LAND", VARIANCE, TO_LAND, begin="STABILIZE", action=3,
         before=open_throttle),
    lost("copter-disabled", "copter", "GUIDED", GLITCH, parameters={"FS_EKF_THRESH": 0}),
    lost("copter-disarmed", "copter", "STABILIZE", GLITCH, VARIANCE, arms=False, armed=False),
    lost("copter-compass", "copter", "LAND", GLITCH, VARIANCE, TO_LAND, faults=("compass 120",)),
    lost("copter-compass-a-little", "copter", "GUIDED", faults=("compass 20",)),
    lost("rover-hold", "rover", "HOLD", VARIANCE, FAILSAFE),
    lost("rover-0", "rover", "GUIDED", VARIANCE, action=0),
    lost("rover-report", "rover", "GUIDED", VARIANCE, FAILSAFE, action=2),
    lost("rover-by-hand", "rover", "MANUAL", VARIANCE, begin="MANUAL"),
    lost("rover-disarmed", "rover", "HOLD", begin="HOLD", arms=False, armed=False),
    lost("boat-hold", "boat", "HOLD", VARIANCE, FAILSAFE),
    lost("vtol-hovering", "vtol", "QHOVER", VARIANCE, begin="QLOITER", before=open_throttle),
    lost("plane", "plane", "LOITER", "EKF3 IMU0 stopped aiding", begin="LOITER"),
]  # fmt: skip
for _scene in ARDUPILOT:
    if _scene.name == "rover-disarmed":
        _scene.mode = "MANUAL"
PX4 = [
    lost("copter", "copter", "Descend", DESCEND, "Failsafe activated"),
    lost("copter-return", "copter", "Descend", DESCEND, begin="Return"),
    lost("copter-land", "copter", "Descend", DESCEND, begin="Land"),
    lost("copter-terminate", "copter", "Termination", "Failsafe activated", armed=False,
         parameters={"COM_POS_FS_ACT": 1}),
    lost("copter-disarmed", "copter", "Hold", arms=False, armed=False),
    lost("plane", "plane", "Descend", DESCEND),
    lost("vtol", "vtol", "Descend", DESCEND),
    lost("rover", "rover", "Descend", DESCEND),
    lost("boat", "boat", "Descend", DESCEND),
    lost("sub", "sub", "Descend", DESCEND),
]  # fmt: skip


@pytest.fixture(scope="module")
def ardupilot() -> dict[str, VehicleHarness]:
    return run_cases(ARDUPILOT, "ardupilot", 7.5)


@pytest.fixture(scope="module")
def px4() -> dict[str, VehicleHarness]:
    return run_cases(PX4, "px4", 7.0)


def check(one: VehicleHarness, case: Case) -> None:
    assert (one.mode, one.armed) == (case.mode, case.armed), list(one.texts)
    assert set(case.texts) <= set(one.texts), list(one.texts)


@pytest.mark.parametrize("case", ARDUPILOT, ids=lambda case: case.name)
def test_without_a_position_an_ardupilot_does_what_fs_ekf_action_says(ardupilot, case) -> None:
    one = ardupilot[case.name]
    check(one, case)
    watched = {"copter-disabled", "copter-compass-a-little", "plane"}
    assert one.critical == (one.armed and case.name not in watched)


@pytest.mark.parametrize("case", PX4, ids=lambda case: case.name)
def test_without_a_position_a_px4_descends(px4, case) -> None:
    check(px4[case.name], case)
    assert px4[case.name].critical == case.armed


def test_ardupilot_acts_six_seconds_after_the_last_fix() -> None:
    copter = airborne()
    begun = copter.vehicle.now
    copter.inject("gps off").run(7)
    assert copter.texts.time_of(VARIANCE) - begun == pytest.approx(6.0, abs=0.3)
    assert copter.texts.time_of(GLITCH) < copter.texts.time_of(VARIANCE)


def test_when_the_position_is_back_ardupilot_says_so_and_goes_on_landing() -> None:
    copter, rover = airborne(), airborne("rover")
    for one in (copter, rover):
        one.inject("gps off").run(7).inject("gps on").run(2.5)
        assert not one.critical
    assert {"EKF Failsafe Cleared", CLEARED, "EKF3 IMU0 is using GPS"} <= set(copter.texts)
    assert copter.mode == "LAND"
    assert rover.texts[-1] == "EKF failsafe cleared"
    assert rover.mode == "HOLD"


def test_when_the_position_is_back_px4_goes_on_with_what_it_was_to_do() -> None:
    copter = airborne("copter", "px4").inject("gps off").run(6)
    assert copter.mode == "Descend"
    copter.inject("gps on").run(1)
    assert copter.mode == "Hold"
    assert not copter.critical


def test_a_px4_with_a_pilot_is_given_into_his_hands() -> None:
    from mavstack.dialects import common

    copter = airborne("copter", "px4")
    copter.repeated_message = lambda: common.ManualControl(target=1, x=0, y=0, z=500, r=0)
    copter.enter("Position").run(1).inject("gps off").run(6)
    assert copter.mode == "Altitude"
    assert "Failsafe activated: Autopilot disengaged, switching to Altitude mode" in copter.texts


def test_what_lands_without_a_position_comes_down_and_is_disarmed() -> None:
    copter = airborne().inject("gps off")
    copter.run_until(lambda: not copter.armed, timeout=90)
    assert copter.autopilot.landed


@pytest.mark.parametrize("firmware", ["ardupilot", "px4"])
def test_a_vehicle_follows_a_receiver_that_is_led_astray(firmware) -> None:
    copter = airborne("copter", firmware)
    believed = copter.vehicle.body.estimate
    copter.inject("gps spoof 60 -30").run(25)
    truth, estimate = copter.vehicle.body.truth, copter.vehicle.body.estimate
    assert hypot(truth.north + 60, truth.east - 30) < 8, "it flies away"
    assert hypot(estimate.north - believed.north, estimate.east - believed.east) < 8, "and does not know it"
    assert copter.mode == ("GUIDED" if firmware == "ardupilot" else "Hold")
    if firmware == "ardupilot":
        assert copter.texts.index(GLITCH) < copter.texts.index(CLEARED)


def test_while_it_jumps_the_estimate_does_not_fit() -> None:
    copter = airborne()
    assert copter.vehicle.body.health.position_variance < 0.5
    copter.inject("gps spoof 60 0").run(0.2)
    assert copter.vehicle.body.health.position_variance > 5


def test_a_quad_that_loses_a_motor_comes_down_and_a_copter_notices() -> None:
    copter = airborne().inject("motor 2 off")
    copter.run_until(lambda: not copter.armed, timeout=30)
    assert copter.texts.index("Potential Thrust Loss (2)") < copter.texts.index(copter.texts.first("Crash: "))
    assert copter.texts.first("Crash: Disarming: AngErr=")
    assert copter.autopilot.disarm_reason == "crash"
    assert copter.vehicle.body.on_ground


def test_without_the_crash_check_it_stays_armed() -> None:
    copter = airborne(FS_CRASH_CHECK=0).inject("motor 2 off").run(14)
    assert copter.vehicle.body.on_ground
    assert copter.armed
    assert not copter.texts.first("Crash")


def test_a_gentle_landing_is_no_crash() -> None:
    copter = airborne(mode="LAND", LAND_SPEED=150)
    copter.run_until(lambda: not copter.armed, timeout=60)
    assert not copter.texts.first("Crash")
    assert not copter.texts.first("Potential")


def test_on_the_ground_without_gps_arming_is_refused() -> None:
    copter = grounded("copter", "ardupilot")
    copter.enter("GUIDED").inject("gps off").run(7)
    assert "Arm: Need Position Estimate" in copter.autopilot.arm()
    px4 = grounded("copter", "px4").inject("gps off").run(7)
    assert "Preflight Fail: No valid global position estimate" in px4.autopilot.arm()
