"""PX4's failsafes: every action of every parameter, delays, takeover by the pilot, and status texts."""

from __future__ import annotations

from typing import Any

import pytest

from mavstack.dialects import common
from mavstack.services.mission import MissionItem
from tests.sim.failsafes.cases import Case, run_cases, stop_heartbeats
from tests.sim.harness import CMD, VehicleHarness, airborne

#: One worker flies the cases, all at the same time.
pytestmark = pytest.mark.xdist_group("failsafes of px4")

ACTIVATED = "Failsafe activated"
STATION, STATION_BACK = "Connection to ground station lost", "GCS connection regained"
DELAYED = "Failsafe activated: entering Hold for 2 seconds"


def with_mission(harness: VehicleHarness) -> None:
    frame = common.MavFrame.GLOBAL_RELATIVE_ALT
    home = MissionItem(CMD.NAV_WAYPOINT, param5=47.41, param6=8.5456, param7=50.0, frame=frame)
    harness.load(home, MissionItem(CMD.NAV_WAYPOINT, param5=47.42, param6=8.5456, param7=50.0, frame=frame))


def hold_sticks(harness: VehicleHarness) -> None:
    harness.repeated_message = lambda: common.ManualControl(
        target=harness.vehicle.address.system, x=0, y=0, z=500, r=0
    )


def release_sticks(harness: VehicleHarness) -> None:
    harness.repeated_message = None


def stick_loss(name: str, mode: str, *texts: str, action: int = 2, **more: Any) -> Case:
    """Return a case in which stick input stops."""
    parameters = {"NAV_RCL_ACT": action, "COM_FAIL_ACT_T": 0, **more.pop("parameters", {})}
    more = {"before": hold_sticks, "begin": "Position", **more}
    return Case(
        name, more.pop("kind", "copter"), parameters, event=release_sticks, mode=mode, texts=texts, **more
    )


def with_mission_and_sticks(harness: VehicleHarness) -> None:
    with_mission(harness)
    hold_sticks(harness)


def station_loss(name: str, mode: str, *texts: str, action: int, **more: Any) -> Case:
    parameters = {
        "NAV_DLL_ACT": action,
        "COM_DL_LOSS_T": 1,
        "COM_FAIL_ACT_T": 0,
        **more.pop("parameters", {}),
    }
    kind = more.pop("kind", "copter")
    return Case(
        name,
        kind,
        parameters,
        sends_heartbeats=True,
        event=stop_heartbeats,
        mode=mode,
        texts=(STATION, *texts),
        **more,
    )


def battery(name: str, mode: str, percent: float, *texts: str, action: int = 3, **more: Any) -> Case:
    parameters = {"COM_LOW_BAT_ACT": action, "COM_FAIL_ACT_T": 0, **more.pop("parameters", {})}
    kind = more.pop("kind", "copter")
    return Case(
        name,
        kind,
        parameters,
        (f"battery {percent}",),
        more.pop("begin", "Hold"),
        mode=mode,
        texts=texts,
        **more,
    )


