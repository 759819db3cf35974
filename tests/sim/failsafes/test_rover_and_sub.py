"""Failsafes of Rover, on wheels and on water, and of Sub."""

from __future__ import annotations

from typing import Any

import pytest

from mavstack.dialects import common
from mavstack.services.mission import MissionItem
from tests.sim.failsafes.cases import Case, run_cases, stop_heartbeats
from tests.sim.harness import CMD, VehicleHarness, airborne, grounded

RADIO, GROUND = "Radio Failsafe", "GCS Failsafe"
LOST = "MYGCS: 255, heartbeat lost"


def with_mission(one: VehicleHarness) -> None:
    frame = common.MavFrame.GLOBAL_RELATIVE_ALT
    one.load(MissionItem(CMD.NAV_WAYPOINT, param5=47.41, param6=8.5456, param7=0.0, frame=frame))


def radio(name: str, mode: str, *texts: str, action: int = 2, kind: str = "rover", **more: Any) -> Case:
    parameters = {"FS_ACTION": action, "FS_THR_ENABLE": 1, **more.pop("parameters", {})}
    begin = more.pop("begin", "GUIDED")
    return Case(name, kind, parameters, ("radio off",), begin, mode=mode, texts=texts, **more)


def ground(name: str, mode: str, *texts: str, kind: str = "rover", **more: Any) -> Case:
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
    radio("action-0", "GUIDED", RADIO, action=0),
    radio("action-1", "RTL", RADIO, action=1),
    radio("action-2", "HOLD", RADIO, action=2),
    radio("action-3", "SMART_RTL", RADIO, action=3),
    radio("action-4", "SMART_RTL", RADIO, action=4),
    radio("action-5", "GUIDED", RADIO, action=5, armed=False),
    radio("action-6", "LOITER", RADIO, action=6),
    radio("boat", "RTL", RADIO, action=1, kind="boat"),
    radio("radio-off", "GUIDED", parameters={"FS_THR_ENABLE": 0}),
    radio("mission-goes-on", "AUTO", RADIO, "Failsafe - Continuing Auto Mode", begin="AUTO",
          before=with_mission, parameters={"FS_THR_ENABLE": 2}),
    radio("in-rtl", "RTL", action=2, begin="RTL"),
    radio("in-hold", "HOLD", action=1, begin="HOLD"),
    radio("in-hold-if-wanted", "RTL", RADIO, action=1, begin="HOLD", parameters={"FS_OPTIONS": 1}),
    radio("disarmed", "HOLD", RADIO, arms=False, armed=False),
    ground("ground-1", "RTL", GROUND),
    ground("ground-0", "GUIDED", parameters={"FS_GCS_ENABLE": 0}),
    ground("ground-goes-on", "AUTO", GROUND, "Failsafe - Continuing Auto Mode", begin="AUTO",
           before=with_mission, parameters={"FS_GCS_ENABLE": 2}),
    battery("battery-0", "GUIDED", 0),
    battery("battery-1", "RTL", 1),
    battery("battery-2", "HOLD", 2),
    battery("battery-3", "SMART_RTL", 3),
    battery("battery-4", "SMART_RTL", 4),
    battery("battery-5", "GUIDED", 5, armed=False),
    battery("battery-6", "LOITER", 6),
    battery("battery-boat", "RTL", 1, kind="boat"),
    ground("sub-ground-0", "POSHOLD", parameters={"FS_GCS_ENABLE": 0}, **SUB),
    ground("sub-ground-1", "POSHOLD", LOST, **SUB),
    ground("sub-ground-2", "POSHOLD", LOST, "Disarming motors", parameters={"FS_GCS_ENABLE": 2},
           armed=False, **SUB),
    ground("sub-ground-3", "ALT_HOLD", LOST, parameters={"FS_GCS_ENABLE": 3}, **SUB),
    ground("sub-ground-4", "SURFACE", LOST, parameters={"FS_GCS_ENABLE": 4}, **SUB),
    ground("sub-disarmed", "MANUAL", LOST, parameters={"FS_GCS_ENABLE": 4}, arms=False, armed=False,
           kind="sub"),
    radio("sub-pilot-0", "POSHOLD", parameters={"FS_PILOT_INPUT": 0}, **SUB),
    radio("sub-pilot-1", "POSHOLD", "Lost manual control", parameters={"FS_PILOT_INPUT": 1,
          "FS_PILOT_TIMEOUT": 1}, **SUB),
    radio("sub-pilot-2", "POSHOLD", "Lost manual control", parameters={"FS_PILOT_INPUT": 2,
          "FS_PILOT_TIMEOUT": 1},
          armed=False, **SUB),
    battery("sub-battery-1", "POSHOLD", 1, **SUB),
    battery("sub-battery-2", "POSHOLD", 2, "Disarming motors", armed=False, **SUB),
    battery("sub-battery-3", "SURFACE", 3, **SUB),
]  # fmt: skip
SILENT = {"radio-off", "in-rtl", "in-hold", "ground-0", "sub-ground-0", "sub-pilot-0"}


def parameters_of(case: Case) -> Case:
    """Remove FS_ACTION, which Sub has not."""
    if case.kind == "sub":
        case.parameters.pop("FS_ACTION", None)
    return case


@pytest.fixture(scope="module")
def results() -> dict[str, VehicleHarness]:
    return run_cases(map(parameters_of, CASES), "ardupilot")


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_a_failsafe_does_what_its_parameter_says_and_says_so(results, case) -> None:
    one = results[case.name]
    assert (one.mode, one.armed) == (case.mode, case.armed), list(one.texts)
    assert set(case.texts) <= set(one.texts), list(one.texts)
    assert bool(one.texts) == (case.name not in SILENT), list(one.texts)
    assert one.critical == (case.armed and case.name not in SILENT)


def test_a_rover_is_well_again_when_radio_and_ground_station_are() -> None:
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


def test_sub_repeats_its_warning_every_half_minute() -> None:
    sub = grounded("sub", FS_GCS_TIMEOUT=1)
    sub.without_telemetry().sends_heartbeats = False
    sub.run(35)
    assert sub.texts.count(LOST) == 2


def test_sub_surfaces() -> None:
    sub = airborne("sub", mode="POSHOLD", BATT_FS_LOW_ACT=3, BATT_LOW_TIMER=1).inject("battery sag 4")
    sub.run_until(lambda: sub.height > -0.5, timeout=60)
    assert sub.mode == "SURFACE"


def test_sub_tells_of_a_bad_compass() -> None:
    sub = airborne("sub", mode="ALT_HOLD", FS_EKF_ACTION=1).inject("compass 90").run(3)
    assert "EKF bad" in sub.texts
    assert sub.armed
    sub = airborne("sub", mode="ALT_HOLD", FS_EKF_ACTION=2).inject("compass 90").run(3)
    assert not sub.armed
    sub = airborne("sub", mode="ALT_HOLD").inject("compass 90").run(3)
    assert "EKF bad" not in sub.texts
