"""Copter's failsafes: every action of every parameter, its fallback, and its status texts."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.services import Address
from mavstack.services.mission import MissionItem
from tests.sim.failsafes.cases import Case, run_cases, stop_heartbeats
from tests.sim.harness import CMD, VehicleHarness, airborne

#: One worker flies the cases, all at the same time.
pytestmark = pytest.mark.xdist_group("failsafes of copter")

RADIO, GROUND = "Radio Failsafe", "GCS Failsafe"


def waypoint(latitude: float = 47.41) -> MissionItem:
    frame = common.MavFrame.GLOBAL_RELATIVE_ALT
    return MissionItem(CMD.NAV_WAYPOINT, param5=latitude, param6=8.5456, param7=30.0, frame=frame)


def with_mission(harness: VehicleHarness) -> None:
    harness.load(waypoint(), waypoint(47.42))


def with_landing(harness: VehicleHarness) -> None:
    harness.load(waypoint(), MissionItem(CMD.DO_LAND_START), waypoint(47.42))


def close_throttle(harness: VehicleHarness) -> None:
    harness.autopilot.radio.move(3, 1000)


def open_throttle(harness: VehicleHarness) -> None:
    harness.autopilot.radio.move(3, 1500)


def close_gripper(harness: VehicleHarness) -> None:
    harness.autopilot.payload.grip(closed=True)


def by_radio(value: int, mode: str, *texts: str, name: str = "", **more: object) -> Case:
    return Case(
        name or f"radio-{value}",
        parameters={"FS_THR_ENABLE": value, **more.pop("parameters", {})},
        faults=("radio off",),
        mode=mode,
        texts=texts,
        **more,
    )


def by_ground(value: int, mode: str, *texts: str, name: str = "", **more: object) -> Case:
    parameters = {"FS_GCS_ENABLE": value, "FS_GCS_TIMEOUT": 2, **more.pop("parameters", {})}
    return Case(
        name or f"ground-{value}",
        parameters=parameters,
        sends_heartbeats=True,
        event=stop_heartbeats,
        mode=mode,
        texts=texts,
        **more,
    )


def by_battery(
    value: int, mode: str, *texts: str, name: str = "", level: str = "LOW", **more: object
) -> Case:
    parameters = {f"BATT_FS_{level}_ACT": value, "BATT_LOW_TIMER": 1, **more.pop("parameters", {})}
    if level == "CRT":
        parameters |= {"BATT_CRT_VOLT": 13.5, "BATT_LOW_VOLT": 0}
    return Case(
        name or f"battery-{level}-{value}",
        parameters=parameters,
        faults=("battery sag 4",),
        mode=mode,
        texts=texts,
        **more,
    )


NO_LANDING = "Mode change to AUTO_RTL failed: init failed"
CASES = [
    by_radio(0, "GUIDED"),
    by_radio(1, "RTL", RADIO),
    by_radio(2, "RTL", RADIO),
    by_radio(3, "LAND", RADIO),
    by_radio(4, "SMART_RTL", RADIO),
    by_radio(5, "SMART_RTL", RADIO),
    by_radio(6, "RTL", RADIO, NO_LANDING, "Trying RTL Mode"),
    by_radio(6, "AUTO_RTL", RADIO, name="radio-6-landing", before=with_landing),
    by_radio(7, "BRAKE", RADIO),
    by_radio(9, "LAND", RADIO),
    by_radio(1, "AUTO", "Radio Failsafe - Continuing Auto", name="radio-in-auto", begin="AUTO",
             before=with_mission, parameters={"FS_OPTIONS": 1}),
    by_radio(1, "RTL", RADIO, name="radio-in-auto-without-option", begin="AUTO", before=with_mission),
    by_radio(1, "GUIDED", "Radio Failsafe - Continuing Guided Mode", name="radio-in-guided",
             parameters={"FS_OPTIONS": 4}),
    by_radio(1, "LAND", "Radio Failsafe - Continuing Landing", name="radio-landing", begin="LAND",
             parameters={"FS_OPTIONS": 8}),
    by_radio(1, "RTL", RADIO, name="radio-while-landing", begin="LAND"),
    by_radio(1, "GUIDED", "Radio Failsafe - Disarming", "Disarming motors", name="radio-on-the-ground",
             grounded=True, begin="GUIDED", armed=False),
    by_radio(1, "STABILIZE", "Radio Failsafe - Disarming", name="radio-disarmed", arms=False, armed=False),
    by_radio(1, "STABILIZE", "Radio Failsafe - Disarming", name="radio-throttle-closed", begin="STABILIZE",
             before=close_throttle, armed=False),
    by_radio(1, "RTL", RADIO, name="radio-by-hand", begin="ALT_HOLD", before=open_throttle),
    by_radio(1, "RTL", RADIO, name="radio-gripper", before=close_gripper,
             parameters={"FS_OPTIONS": 32}),
    by_radio(1, "RTL", RADIO, name="radio-no-gripper", before=close_gripper),
    by_ground(0, "GUIDED"),
    by_ground(1, "RTL", GROUND),
    by_ground(2, "RTL", GROUND),
    by_ground(3, "SMART_RTL", GROUND),
    by_ground(4, "SMART_RTL", GROUND),
    by_ground(5, "LAND", GROUND),
    by_ground(6, "RTL", GROUND, NO_LANDING, "Trying RTL Mode"),
    by_ground(7, "BRAKE", GROUND),
    by_ground(9, "RTL", GROUND),
    by_ground(1, "AUTO", "GCS Failsafe - Continuing Auto Mode", name="ground-in-auto", begin="AUTO",
              before=with_mission, parameters={"FS_OPTIONS": 2}),
    by_ground(1, "LOITER", "GCS Failsafe - Continuing Pilot Control", name="ground-by-hand",
              begin="LOITER", before=open_throttle),
    by_ground(1, "LAND", "GCS Failsafe - Continuing Landing", name="ground-landing", begin="LAND",
              parameters={"FS_OPTIONS": 8}),
    by_ground(1, "GUIDED", "GCS Failsafe - Disarming", name="ground-on-the-ground", grounded=True,
              begin="GUIDED", armed=False),
    by_ground(1, "STABILIZE", GROUND, name="ground-disarmed", arms=False, armed=False),
    by_battery(0, "GUIDED", "Battery Failsafe"),
    by_battery(1, "LAND", "Battery Failsafe"),
    by_battery(2, "RTL", "Battery Failsafe"),
    by_battery(3, "SMART_RTL", "Battery Failsafe"),
    by_battery(4, "SMART_RTL", "Battery Failsafe"),
    by_battery(5, "GUIDED", "Battery Failsafe", armed=False),
    by_battery(6, "RTL", "Battery Failsafe", "Trying RTL Mode"),
    by_battery(7, "BRAKE", "Battery Failsafe"),
    by_battery(1, "LAND", "Battery Failsafe", level="CRT"),
    by_battery(2, "RTL", "Battery Failsafe", level="CRT"),
    by_battery(2, "GUIDED", "Battery Failsafe - Disarming", name="battery-on-the-ground", grounded=True,
               begin="GUIDED", armed=False),
    by_battery(2, "LAND", "Battery Failsafe - Continuing Landing", name="battery-landing", begin="LAND",
               parameters={"FS_OPTIONS": 8}),
    Case("battery-disarmed", parameters={"BATT_FS_LOW_ACT": 2, "BATT_LOW_TIMER": 1}, arms=False, armed=False,
          faults=("battery sag 4",), mode="STABILIZE"),
    Case("battery-not-watched", parameters={"BATT_MONITOR": 0, "BATT_FS_LOW_ACT": 2, "BATT_LOW_TIMER": 1},
          faults=("battery sag 4",), mode="GUIDED"),
    Case("battery-by-charge", parameters={"BATT_FS_LOW_ACT": 2, "BATT_LOW_TIMER": 1, "BATT_LOW_MAH": 2600,
          "BATT_LOW_VOLT": 0}, faults=("battery 40",), mode="RTL", texts=("Battery Failsafe",)),
    Case("battery-then-radio", parameters={"BATT_FS_LOW_ACT": 1, "BATT_LOW_TIMER": 1, "RC_FS_TIMEOUT": 2.5},
          faults=("battery sag 4", "radio off"), mode="LAND",
          texts=("Battery Failsafe", "Radio + Battery Failsafe - Continuing Landing")),
]  # fmt: skip
WITHOUT_FAILSAFE = {"radio-0", "ground-0", "battery-not-watched", "battery-disarmed"}


@pytest.fixture(scope="module")
def results() -> dict[str, VehicleHarness]:
    return run_cases(CASES, "ardupilot")


@pytest.mark.flight
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_failsafe_action_and_status_texts(results, case) -> None:
    harness = results[case.name]
    assert (harness.mode, harness.armed) == (case.mode, case.armed), list(harness.texts)
    assert set(case.texts) <= set(harness.texts), list(harness.texts)
    if case.name in WITHOUT_FAILSAFE:
        assert not harness.texts
        assert not harness.critical


@pytest.mark.flight
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_state_is_critical_while_a_failsafe_is_active_and_the_vehicle_armed(results, case) -> None:
    harness = results[case.name]
    assert harness.critical == (harness.armed and case.name not in WITHOUT_FAILSAFE)


def test_low_battery_text_contains_voltage_and_charge(results) -> None:
    battery = results["battery-LOW-2"].texts.first("Battery 1 is low ")
    assert battery.endswith(" mAh")
    assert 11.0 < float(battery.split()[4].removesuffix("V")) < 14.0
    assert results["battery-CRT-2"].texts.first("Battery 1 is critical ")


def test_fs_options_opens_the_gripper(results) -> None:
    assert not results["radio-gripper"].autopilot.payload.gripper_closed
    assert results["radio-no-gripper"].autopilot.payload.gripper_closed


@pytest.mark.flight
def test_lands_if_rtl_is_impossible() -> None:
    copter = airborne(mode="ALT_HOLD", FS_EKF_THRESH=0).inject("gps off")
    open_throttle(copter)
    copter.run(6).inject("radio off").run(2)
    assert copter.mode == "LAND"
    assert "Mode change to RTL failed: requires position" in copter.texts


@pytest.mark.flight
def test_recovery_is_reported_and_keeps_the_mode() -> None:
    copter = airborne(FS_THR_ENABLE=1, FS_GCS_ENABLE=1, FS_GCS_TIMEOUT=2)
    copter.inject("radio off")
    copter.sends_heartbeats = False
    copter.run(4)
    assert copter.critical
    copter.inject("radio on")
    copter.sends_heartbeats = True
    copter.run(2)
    assert {"Radio Failsafe Cleared", "GCS Failsafe Cleared"} <= set(copter.texts)
    assert copter.mode == "RTL"
    assert not copter.critical


@pytest.mark.flight
def test_failsafe_acts_once_and_allows_a_mode_change() -> None:
    copter = airborne(FS_GCS_ENABLE=1, FS_GCS_TIMEOUT=2)
    copter.sends_heartbeats = False
    copter.run(4)
    assert copter.mode == "RTL"
    copter.enter("GUIDED").run(5)
    assert copter.mode == "GUIDED"
    assert copter.texts.count("GCS Failsafe") == 1


@pytest.mark.flight
def test_delays_follow_their_parameters() -> None:
    copter = airborne(FS_GCS_ENABLE=1, FS_GCS_TIMEOUT=4, RC_FS_TIMEOUT=1.5, BATT_FS_LOW_ACT=1)
    start = copter.vehicle.now
    copter.inject("radio off", "battery sag 4")
    copter.sends_heartbeats = False
    copter.run(11)
    times = {text: copter.texts.time_of(text) - start for text in ("Radio Failsafe", "GCS Failsafe")}
    assert times["Radio Failsafe"] == pytest.approx(1.5, abs=0.2)
    assert 3 <= times["GCS Failsafe"] <= 4.2
    low = copter.texts.first("Battery 1 is low")
    assert copter.texts.time_of(low) - start == pytest.approx(10, abs=0.3)  # BATT_LOW_TIMER


@pytest.mark.flight
def test_only_the_ground_station_of_sysid_mygcs_is_monitored() -> None:
    copter = airborne(FS_GCS_ENABLE=1, FS_GCS_TIMEOUT=2)
    copter.source = Address(254, 190)
    copter.run(4)
    assert "GCS Failsafe" in copter.texts
    unconnected = airborne(FS_GCS_ENABLE=1, FS_GCS_TIMEOUT=2, SYSID_MYGCS=7).run(4)
    assert "GCS Failsafe" not in unconnected.texts, "a ground station that never connected is not lost"


@pytest.mark.flight
def test_returns_home_and_disarms() -> None:
    copter = airborne(FS_THR_ENABLE=1, RTL_ALT=0, RTL_LOIT_TIME=0)
    copter.inject("radio off").run_until(lambda: not copter.armed, timeout=90)
    assert copter.autopilot.landed
    assert abs(copter.vehicle.body.truth.north) < 2
    assert copter.texts[-1] == "Disarming motors"
