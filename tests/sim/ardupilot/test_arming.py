"""What keeps an ArduPilot from arming, in its words."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from mavstack.dialects import common

from .harness import CMD, RESULT, ArdupilotHarness

if TYPE_CHECKING:
    from collections.abc import Callable


def lose_gps(bench: ArdupilotHarness) -> None:
    bench.set_mode("GUIDED")
    bench.vehicle.body.fail_gps(True)
    bench.run_until(lambda: not bench.autopilot.has_position)


def open_throttle(bench: ArdupilotHarness) -> None:
    bench.autopilot.radio.move(3, 1600)
    bench.run(0.5)


def switch_off(bench: ArdupilotHarness) -> None:
    bench.autopilot.radio.switch(False)
    bench.run(0.5)


def want_landing(bench: ArdupilotHarness) -> None:
    bench.vehicle.parameters.set("ARMING_MIS_ITEMS", 1)


def low_voltage(bench: ArdupilotHarness) -> None:
    bench.vehicle.parameters.set("BATT_ARM_VOLT", 99)


CASES = [
    (lose_gps, "Arm: GPS 1: Bad fix"),
    (lose_gps, "Arm: Need Position Estimate"),
    (open_throttle, "Arm: Throttle too high"),
    (switch_off, "Arm: Throttle below failsafe"),
    (want_landing, "Arm: Missing mission item: land"),
    (low_voltage, "Arm: Battery 1 below minimum arming voltage"),
    (lambda bench: bench.set_mode("RTL"), "Arm: RTL mode not armable"),
    (lambda bench: bench.set_mode("LAND"), "Arm: LAND mode not armable"),
]


@pytest.mark.parametrize(("spoil", "text"), CASES, ids=[text for _, text in CASES])
def test_refused_arming_says_why(spoil: Callable[[ArdupilotHarness], object], text: str) -> None:
    bench = ArdupilotHarness("copter")
    spoil(bench)
    bench.received.clear()
    assert bench.command(CMD.COMPONENT_ARM_DISARM, 1) == RESULT.FAILED
    assert text in bench.texts
    assert not bench.autopilot.armed
    assert bench.command(CMD.COMPONENT_ARM_DISARM, 1, 21196) == RESULT.ACCEPTED, "unless it is forced"


def test_the_checks_are_switched_by_their_bits() -> None:
    bench = ArdupilotHarness("copter")
    low_voltage(bench)
    bench.vehicle.parameters.set("ARMING_CHECK", 1 << 3)
    assert bench.command(CMD.COMPONENT_ARM_DISARM, 1) == RESULT.ACCEPTED


def test_reasons_are_repeated_every_half_minute_while_disarmed() -> None:
    bench = ArdupilotHarness("copter")
    low_voltage(bench)
    bench.run(65)
    assert bench.texts.count("PreArm: Battery 1 below minimum arming voltage") == 2
    bench.vehicle.parameters.set("ARMING_OPTIONS", 1)
    bench.run(35)
    assert bench.texts.count("PreArm: Battery 1 below minimum arming voltage") == 2


def test_nothing_may_be_armed_while_it_starts() -> None:
    bench = ArdupilotHarness("copter", settle=0.3)
    assert bench.command(CMD.COMPONENT_ARM_DISARM, 1) == RESULT.FAILED
    assert "Arm: System not initialised" in bench.texts


def test_arming_and_disarming_are_said_and_only_one_and_nought_are_orders() -> None:
    bench = ArdupilotHarness("copter")
    assert bench.command(CMD.COMPONENT_ARM_DISARM, 3) == RESULT.UNSUPPORTED
    bench.accepted(CMD.COMPONENT_ARM_DISARM, 1)
    bench.accepted(CMD.COMPONENT_ARM_DISARM, 1)
    bench.accepted(CMD.COMPONENT_ARM_DISARM, 0)
    assert bench.texts[-2:] == ["Arming motors", "Disarming motors"]
    assert any(isinstance(message, common.HomePosition) for message in bench.received)
    assert any(isinstance(message, common.GpsGlobalOrigin) for message in bench.received)


def test_a_copter_left_alone_disarms() -> None:
    bench = ArdupilotHarness("copter")
    bench.vehicle.parameters.set("DISARM_DELAY", 3)
    bench.accepted(CMD.COMPONENT_ARM_DISARM, 1)
    bench.run(4)
    assert not bench.autopilot.armed


@pytest.mark.parametrize(
    ("spoil", "healthy"), [(lambda bench: bench.set_mode("RTL"), True), (low_voltage, False)]
)
def test_the_mode_is_no_check_before_arming(
    spoil: Callable[[ArdupilotHarness], object], healthy: bool
) -> None:
    bench = ArdupilotHarness("copter")
    spoil(bench)
    bench.run(2)
    bench.received.clear()
    bench.run(3)
    told = [message for message in bench.received if isinstance(message, common.SysStatus)]
    assert told
    assert all(
        bool(message.onboard_control_sensors_health & common.MavSysStatusSensor.PREARM_CHECK) is healthy
        for message in told
    )
