"""Plane's failsafes, for planes and quadplanes: short and long ones, exceptions, and status texts."""

from __future__ import annotations

from typing import Any

import pytest

from mavstack.dialects import common
from mavstack.services.mission import MissionItem
from tests.sim.failsafes.cases import Case, run_cases, stop_heartbeats
from tests.sim.harness import CMD, VehicleHarness, airborne

#: One worker flies the cases, all at the same time.
pytestmark = pytest.mark.xdist_group("failsafes of plane")

ON, CLEARED = "RC Short Failsafe On", "RC Short Failsafe Cleared"


def waypoint(latitude: float = 47.42) -> MissionItem:
    frame = common.MavFrame.GLOBAL_RELATIVE_ALT
    return MissionItem(CMD.NAV_WAYPOINT, param5=latitude, param6=8.5456, param7=150.0, frame=frame)


def with_mission(harness: VehicleHarness) -> None:
    harness.load(waypoint(), waypoint(47.43))


def with_landing(harness: VehicleHarness) -> None:
    harness.load(waypoint(), MissionItem(CMD.DO_LAND_START), waypoint(47.43))


def radio_loss(name: str, begin: str, mode: str, *texts: str, **more: Any) -> Case:
    """Lose the radio for longer than both timeouts."""
    parameters = {"RC_FS_TIMEOUT": 0.5, "FS_SHORT_TIMEOUT": 1, "FS_LONG_TIMEOUT": 3}
    parameters |= more.pop("parameters", {})
    kind = more.pop("kind", "plane")
    return Case(name, kind, parameters, ("radio off",), begin, mode=mode, texts=texts, **more)


def short_loss(name: str, begin: str, mode: str, *texts: str, action: int = 0, **more: Any) -> Case:
    """Lose the radio for longer than the short timeout only."""
    parameters = {"FS_LONG_TIMEOUT": 60, "FS_SHORT_ACTN": action, **more.pop("parameters", {})}
    return radio_loss(name, begin, mode, *texts, parameters=parameters, **more)


def long_loss(name: str, begin: str, mode: str, *texts: str, action: int = 0, **more: Any) -> Case:
    parameters = {"FS_LONG_ACTN": action, **more.pop("parameters", {})}
    return radio_loss(
        name, begin, mode, f"RC Long Failsafe On: switched to {mode}", *texts, parameters=parameters, **more
    )


def ground_loss(
    name: str, begin: str, mode: str, *texts: str, action: int = 0, enabled: int = 1, **more: Any
) -> Case:
    parameters = {"FS_GCS_ENABL": enabled, "FS_LONG_TIMEOUT": 2, "FS_LONG_ACTN": action}
    return Case(
        name,
        "plane",
        parameters,
        (),
        begin,
        sends_heartbeats=True,
        event=stop_heartbeats,
        mode=mode,
        texts=texts,
        **more,
    )


def battery(name: str, mode: str, *texts: str, action: int, kind: str = "plane", **more: Any) -> Case:
    parameters = {"BATT_FS_LOW_ACT": action, "BATT_LOW_TIMER": 1}
    return Case(
        name,
        kind,
        parameters,
        ("battery sag 6",),
        more.pop("begin", "GUIDED"),
        mode=mode,
        texts=texts,
        **more,
    )