LOW, LAND_NOW = "Low battery level, return advised", "Critical battery level, land now"
AT_ONCE = "Emergency battery level, land immediately"
TERMINATED = common.MavState.FLIGHT_TERMINATION
CASES = [
    stick_loss("sticks-0", "Position", "Manual control lost", action=0),
    stick_loss("sticks-1", "Hold", ACTIVATED, "Manual control loss: switching to Hold", action=1),
    stick_loss("sticks-2", "Return", ACTIVATED, "Manual control loss: switching to RTL", action=2),
    stick_loss("sticks-3", "Land", ACTIVATED, "Manual control loss: switching to Land", action=3),
    stick_loss("sticks-5", "Termination", ACTIVATED, "Manual control loss: switching to terminate", action=5,
           armed=False),
    stick_loss("sticks-6", "Position", "Disarmed by failsafe",
               "Manual control loss: switching to disarm", action=6, armed=False),
    stick_loss("sticks-plane", "Return", ACTIVATED, kind="plane"),
    stick_loss("sticks-vtol", "Return", ACTIVATED, kind="vtol"),
    stick_loss("sticks-rover", "Return", ACTIVATED, kind="rover"),
    stick_loss("sticks-sub", "Hold", ACTIVATED, action=1, kind="sub"),
    stick_loss("sticks-mission", "Return", ACTIVATED, begin="Mission", before=with_mission_and_sticks),
    stick_loss("sticks-mission-excepted", "Mission", begin="Mission", before=with_mission_and_sticks,
           parameters={"COM_RCL_EXCEPT": 1}),
    stick_loss("sticks-hold-excepted", "Hold", begin="Hold", parameters={"COM_RCL_EXCEPT": 2}),
    stick_loss("sticks-not-monitored", "Hold", begin="Hold", parameters={"COM_RC_IN_MODE": 4}),
    stick_loss("sticks-long-timeout", "Position", parameters={"COM_RC_LOSS_T": 30}),
    stick_loss("sticks-disarmed", "Hold", arms=False, armed=False),
    stick_loss("sticks-never-received", "Hold", begin="Hold", before=None),
    stick_loss("sticks-later", "Return", "Manual control loss: switching to RTL in 2 seconds", DELAYED,
               ACTIVATED, parameters={"COM_FAIL_ACT_T": 2}),
    stick_loss("sticks-delayed", "Hold", "Failsafe activated: entering Hold for 30 seconds",
           parameters={"COM_FAIL_ACT_T": 30}),
    station_loss("station-0", "Hold", action=0),
    station_loss("station-1", "Hold", ACTIVATED, "GCS connection loss: switching to Hold", action=1,
                 begin="Return"),
    station_loss("station-2", "Return", ACTIVATED, "GCS connection loss: switching to RTL", action=2),
    station_loss("station-3", "Land", ACTIVATED, "GCS connection loss: switching to Land", action=3),
    station_loss("station-5", "Termination", ACTIVATED, action=5, armed=False),
    station_loss("station-6", "Hold", ACTIVATED, "Disarmed by failsafe", action=6, armed=False),
    station_loss("station-plane", "Return", ACTIVATED, action=2, kind="plane"),
    station_loss("station-rover", "Return", ACTIVATED, action=2, kind="rover"),
    station_loss("station-landing", "Land", action=2, begin="Land"),
    station_loss("station-returning", "Return", "Failsafe warning: GCS connection loss", action=2,
                 begin="Return"),
    station_loss("station-mission", "Return", ACTIVATED, action=2, begin="Mission", before=with_mission),
    station_loss("station-mission-excepted", "Mission", action=2, begin="Mission", before=with_mission,
            parameters={"COM_DLL_EXCEPT": 1}),
    station_loss("station-disarmed", "Hold", action=2, arms=False, armed=False),
    station_loss("station-later", "Return", DELAYED, ACTIVATED, action=2, parameters={"COM_FAIL_ACT_T": 2}),
    battery("battery-low", "Hold", 12, LOW),
    battery("critical-0", "Hold", 6.5, LAND_NOW, action=0),
    battery("critical-1", "Return", 6.5, "Critical battery level: switching to RTL", action=1),
    battery("critical-2", "Land", 6.5, "Critical battery level: switching to Land", action=2),
    battery("critical-3", "Return", 6.5, ACTIVATED, action=3),
    battery("critical-4", "Return", 6.5, ACTIVATED, action=4),
    battery("emergency-0", "Hold", 4, AT_ONCE, action=0),
    battery("emergency-1", "Return", 4, "Emergency battery level: switching to RTL", action=1),
    battery("emergency-2", "Land", 4, "Emergency battery level: switching to Land", action=2),
    battery("emergency-3", "Land", 4, ACTIVATED, action=3),
    battery("emergency-4", "Termination", 4, "Emergency battery level: switching to terminate", action=4,
            armed=False),
    battery("critical-plane", "Return", 6.5, ACTIVATED, kind="plane"),
    battery("critical-landing", "Land", 6.5, LAND_NOW, begin="Land"),
    battery("battery-disarmed", "Hold", 4, arms=False, armed=False),
    battery("battery-threshold", "Return", 40, ACTIVATED, parameters={"BAT_CRIT_THR": 0.5,
            "BAT_LOW_THR": 0.6}),
    Case("motor-not-monitored", faults=("motor 1 off",), mode="Hold"),
    Case("motor-1", parameters={"FD_ACT_EN": 1, "COM_ACT_FAIL_ACT": 2, "COM_FAIL_ACT_T": 0},
          faults=("motor 1 off",), mode="Land", texts=(ACTIVATED,)),
]  # fmt: skip
WITHOUT_FAILSAFE = {
    "sticks-0", "sticks-mission-excepted", "sticks-hold-excepted", "sticks-not-monitored",
    "sticks-long-timeout", "sticks-disarmed", "sticks-never-received", "station-0", "station-landing",
    "station-returning", "station-mission-excepted", "station-disarmed", "battery-low", "critical-0",
    "emergency-0", "critical-landing", "battery-disarmed", "motor-not-monitored",
}  # fmt: skip


