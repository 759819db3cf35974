"""PX4's failsafes: every action of every parameter, delays, takeover by the pilot, and status texts."""

from __future__ import annotations

from typing import Any

import pytest

from mavstack.dialects import common
from mavstack.services.mission import MissionItem
from tests.sim.failsafes.cases import Case, run_cases, stop_heartbeats
from tests.sim.harness import CMD, VehicleHarness, airborne

ACTIVATED = "Failsafe activated"
STATION, STATION_BACK = "Connection to ground station lost", "GCS connection regained"
DELAYED = "Failsafe activated: entering Hold for 2 seconds"


def with_mission(one: VehicleHarness) -> None:
    frame = common.MavFrame.GLOBAL_RELATIVE_ALT
    home = MissionItem(CMD.NAV_WAYPOINT, param5=47.41, param6=8.5456, param7=50.0, frame=frame)
    one.load(home, MissionItem(CMD.NAV_WAYPOINT, param5=47.42, param6=8.5456, param7=50.0, frame=frame))


def hold_sticks(one: VehicleHarness) -> None:
    one.repeated_message = lambda: common.ManualControl(
        target=one.vehicle.address.system, x=0, y=0, z=500, r=0
    )


def let_go(one: VehicleHarness) -> None:
    one.repeated_message = None


def sticks(name: str, mode: str, *texts: str, act: int = 2, **more: Any) -> Case:
    """Hold the sticks, and let go."""
    parameters = {"NAV_RCL_ACT": act, "COM_FAIL_ACT_T": 0, **more.pop("parameters", {})}
    more = {"before": hold_sticks, "begin": "Position", **more}
    return Case(name, more.pop("kind", "copter"), parameters, event=let_go, mode=mode, texts=texts, **more)


def both(one: VehicleHarness) -> None:
    with_mission(one)
    hold_sticks(one)


def station(name: str, mode: str, *texts: str, act: int, **more: Any) -> Case:
    parameters = {"NAV_DLL_ACT": act, "COM_DL_LOSS_T": 1, "COM_FAIL_ACT_T": 0, **more.pop("parameters", {})}
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


def battery(name: str, mode: str, percent: float, *texts: str, act: int = 3, **more: Any) -> Case:
    parameters = {"COM_LOW_BAT_ACT": act, "COM_FAIL_ACT_T": 0, **more.pop("parameters", {})}
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


def no_position(name: str, mode: str, *texts: str, **more: Any) -> Case:
    return Case(
        name,
        more.pop("kind", "copter"),
        more.pop("parameters", {}),
        ("gps off",),
        mode=mode,
        texts=texts,
        **more,
    )


