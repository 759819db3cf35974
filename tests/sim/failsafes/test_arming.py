"""Refused arming: every reason of both firmwares, its status text, and its recovery."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import pytest

from mavstack.sim.px4.arming import ARMING_DENIED
from tests.sim.harness import CMD, RESULT, SimulationHarness, VehicleHarness, grounded

if TYPE_CHECKING:
    from collections.abc import Callable

#: One worker flies the cases, all at the same time.
pytestmark = pytest.mark.xdist_group("failsafes of arming")


class Refusal(NamedTuple):
    text: str
    cause: Callable[[VehicleHarness], object]
    kind: str = "copter"
    #: True if the reason does not depend on the pilot's input; it is then reported without an arming attempt.
    persistent: bool = True


def set_parameters(**parameters: float) -> Callable[[VehicleHarness], object]:
    return lambda harness: harness.set(**parameters)


def inject(*faults: str) -> Callable[[VehicleHarness], object]:
    return lambda harness: harness.inject(*faults)


def enter(mode: str, *faults: str) -> Callable[[VehicleHarness], object]:
    return lambda harness: harness.enter(mode).inject(*faults)


def open_throttle(harness: VehicleHarness) -> None:
    harness.autopilot.radio.move(3, 1900)


def enable_fence_without_gps(harness: VehicleHarness) -> None:
    harness.set(FENCE_ENABLE=1, FENCE_TYPE=2).inject("gps off")


ARDUPILOT = [
    Refusal("Compass 1 not healthy", inject("compass 120")),
    Refusal("GPS 1: Bad fix", enter("GUIDED", "gps off")),
    Refusal("GPS 1: Bad fix", inject("gps off"), "plane"),
    Refusal("GPS 1: Bad fix", inject("gps off"), "rover"),
    Refusal("Need Position Estimate", enter("GUIDED", "gps off")),
    Refusal("Fence enabled, need position estimate", enable_fence_without_gps),
    Refusal("High GPS HDOP", lambda harness: harness.enter("GUIDED").set(GPS_HDOP_GOOD=10)),
    Refusal("EKF position variance", lambda harness: harness.enter("GUIDED").set(FS_EKF_THRESH=0.01)),
    Refusal("EKF compass variance", enter("GUIDED", "compass 40")),
    Refusal("Battery 1 low voltage failsafe", inject("battery sag 4")),
    Refusal("Battery 1 critical voltage failsafe", set_parameters(BATT_CRT_VOLT=17)),
    Refusal("Battery 1 low capacity failsafe", set_parameters(BATT_LOW_MAH=6000)),
    Refusal("Battery 1 critical capacity failsafe", set_parameters(BATT_CRT_MAH=6000)),
    Refusal("Battery 1 below minimum arming voltage", set_parameters(BATT_ARM_VOLT=17)),
    Refusal("Battery 1 below minimum arming capacity", set_parameters(BATT_ARM_MAH=6000)),
    Refusal("Throttle below failsafe", inject("radio off")),
    Refusal("Radio failsafe on", inject("radio off"), "plane"),
    Refusal("Radio failsafe on", inject("radio off"), "rover"),
    Refusal("Missing mission item: land", set_parameters(ARMING_MIS_ITEMS=1)),
    Refusal("Missing mission item: takeoff", set_parameters(ARMING_MIS_ITEMS=8)),
    Refusal("Throttle too high", open_throttle, persistent=False),
    Refusal("Throttle (RC3) is not neutral", open_throttle, "plane", persistent=False),
    Refusal("Throttle (RC3) is not neutral", open_throttle, "rover", persistent=False),
    Refusal("RTL mode not armable", enter("RTL"), persistent=False),
]
PX4 = [
    Refusal("Preflight Fail: heading estimate invalid", inject("compass 120")),
    Refusal("Preflight Fail: Compass 0 fault", inject("compass 40")),
    Refusal("Preflight Fail: height estimate not stable", inject("baro 15")),
    Refusal("Preflight Fail: horizontal position unstable", inject("gps off"), persistent=False),
    Refusal(
        "Preflight Fail: GPS fix too low", lambda harness: harness.set(COM_ARM_WO_GPS=0).inject("gps off")
    ),
    Refusal("Preflight Fail: No valid global position estimate", inject("gps off")),
    Refusal("Low battery", inject("battery 12")),
    Refusal("Critical battery", inject("battery 6")),
    Refusal("Emergency battery level", inject("battery 4")),
    Refusal("Low battery", lambda harness: harness.set(COM_ARM_BAT_MIN=0.5).inject("battery 40")),
    Refusal("Preflight Fail: Vehicle is in safety configuration", set_parameters(COM_ARMABLE=0)),
    Refusal("Preflight Fail: Flight termination active", lambda harness: harness.autopilot.terminate()),
    Refusal(
        "Preflight Fail: No valid mission available", set_parameters(COM_ARM_MIS_REQ=1), persistent=False
    ),
    Refusal("Preflight Fail: No valid mission available", enter("Mission"), persistent=False),
    Refusal("Preflight Fail: No manual control input", enter("Position"), persistent=False),
    Refusal("Preflight Fail: No offboard signal", enter("Offboard"), persistent=False),
    Refusal("Preflight Fail: Mode not suitable for arming", enter("Return"), persistent=False),
    Refusal("Preflight Fail: No connection to the GCS", set_parameters(NAV_DLL_ACT=2), persistent=False),
]


def apply_causes(refusals: list[Refusal], firmware: str) -> list[VehicleHarness]:
    simulation_harness = SimulationHarness()
    harnesses = [simulation_harness.add(refusal.kind, firmware).without_telemetry() for refusal in refusals]
    for harness in harnesses:
        harness.sends_heartbeats = False
    simulation_harness.run(3)
    for harness in harnesses:
        assert not list(harness.vehicle.profile.arming_problems(harness.autopilot))
    for harness, refusal in zip(harnesses, refusals, strict=True):
        harness.texts.clear_texts()
        refusal.cause(harness)
    # the loss of GPS is reported after five seconds, and then hides other problems of the estimate
    simulation_harness.run(4.9 if firmware == "px4" else 6)
    return harnesses


@pytest.fixture(scope="module")
def ardupilot() -> list[VehicleHarness]:
    return apply_causes(ARDUPILOT, "ardupilot")


@pytest.fixture(scope="module")
def px4() -> list[VehicleHarness]:
    return apply_causes(PX4, "px4")


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize(
    "index", range(len(ARDUPILOT)), ids=[f"{refusal.kind}-{refusal.text}" for refusal in ARDUPILOT]
)
def test_ardupilot_refuses(ardupilot, index) -> None:
    harness, refusal = ardupilot[index], ARDUPILOT[index]
    assert f"Arm: {refusal.text}" in harness.autopilot.arm()
    assert not harness.armed


@pytest.mark.parametrize("index", range(len(PX4)), ids=[refusal.text for refusal in PX4])
def test_px4_refuses(px4, index) -> None:
    harness, refusal = px4[index], PX4[index]
    if "global position" in refusal.text:
        harness.run(1)
    assert refusal.text in harness.autopilot.arm()
    assert not harness.armed
    if refusal.persistent:
        assert refusal.text in harness.texts, "reported when it arises"


def test_refused_arming_is_reported_to_the_ground_station(ardupilot, px4) -> None:
    harness = ardupilot[0]
    harness.texts.clear_texts()
    assert harness.command(CMD.COMPONENT_ARM_DISARM, 1) == RESULT.FAILED
    assert "Arm: Compass 1 not healthy" in harness.texts
    px4_harness = px4[0]
    px4_harness.texts.clear_texts()
    assert px4_harness.command(CMD.COMPONENT_ARM_DISARM, 1) in (RESULT.DENIED, RESULT.TEMPORARILY_REJECTED)
    assert ARMING_DENIED in px4_harness.texts


@pytest.mark.flight
def test_ardupilot_repeats_prearm_problems_until_arming_check_disables_them() -> None:
    harness = grounded().without_telemetry().inject("compass 120").run(35)
    assert harness.texts.count("PreArm: Compass 1 not healthy") == 1
    harness.set(ARMING_CHECK=0)
    assert not harness.autopilot.arm()
    harness.autopilot.disarm("test")


def test_arming_is_refused_during_boot() -> None:
    simulation_harness = SimulationHarness()
    harness, px4_harness = (
        simulation_harness.add("copter", "ardupilot"),
        simulation_harness.add("copter", "px4"),
    )
    simulation_harness.run(1)
    assert harness.autopilot.arm() == ["Arm: System not initialised"]
    assert px4_harness.autopilot.arm() == ["Preflight Fail: ekf2 missing data"]


def test_arming_succeeds_after_the_cause_is_cleared(ardupilot) -> None:
    index = next(
        index for index, refusal in enumerate(ARDUPILOT) if refusal.text == "Battery 1 low voltage failsafe"
    )
    harness = ardupilot[index].inject("battery sag 0").run(0.5)
    assert not harness.autopilot.arm()