@pytest.fixture(scope="module")
def results() -> dict[str, VehicleHarness]:
    return run_cases(CASES, "px4")


@pytest.mark.flight
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_failsafe_action_and_status_texts(results, case) -> None:
    harness = results[case.name]
    assert (harness.mode, harness.armed) == (case.mode, case.armed), list(harness.texts)
    assert set(case.texts) <= set(harness.texts), list(harness.texts)
    if case.name in WITHOUT_FAILSAFE:
        assert not any(text.startswith(ACTIVATED) for text in harness.texts)
    assert harness.critical == (case.armed and case.name not in WITHOUT_FAILSAFE), harness.autopilot.failsafes


@pytest.mark.flight
@pytest.mark.parametrize("name", ["sticks-5", "station-5", "emergency-4"])
def test_termination_is_final(results, name) -> None:
    harness = results[name]
    assert harness.autopilot.system_status == TERMINATED
    assert harness.autopilot.arm()


@pytest.mark.flight
def test_mode_change_during_the_delay_cancels_the_action() -> None:
    copter = airborne("copter", "px4", NAV_DLL_ACT=2, COM_DL_LOSS_T=1, COM_FAIL_ACT_T=3)
    copter.sends_heartbeats = False
    copter.run(3)
    assert copter.mode == "Hold"
    assert copter.critical
    copter.enter("Land").run(4)
    assert copter.mode == "Land"
    assert not copter.critical
    assert ACTIVATED not in copter.texts


@pytest.mark.nightly
@pytest.mark.flight
def test_mode_change_after_the_action_is_kept_until_the_next_loss() -> None:
    copter = airborne("copter", "px4", NAV_DLL_ACT=2, COM_DL_LOSS_T=1, COM_FAIL_ACT_T=0)
    copter.sends_heartbeats = False
    copter.run(3)
    assert copter.mode == "Return"
    copter.enter("Hold").run(5)
    assert copter.mode == "Hold"
    copter.sends_heartbeats = True
    copter.run(1.5)
    assert STATION_BACK in copter.texts
    copter.sends_heartbeats = False
    copter.run(3)
    assert copter.mode == "Return", "each loss triggers the action"


@pytest.mark.flight
def test_link_recovery_does_not_end_the_action() -> None:
    copter = airborne("copter", "px4", NAV_DLL_ACT=2, COM_DL_LOSS_T=1, COM_FAIL_ACT_T=0)
    copter.sends_heartbeats = False
    copter.run(3)
    copter.sends_heartbeats = True
    copter.run(2)
    assert copter.mode == "Return"
    assert copter.texts[-1] == STATION_BACK


@pytest.mark.flight
def test_manual_control_recovery_is_reported() -> None:
    copter = airborne("copter", "px4", COM_FAIL_ACT_T=0)
    hold_sticks(copter)
    copter.enter("Position").run(1)
    copter.repeated_message = None
    copter.run(2)
    assert copter.mode == "Return"
    hold_sticks(copter)
    copter.run(0.5)
    assert copter.texts.first("Manual control regained after 2.")
    assert copter.mode == "Return"


@pytest.mark.flight
def test_more_urgent_action_replaces_the_first() -> None:
    copter = airborne("copter", "px4", NAV_DLL_ACT=2, COM_DL_LOSS_T=1, COM_FAIL_ACT_T=0)
    copter.sends_heartbeats = False
    copter.run(3)
    assert copter.mode == "Return"
    copter.inject("battery 4").run(1)
    assert copter.mode == "Land"
    assert "Emergency battery level: switching to Land" in copter.texts


@pytest.mark.flight
def test_battery_that_was_low_at_arming_gives_a_warning_only() -> None:
    copter = airborne("copter", "px4", COM_FAIL_ACT_T=0)
    copter.autopilot.disarm("test")
    copter.inject("battery 6.5").run(0.2)
    copter.place_in_air().run(2)
    assert copter.mode == "Hold"
    copter.inject("battery 4").run(1)
    assert copter.mode == "Land"


@pytest.mark.nightly
@pytest.mark.flight
def test_emergency_battery_level_lands_and_disarms() -> None:
    copter = airborne("copter", "px4", COM_FAIL_ACT_T=0).inject("battery 4")
    copter.run_until(lambda: not copter.armed, timeout=60)
    assert copter.autopilot.landed
    assert copter.texts[-1] == "Disarmed by landing"
    assert not copter.critical
