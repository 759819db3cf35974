"""Failsafes of Rover, on wheels and on water, and of Sub."""

from __future__ import annotations

from typing import Any

import pytest

from mavstack.dialects import common
from mavstack.services.mission import MissionItem
from tests.sim.failsafes.cases import Case, run_cases, stop_heartbeats
from tests.sim.harness import CMD, VehicleHarness, airborne, grounded

#: One worker flies the cases, all at the same time.
pytestmark = pytest.mark.xdist_group("failsafes of rover and sub")

RADIO, GROUND = "Radio Failsafe", "GCS Failsafe"
LOST = "MYGCS: 255, heartbeat lost"


def with_mission(harness: VehicleHarness) -> None:
    frame = common.MavFrame.GLOBAL_RELATIVE_ALT
    harness.load(MissionItem(CMD.NAV_WAYPOINT, param5=47.41, param6=8.5456, param7=0.0, frame=frame))


def radio_loss(name: str, mode: str, *texts: str, action: int = 2, kind: str = "rover", **more: Any) -> Case:
    parameters = {"FS_ACTION": action, "FS_THR_ENABLE": 1, **more.pop("parameters", {})}
    begin = more.pop("begin", "GUIDED")
    return Case(name, kind, parameters, ("radio off",), begin, mode=mode, texts=texts, **more)


def ground_loss(name: str, mode: str, *texts: str, kind: str = "rover", **more: Any) -> Case:
    parameters = {"FS_GCS_ENABLE": 1, "FS_GCS_TIMEOUT": 1, "FS_ACTION": 1, **more.pop("parameters", {})}
    begin = more.pop("begin", "GUIDED")
    return Case(
        name,
        kind,
        parameters,
        (),
        begin,
        sends_heartbeats=True,
        event=stop_heartbeats,
        mode=mode,
        texts=texts,
        **more,
    )


def battery(name: str, mode: str, action: int, *texts: str, kind: str = "rover", **more: Any) -> Case:
    parameters = {"BATT_FS_LOW_ACT": action, "BATT_LOW_TIMER": 1}
    begin = more.pop("begin", "GUIDED")
    return Case(name, kind, parameters, ("battery sag 4",), begin, mode=mode, texts=texts, **more)


SUB = {"kind": "sub", "begin": "POSHOLD"}
CASES = [
    radio_loss("action-0", "GUIDED", RADIO, action=0),
    radio_loss("action-1", "RTL", RADIO, action=1),
    radio_loss("action-2", "HOLD", RADIO, action=2),
    radio_loss("action-3", "SMART_RTL", RADIO, action=3),
    radio_loss("action-4", "SMART_RTL", RADIO, action=4),
    radio_loss("action-5", "GUIDED", RADIO, action=5, armed=False),
    radio_loss("action-6", "LOITER", RADIO, action=6),
    radio_loss("boat", "RTL", RADIO, action=1, kind="boat"),
    radio_loss("radio-off", "GUIDED", parameters={"FS_THR_ENABLE": 0}),
    radio_loss("mission-continues", "AUTO", RADIO, "Failsafe - Continuing Auto Mode", begin="AUTO",
          before=with_mission, parameters={"FS_THR_ENABLE": 2}),
    radio_loss("in-rtl", "RTL", action=2, begin="RTL"),
    radio_loss("in-hold", "HOLD", action=1, begin="HOLD"),
    radio_loss("in-hold-with-option", "RTL", RADIO, action=1, begin="HOLD", parameters={"FS_OPTIONS": 1}),
    radio_loss("disarmed", "HOLD", RADIO, arms=False, armed=False),
    ground_loss("ground-1", "RTL", GROUND),
    ground_loss("ground-0", "GUIDED", parameters={"FS_GCS_ENABLE": 0}),
    ground_loss("ground-continues", "AUTO", GROUND, "Failsafe - Continuing Auto Mode", begin="AUTO",
           before=with_mission, parameters={"FS_GCS_ENABLE": 2}),
    battery("battery-0", "GUIDED", 0),
    battery("battery-1", "RTL", 1),
    battery("battery-2", "HOLD", 2),
    battery("battery-3", "SMART_RTL", 3),
    battery("battery-4", "SMART_RTL", 4),
    battery("battery-5", "GUIDED", 5, armed=False),
    battery("battery-6", "LOITER", 6),
    battery("battery-boat", "RTL", 1, kind="boat"),
    ground_loss("sub-ground-0", "POSHOLD", parameters={"FS_GCS_ENABLE": 0}, **SUB),
    ground_loss("sub-ground-1", "POSHOLD", LOST, **SUB),
    ground_loss("sub-ground-2", "POSHOLD", LOST, "Disarming motors", parameters={"FS_GCS_ENABLE": 2},
           armed=False, **SUB),
    ground_loss("sub-ground-3", "ALT_HOLD", LOST, parameters={"FS_GCS_ENABLE": 3}, **SUB),
    ground_loss("sub-ground-4", "SURFACE", LOST, parameters={"FS_GCS_ENABLE": 4}, **SUB),
    ground_loss("sub-disarmed", "MANUAL", LOST, parameters={"FS_GCS_ENABLE": 4}, arms=False, armed=False,
           kind="sub"),
    radio_loss("sub-pilot-0", "POSHOLD", parameters={"FS_PILOT_INPUT": 0}, **SUB),
    radio_loss("sub-pilot-1", "POSHOLD", "Lost manual control", parameters={"FS_PILOT_INPUT": 1,
          "FS_PILOT_TIMEOUT": 1}, **SUB),
    radio_loss("sub-pilot-2", "POSHOLD", "Lost manual control", parameters={"FS_PILOT_INPUT": 2,
          "FS_PILOT_TIMEOUT": 1},
          armed=False, **SUB),
    battery("sub-battery-1", "POSHOLD", 1, **SUB),
    battery("sub-battery-2", "POSHOLD", 2, "Disarming motors", armed=False, **SUB),
    battery("sub-battery-3", "SURFACE", 3, **SUB),
]  # fmt: skip
WITHOUT_TEXTS = {"radio-off", "in-rtl", "in-hold", "ground-0", "sub-ground-0", "sub-pilot-0"}