LOW, LAND_NOW = "Low battery level, return advised", "Critical battery level, land now"
AT_ONCE = "Emergency battery level, land immediately"
TERMINATED = common.MavState.FLIGHT_TERMINATION
CASES = [
    sticks("sticks-0", "Position", "Manual control lost", act=0),
    sticks("sticks-1", "Hold", ACTIVATED, "Manual control loss: switching to Hold", act=1),
    sticks("sticks-2", "Return", ACTIVATED, "Manual control loss: switching to RTL", act=2),
    sticks("sticks-3", "Land", ACTIVATED, "Manual control loss: switching to Land", act=3),
    sticks("sticks-5", "Termination", ACTIVATED, "Manual control loss: switching to terminate", act=5,
           armed=False),
    sticks("sticks-6", "Position", "Disarmed by failsafe", "Manual control loss: switching to disarm", act=6,
           armed=False),
    sticks("sticks-plane", "Return", ACTIVATED, kind="plane"),
    sticks("sticks-vtol", "Return", ACTIVATED, kind="vtol"),
    sticks("sticks-rover", "Return", ACTIVATED, kind="rover"),
    sticks("sticks-sub", "Hold", ACTIVATED, act=1, kind="sub"),
    sticks("sticks-mission", "Return", ACTIVATED, begin="Mission", before=both),
    sticks("sticks-mission-excepted", "Mission", begin="Mission", before=both,
           parameters={"COM_RCL_EXCEPT": 1}),
    sticks("sticks-hold-excepted", "Hold", begin="Hold", parameters={"COM_RCL_EXCEPT": 2}),
    sticks("sticks-not-looked-at", "Hold", begin="Hold", parameters={"COM_RC_IN_MODE": 4}),
    sticks("sticks-patience", "Position", parameters={"COM_RC_LOSS_T": 30}),
    sticks("sticks-disarmed", "Hold", arms=False, armed=False),
    sticks("sticks-lost-before", "Hold", begin="Hold", before=None),
    sticks("sticks-later", "Return", "Manual control loss: switching to RTL in 2 seconds", DELAYED, ACTIVATED,
           parameters={"COM_FAIL_ACT_T": 2}),
    sticks("sticks-now-holds", "Hold", "Failsafe activated: entering Hold for 30 seconds",
           parameters={"COM_FAIL_ACT_T": 30}),
    station("station-0", "Hold", act=0),
    station("station-1", "Hold", ACTIVATED, "GCS connection loss: switching to Hold", act=1, begin="Return"),
    station("station-2", "Return", ACTIVATED, "GCS connection loss: switching to RTL", act=2),
    station("station-3", "Land", ACTIVATED, "GCS connection loss: switching to Land", act=3),
    station("station-5", "Termination", ACTIVATED, act=5, armed=False),
    station("station-6", "Hold", ACTIVATED, "Disarmed by failsafe", act=6, armed=False),
    station("station-plane", "Return", ACTIVATED, act=2, kind="plane"),
    station("station-rover", "Return", ACTIVATED, act=2, kind="rover"),
    station("station-landing", "Land", act=2, begin="Land"),
    station("station-returning", "Return", "Failsafe warning: GCS connection loss", act=2, begin="Return"),
    station("station-mission", "Return", ACTIVATED, act=2, begin="Mission", before=with_mission),
    station("station-mission-excepted", "Mission", act=2, begin="Mission", before=with_mission,
            parameters={"COM_DLL_EXCEPT": 1}),
    station("station-disarmed", "Hold", act=2, arms=False, armed=False),
    station("station-later", "Return", DELAYED, ACTIVATED, act=2, parameters={"COM_FAIL_ACT_T": 2}),
    battery("battery-low", "Hold", 12, LOW),
    battery("critical-0", "Hold", 6.5, LAND_NOW, act=0),
    battery("critical-1", "Return", 6.5, "Critical battery level: switching to RTL", act=1),
    battery("critical-2", "Land", 6.5, "Critical battery level: switching to Land", act=2),
    battery("critical-3", "Return", 6.5, ACTIVATED, act=3),
    battery("critical-4", "Return", 6.5, ACTIVATED, act=4),
    battery("emergency-0", "Hold", 4, AT_ONCE, act=0),
    battery("emergency-1", "Return", 4, "Emergency battery level: switching to RTL", act=1),
    battery("emergency-2", "Land", 4, "Emergency battery level: switching to Land", act=2),
    battery("emergency-3", "Land", 4, ACTIVATED, act=3),
    battery("emergency-4", "Termination", 4, "Emergency battery level: switching to terminate", act=4,
            armed=False),
    battery("critical-plane", "Return", 6.5, ACTIVATED, kind="plane"),
    battery("critical-landing", "Land", 6.5, LAND_NOW, begin="Land"),
    battery("battery-disarmed", "Hold", 4, arms=False, armed=False),
    battery("battery-threshold", "Return", 40, ACTIVATED, parameters={"BAT_CRIT_THR": 0.5,
            "BAT_LOW_THR": 0.6}),
    Case("motor-not-looked-at", faults=("motor 1 off",), mode="Hold"),
    Case("motor-1", parameters={"FD_ACT_EN": 1, "COM_ACT_FAIL_ACT": 2, "COM_FAIL_ACT_T": 0},
          faults=("motor 1 off",), mode="Land", texts=(ACTIVATED,)),
]  # fmt: skip
CALM = {
    "sticks-0", "sticks-mission-excepted", "sticks-hold-excepted", "sticks-not-looked-at", "sticks-patience",
    "sticks-disarmed", "sticks-lost-before", "station-0", "station-landing", "station-returning",
    "station-mission-excepted", "station-disarmed", "battery-low", "critical-0", "emergency-0",
    "critical-landing", "battery-disarmed", "motor-not-looked-at",
}  # fmt: skip