TO_CIRCLE = "RC Short Failsafe: switched to CIRCLE"
CASES = [
    short_loss("short-0", "FBWA", "CIRCLE", TO_CIRCLE, "Throttle failsafe on"),
    short_loss("short-1", "CRUISE", "CIRCLE", TO_CIRCLE, action=1),
    short_loss("short-2", "STABILIZE", "FBWA", "RC Short Failsafe: switched to FBWA", action=2),
    short_loss("short-3", "FBWA", "FBWA", "Throttle failsafe on", action=3),
    short_loss("short-4", "FBWA", "FBWB", "RC Short Failsafe: switched to FBWB", action=4),
    short_loss("short-guided-0", "GUIDED", "GUIDED", ON),
    short_loss("short-guided-1", "GUIDED", "CIRCLE", TO_CIRCLE, action=1),
    short_loss("short-auto-0", "AUTO", "AUTO", ON, before=with_mission),
    short_loss("short-auto-1", "AUTO", "CIRCLE", TO_CIRCLE, action=1, before=with_mission),
    short_loss("short-rtl", "RTL", "RTL", ON, action=1),
    short_loss("short-hovering", "QHOVER", "QLAND", "RC Short Failsafe: switched to QLAND", kind="vtol"),
    short_loss("short-hovering-qrtl", "QHOVER", "QRTL", kind="vtol", parameters={"Q_OPTIONS": 32}),
    short_loss("short-hovering-rtl", "QHOVER", "RTL", kind="vtol", parameters={"Q_OPTIONS": 1 << 20}),
    long_loss("long-0", "FBWA", "RTL"),
    long_loss("long-1", "MANUAL", "RTL", action=1),
    long_loss("long-2", "CRUISE", "FBWA", action=2),
    long_loss("long-4", "FBWB", "AUTO", action=4, before=with_mission),
    long_loss("long-guided-0", "GUIDED", "GUIDED"),
    long_loss("long-guided-1", "GUIDED", "RTL", action=1),
    long_loss("long-guided-2", "GUIDED", "FBWA", action=2),
    long_loss("long-auto-0", "AUTO", "AUTO", before=with_mission),
    long_loss("long-auto-1", "AUTO", "RTL", action=1, before=with_mission),
    long_loss("long-loiter", "LOITER", "RTL"),
    long_loss("long-hovering", "QHOVER", "QLAND", kind="vtol"),
    radio_loss("off", "FBWA", "FBWA", parameters={"THR_FAILSAFE": 0}),
    radio_loss("on-without-action", "FBWA", "FBWA", parameters={"THR_FAILSAFE": 2}),
    ground_loss("ground-0", "FBWA", "FBWA", enabled=0),
    ground_loss("ground-1", "FBWA", "RTL", "GCS Failsafe On: switched to RTL"),
    ground_loss("ground-guided", "GUIDED", "GUIDED", "GCS Failsafe On: switched to GUIDED"),
    ground_loss("ground-guided-1", "GUIDED", "RTL", "GCS Failsafe On: switched to RTL", action=1),
    ground_loss("ground-only-auto", "FBWA", "FBWA", enabled=3),
    ground_loss("ground-auto", "AUTO", "RTL", "GCS Failsafe On: switched to RTL", action=1, enabled=3,
           before=with_mission),
    battery("battery-0", "GUIDED", action=0),
    battery("battery-1", "RTL", action=1),
    battery("battery-2", "AUTO", action=2, before=with_landing),
    battery("battery-2-without", "RTL", action=2),
    battery("battery-3", "GUIDED", "AFS not enabled, can't terminate the vehicle", action=3),
    battery("battery-4", "QLAND", action=4, kind="vtol"),
    battery("battery-4-plane", "RTL", action=4),
    battery("battery-6", "QLAND", action=6, kind="vtol"),
    battery("battery-7", "RTL", action=7),
    battery("battery-landing", "QLAND", action=1, kind="vtol", begin="QLAND"),
]  # fmt: skip
WITHOUT_TEXTS = {"off", "on-without-action", "ground-0", "ground-only-auto"}


@pytest.fixture(scope="module")
def results() -> dict[str, VehicleHarness]:
    return run_cases(CASES, "ardupilot", 4.5)


@pytest.mark.flight
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_failsafe_action_and_status_texts(results, case) -> None:
    harness = results[case.name]
    assert harness.mode == case.mode, list(harness.texts)
    assert harness.armed
    assert set(case.texts) <= set(harness.texts), list(harness.texts)
    assert bool(harness.texts) == (case.name not in WITHOUT_TEXTS), list(harness.texts)
    assert harness.critical == (case.name not in WITHOUT_TEXTS)


def test_short_failsafe_restores_the_mode() -> None:
    plane = airborne("plane", mode="CRUISE", FS_SHORT_TIMEOUT=1).inject("radio off").run(2)
    assert plane.mode == "CIRCLE"
    plane.inject("radio on").run(0.5)
    assert plane.mode == "CRUISE"
    assert {"Throttle failsafe off", CLEARED, "Flight mode CRUISE restored"} <= set(plane.texts)


def test_mode_chosen_during_a_short_failsafe_is_kept() -> None:
    plane = airborne("plane", mode="CRUISE", FS_SHORT_TIMEOUT=1).inject("radio off").run(2)
    plane.enter("LOITER").inject("radio on").run(0.5)
    assert plane.mode == "LOITER"
    assert CLEARED in plane.texts


def test_long_failsafe_keeps_rtl_after_recovery() -> None:
    plane = airborne("plane", mode="FBWA", FS_SHORT_TIMEOUT=1, FS_LONG_TIMEOUT=2).inject("radio off").run(3)
    plane.inject("radio on").run(0.5)
    assert plane.mode == "RTL"
    assert "RC Long Failsafe Cleared" in plane.texts
    assert not plane.critical


@pytest.mark.flight
def test_ground_station_recovery_is_reported() -> None:
    plane = airborne("plane", mode="FBWA", FS_GCS_ENABL=1, FS_LONG_TIMEOUT=2)
    plane.sends_heartbeats = False
    plane.run(4)
    plane.sends_heartbeats = True
    plane.run(1.5)
    assert plane.mode == "RTL"
    assert plane.texts[-1] == "GCS Failsafe Cleared"


def test_critical_battery_terminates_the_flight_with_afs_enable() -> None:
    plane = airborne("plane", BATT_FS_CRT_ACT=3, BATT_LOW_TIMER=1, BATT_CRT_VOLT=14, AFS_ENABLE=1)
    plane.inject("battery sag 6").run(2)
    assert "Terminating due to critical battery" in plane.texts
    assert not plane.armed
    assert plane.autopilot.system_status == common.MavState.FLIGHT_TERMINATION