def without_fs_action(case: Case) -> Case:
    """Return the case; for Sub without FS_ACTION, a parameter that Sub does not have."""
    if case.kind == "sub":
        case.parameters.pop("FS_ACTION", None)
    return case


@pytest.fixture(scope="module")
def results() -> dict[str, VehicleHarness]:
    return run_cases(map(without_fs_action, CASES), "ardupilot")


@pytest.mark.flight
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_failsafe_action_and_status_texts(results, case) -> None:
    harness = results[case.name]
    assert (harness.mode, harness.armed) == (case.mode, case.armed), list(harness.texts)
    assert set(case.texts) <= set(harness.texts), list(harness.texts)
    assert bool(harness.texts) == (case.name not in WITHOUT_TEXTS), list(harness.texts)
    assert harness.critical == (case.armed and case.name not in WITHOUT_TEXTS)


@pytest.mark.flight
def test_rover_failsafe_clears_when_radio_and_ground_station_recover() -> None:
    rover = airborne("rover", FS_ACTION=2, FS_GCS_ENABLE=1, FS_GCS_TIMEOUT=1)
    rover.inject("radio off")
    rover.sends_heartbeats = False
    rover.run(4)
    rover.inject("radio on").run(1)
    assert rover.critical
    assert "Radio Failsafe Cleared" not in rover.texts
    rover.sends_heartbeats = True
    rover.run(1.5)
    assert rover.texts[-1] == "GCS Failsafe Cleared"
    assert rover.mode == "HOLD"
    assert not rover.critical


@pytest.mark.flight
def test_sub_repeats_its_warning_every_30_s() -> None:
    sub = grounded("sub", FS_GCS_TIMEOUT=1)
    sub.without_telemetry().sends_heartbeats = False
    sub.run(35)
    assert sub.texts.count(LOST) == 2


@pytest.mark.flight
def test_sub_surfaces() -> None:
    sub = airborne("sub", mode="POSHOLD", BATT_FS_LOW_ACT=3, BATT_LOW_TIMER=1).inject("battery sag 4")
    sub.run_until(lambda: sub.height > -0.5, timeout=60)
    assert sub.mode == "SURFACE"


@pytest.mark.flight
def test_sub_reports_a_compass_error() -> None:
    sub = airborne("sub", mode="ALT_HOLD", FS_EKF_ACTION=1).inject("compass 90").run(3)
    assert "EKF bad" in sub.texts
    assert sub.armed
    sub = airborne("sub", mode="ALT_HOLD", FS_EKF_ACTION=2).inject("compass 90").run(3)
    assert not sub.armed
    sub = airborne("sub", mode="ALT_HOLD").inject("compass 90").run(3)
    assert "EKF bad" not in sub.texts