@pytest.fixture(scope="module")
def results() -> dict[str, VehicleHarness]:
    return run_cases(CASES, "px4")


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_a_failsafe_does_what_its_parameter_says_and_says_so(results, case) -> None:
    one = results[case.name]
    assert (one.mode, one.armed) == (case.mode, case.armed), list(one.texts)
    assert set(case.texts) <= set(one.texts), list(one.texts)
    if case.name in CALM:
        assert not any(text.startswith(ACTIVATED) for text in one.texts)
    assert one.critical == (case.armed and case.name not in CALM), one.autopilot.failsafes


@pytest.mark.parametrize("name", ["sticks-5", "station-5", "emergency-4"])
def test_a_terminated_flight_stays_terminated(results, name) -> None:
    one = results[name]
    assert one.autopilot.system_status == TERMINATED
    assert one.autopilot.arm()


def test_before_it_acts_it_holds_so_that_a_pilot_may_take_over() -> None:
    copter = airborne("copter", "px4", NAV_DLL_ACT=2, COM_DL_LOSS_T=1, COM_FAIL_ACT_T=3)
    copter.sends_heartbeats = False
    copter.run(3)
    assert copter.mode == "Hold"
    assert copter.critical
    copter.enter("Land").run(4)
    assert copter.mode == "Land"
    assert not copter.critical
    assert ACTIVATED not in copter.texts


def test_a_pilot_may_choose_another_mode_later_too_and_keeps_it() -> None:
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
    assert copter.mode == "Return", "each loss acts anew"


def test_a_link_that_is_back_does_not_end_what_its_loss_began() -> None:
    copter = airborne("copter", "px4", NAV_DLL_ACT=2, COM_DL_LOSS_T=1, COM_FAIL_ACT_T=0)
    copter.sends_heartbeats = False
    copter.run(3)
    copter.sends_heartbeats = True
    copter.run(2)
    assert copter.mode == "Return"
    assert copter.texts[-1] == STATION_BACK


def test_the_sticks_are_back() -> None:
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


def test_the_more_urgent_action_wins() -> None:
    copter = airborne("copter", "px4", NAV_DLL_ACT=2, COM_DL_LOSS_T=1, COM_FAIL_ACT_T=0)
    copter.sends_heartbeats = False
    copter.run(3)
    assert copter.mode == "Return"
    copter.inject("battery 4").run(1)
    assert copter.mode == "Land"
    assert "Emergency battery level: switching to Land" in copter.texts


def test_a_battery_that_was_low_when_it_was_armed_is_only_warned_of() -> None:
    copter = airborne("copter", "px4", COM_FAIL_ACT_T=0)
    copter.autopilot.disarm("test")
    copter.inject("battery 6.5").run(0.2)
    copter.place_in_air().run(2)
    assert copter.mode == "Hold"
    copter.inject("battery 4").run(1)
    assert copter.mode == "Land"


def test_the_body_lands_and_is_disarmed() -> None:
    copter = airborne("copter", "px4", COM_FAIL_ACT_T=0).inject("battery 4")
    copter.run_until(lambda: not copter.armed, timeout=60)
    assert copter.autopilot.landed
    assert copter.texts[-1] == "Disarmed by landing"
    assert not copter.critical
