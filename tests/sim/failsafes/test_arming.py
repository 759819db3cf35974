"""Arming refusals: every reason of either firmware, its text, and its end."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import pytest

from mavstack.sim.px4.arming import ARMING_DENIED
from tests.sim.harness import CMD, RESULT, SimulationHarness, VehicleHarness, grounded

if TYPE_CHECKING:
    from collections.abc import Callable


class Refusal(NamedTuple):
    text: str
    spoil: Callable[[VehicleHarness], object]
    kind: str = "copter"
    #: True if the reason is independent of the pilot's input; such reasons are reported unasked.
    standing: bool = True


def set_(**parameters: float) -> Callable[[VehicleHarness], object]:
    return lambda one: one.set(**parameters)


def inject(*faults: str) -> Callable[[VehicleHarness], object]:
    return lambda one: one.inject(*faults)


def enter(mode: str, *faults: str) -> Callable[[VehicleHarness], object]:
    return lambda one: one.enter(mode).inject(*faults)


def open_throttle(one: VehicleHarness) -> None:
    one.autopilot.radio.move(3, 1900)


def fence(one: VehicleHarness) -> None:
    one.set(FENCE_ENABLE=1, FENCE_TYPE=2).inject("gps off")


ARDUPILOT = [
    Refusal("Compass 1 not healthy", inject("compass 120")),
    Refusal("GPS 1: Bad fix", enter("GUIDED", "gps off")),
    Refusal("GPS 1: Bad fix", inject("gps off"), "plane"),
    Refusal("GPS 1: Bad fix", inject("gps off"), "rover"),
    Refusal("Need Position Estimate", enter("GUIDED", "gps off")),
    Refusal("Fence enabled, need position estimate", fence),
    Refusal("High GPS HDOP", lambda one: one.enter("GUIDED").set(GPS_HDOP_GOOD=10)),
    Refusal("EKF position variance", lambda one: one.enter("GUIDED").set(FS_EKF_THRESH=0.01)),
    Refusal("EKF compass variance", enter("GUIDED", "compass 40")),
    Refusal("Battery 1 low voltage failsafe", inject("battery sag 4")),
    Refusal("Battery 1 critical voltage failsafe", set_(BATT_CRT_VOLT=17)),
    Refusal("Battery 1 low capacity failsafe", set_(BATT_LOW_MAH=6000)),
    Refusal("Battery 1 critical capacity failsafe", set_(BATT_CRT_MAH=6000)),
    Refusal("Battery 1 below minimum arming voltage", set_(BATT_ARM_VOLT=17)),
    Refusal("Battery 1 below minimum arming capacity", set_(BATT_ARM_MAH=6000)),
    Refusal("Throttle below failsafe", inject("radio off")),
    Refusal("Radio failsafe on", inject("radio off"), "plane"),
    Refusal("Radio failsafe on", inject("radio off"), "rover"),
    Refusal("Missing mission item: land", set_(ARMING_MIS_ITEMS=1)),
    Refusal("Missing mission item: takeoff", set_(ARMING_MIS_ITEMS=8)),
    Refusal("Throttle too high", open_throttle, standing=False),
    Refusal("Throttle (RC3) is not neutral", open_throttle, "plane", standing=False),
    Refusal("Throttle (RC3) is not neutral", open_throttle, "rover", standing=False),
    Refusal("RTL mode not armable", enter("RTL"), standing=False),
]
PX4 = [
    Refusal("Preflight Fail: heading estimate invalid", inject("compass 120")),
    Refusal("Preflight Fail: Compass 0 fault", inject("compass 40")),
    Refusal("Preflight Fail: height estimate not stable", inject("baro 15")),
    Refusal("Preflight Fail: horizontal position unstable", inject("gps off"), standing=False),
    Refusal("Preflight Fail: GPS fix too low", lambda one: one.set(COM_ARM_WO_GPS=0).inject("gps off")),
    Refusal("Preflight Fail: No valid global position estimate", inject("gps off")),
    Refusal("Low battery", inject("battery 12")),
    Refusal("Critical battery", inject("battery 6")),
    Refusal("Emergency battery level", inject("battery 4")),
    Refusal("Low battery", lambda one: one.set(COM_ARM_BAT_MIN=0.5).inject("battery 40")),
    Refusal("Preflight Fail: Vehicle is in safety configuration", set_(COM_ARMABLE=0)),
    Refusal("Preflight Fail: Flight termination active", lambda one: one.autopilot.terminate()),
    Refusal("Preflight Fail: No valid mission available", set_(COM_ARM_MIS_REQ=1), standing=False),
    Refusal("Preflight Fail: No valid mission available", enter("Mission"), standing=False),
    Refusal("Preflight Fail: No manual control input", enter("Position"), standing=False),
    Refusal("Preflight Fail: No offboard signal", enter("Offboard"), standing=False),
    Refusal("Preflight Fail: Mode not suitable for arming", enter("Return"), standing=False),
    Refusal("Preflight Fail: No connection to the GCS", set_(NAV_DLL_ACT=2), standing=False),
]


def spoil(refusals: list[Refusal], firmware: str) -> list[VehicleHarness]:
    simulation_harness = SimulationHarness()
    flown = [simulation_harness.add(refusal.kind, firmware).without_telemetry() for refusal in refusals]
    for one in flown:
        one.sends_heartbeats = False
    simulation_harness.run(3)
    for one in flown:
        assert not list(one.vehicle.profile.arming_problems(one.autopilot))
    for one, refusal in zip(flown, refusals, strict=True):
        one.texts.clear_texts()
        refusal.spoil(one)
    # the loss of GPS is reported after five seconds, and then hides other problems of the estimate
    simulation_harness.run(4.9 if firmware == "px4" else 6)
    return flown


@pytest.fixture(scope="module")
def ardupilot() -> list[VehicleHarness]:
    return spoil(ARDUPILOT, "ardupilot")


@pytest.fixture(scope="module")
def px4() -> list[VehicleHarness]:
    return spoil(PX4, "px4")


@pytest.mark.parametrize("index", range(len(ARDUPILOT)), ids=[f"{it.kind}-{it.text}" for it in ARDUPILOT])
def test_ardupilot_refuses(ardupilot, index) -> None:
    one, refusal = ardupilot[index], ARDUPILOT[index]
    assert f"Arm: {refusal.text}" in one.autopilot.arm()
    assert not one.armed


@pytest.mark.parametrize("index", range(len(PX4)), ids=[it.text for it in PX4])
def test_px4_refuses(px4, index) -> None:
    one, refusal = px4[index], PX4[index]
    if "global position" in refusal.text:
        one.run(1)
    assert refusal.text in one.autopilot.arm()
    assert not one.armed
    if refusal.standing:
        assert refusal.text in one.texts, "said as it arises"


def test_a_ground_station_hears_why(ardupilot, px4) -> None:
    one = ardupilot[0]
    one.texts.clear_texts()
    assert one.command(CMD.COMPONENT_ARM_DISARM, 1) == RESULT.FAILED
    assert "Arm: Compass 1 not healthy" in one.texts
    other = px4[0]
    other.texts.clear_texts()
    assert other.command(CMD.COMPONENT_ARM_DISARM, 1) in (RESULT.DENIED, RESULT.TEMPORARILY_REJECTED)
    assert ARMING_DENIED in other.texts


def test_ardupilot_says_it_every_half_minute_and_can_be_told_not_to_check() -> None:
    one = grounded().without_telemetry().inject("compass 120").run(35)
    assert one.texts.count("PreArm: Compass 1 not healthy") == 1
    one.set(ARMING_CHECK=0)
    assert not one.autopilot.arm()
    one.autopilot.disarm("test")


def test_before_it_has_booted_it_cannot_be_armed() -> None:
    simulation_harness = SimulationHarness()
    one, other = simulation_harness.add("copter", "ardupilot"), simulation_harness.add("copter", "px4")
    simulation_harness.run(1)
    assert one.autopilot.arm() == ["Arm: System not initialised"]
    assert other.autopilot.arm() == ["Preflight Fail: ekf2 missing data"]


def test_what_was_wrong_is_right_again_and_it_can_be_armed(ardupilot) -> None:
    index = next(at for at, it in enumerate(ARDUPILOT) if it.text == "Battery 1 low voltage failsafe")
    one = ardupilot[index].inject("battery sag 0").run(0.5)
    assert not one.autopilot.arm()
