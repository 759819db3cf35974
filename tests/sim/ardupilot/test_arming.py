"""Conditions that prevent arming an ArduPilot, and their status texts."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from mavstack.dialects import common

from .harness import CMD, RESULT, ArdupilotHarness

if TYPE_CHECKING:
    from collections.abc import Callable


def lose_gps(harness: ArdupilotHarness) -> None:
    harness.set_mode("GUIDED")
    harness.vehicle.body.fail_gps(True)
    harness.run_until(lambda: not harness.autopilot.has_position)


def open_throttle(harness: ArdupilotHarness) -> None:
    harness.autopilot.radio.move(3, 1600)
    harness.run(0.5)


def switch_radio_off(harness: ArdupilotHarness) -> None:
    harness.autopilot.radio.switch(False)
    harness.run(0.5)


def require_landing(harness: ArdupilotHarness) -> None:
    harness.vehicle.parameters.set("ARMING_MIS_ITEMS", 1)


def low_voltage(harness: ArdupilotHarness) -> None:
    harness.vehicle.parameters.set("BATT_ARM_VOLT", 99)


CASES = [
    (lose_gps, "Arm: GPS 1: Bad fix"),
    (lose_gps, "Arm: Need Position Estimate"),
    (open_throttle, "Arm: Throttle too high"),
    (switch_radio_off, "Arm: Throttle below failsafe"),
    (require_landing, "Arm: Missing mission item: land"),
    (low_voltage, "Arm: Battery 1 below minimum arming voltage"),
    (lambda harness: harness.set_mode("RTL"), "Arm: RTL mode not armable"),
    (lambda harness: harness.set_mode("LAND"), "Arm: LAND mode not armable"),
]


@pytest.mark.fast_cases(7)
@pytest.mark.parametrize(("break_check", "text"), CASES, ids=[text for _, text in CASES])
def test_refused_arming_reports_the_reason(
    break_check: Callable[[ArdupilotHarness], object], text: str
) -> None:
    harness = ArdupilotHarness("copter")
    break_check(harness)
    harness.received.clear()
    assert harness.command(CMD.COMPONENT_ARM_DISARM, 1) == RESULT.FAILED
    assert text in harness.texts
    assert not harness.autopilot.armed
    assert harness.command(CMD.COMPONENT_ARM_DISARM, 1, 21196) == RESULT.ACCEPTED, "forced arming"


def test_arming_check_bits() -> None:
    harness = ArdupilotHarness("copter")
    low_voltage(harness)
    harness.vehicle.parameters.set("ARMING_CHECK", 1 << 3)
    assert harness.command(CMD.COMPONENT_ARM_DISARM, 1) == RESULT.ACCEPTED


@pytest.mark.nightly
def test_prearm_problems_are_repeated_every_30_s() -> None:
    harness = ArdupilotHarness("copter")
    low_voltage(harness)
    harness.run(65)
    assert harness.texts.count("PreArm: Battery 1 below minimum arming voltage") == 2
    harness.vehicle.parameters.set("ARMING_OPTIONS", 1)
    harness.run(35)
    assert harness.texts.count("PreArm: Battery 1 below minimum arming voltage") == 2


def test_arming_is_refused_during_boot() -> None:
    harness = ArdupilotHarness("copter", settle=0.3)
    assert harness.command(CMD.COMPONENT_ARM_DISARM, 1) == RESULT.FAILED
    assert "Arm: System not initialised" in harness.texts


def test_arming_and_disarming_texts() -> None:
    harness = ArdupilotHarness("copter")
    assert harness.command(CMD.COMPONENT_ARM_DISARM, 3) == RESULT.UNSUPPORTED
    harness.accepted(CMD.COMPONENT_ARM_DISARM, 1)
    harness.accepted(CMD.COMPONENT_ARM_DISARM, 1)
    harness.accepted(CMD.COMPONENT_ARM_DISARM, 0)
    assert harness.texts[-2:] == ["Arming motors", "Disarming motors"]
    assert any(isinstance(message, common.HomePosition) for message in harness.received)
    assert any(isinstance(message, common.GpsGlobalOrigin) for message in harness.received)


@pytest.mark.flight
def test_idle_copter_disarms() -> None:
    harness = ArdupilotHarness("copter")
    harness.vehicle.parameters.set("DISARM_DELAY", 3)
    harness.accepted(CMD.COMPONENT_ARM_DISARM, 1)
    harness.run(4)
    assert not harness.autopilot.armed


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize(
    ("break_check", "healthy"), [(lambda harness: harness.set_mode("RTL"), True), (low_voltage, False)]
)
def test_mode_is_not_a_prearm_check(break_check: Callable[[ArdupilotHarness], object], healthy: bool) -> None:
    harness = ArdupilotHarness("copter")
    break_check(harness)
    harness.run(2)
    harness.received.clear()
    harness.run(3)
    statuses = [message for message in harness.received if isinstance(message, common.SysStatus)]
    assert statuses
    assert all(
        bool(message.onboard_control_sensors_health & common.MavSysStatusSensor.PREARM_CHECK) is healthy
        for message in statuses
    )
