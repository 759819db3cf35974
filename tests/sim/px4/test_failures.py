"""INJECT_FAILURE: every accepted failure has an effect and can be cleared."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.sim.px4.failures import TYPES, UNITS
from tests.sim.px4.harness import CMD, RESULT, Px4Harness

UNIT, TYPE = common.FailureUnit, common.FailureType
FAULTS = {
    UNIT.SENSOR_GPS: "gps",
    UNIT.SENSOR_MAG: "compass",
    UNIT.SENSOR_BARO: "baro",
    UNIT.SYSTEM_MOTOR: "motor",
    UNIT.SYSTEM_ESC: "motor",
    UNIT.SYSTEM_MAVLINK_SIGNAL: "link",
}


@pytest.mark.fast_cases(12)
@pytest.mark.parametrize("unit", sorted(UNITS.values()))
@pytest.mark.parametrize("failure_type", sorted(set(TYPES.values()) - {TYPE.OK}))
def test_failure_is_a_fault_until_cleared(unit: int, failure_type: int) -> None:
    harness = Px4Harness()
    result = harness.command(CMD.INJECT_FAILURE, unit, failure_type, 0)
    if result == RESULT.UNSUPPORTED:
        assert not harness.vehicle.faults.active
        return
    assert result == RESULT.ACCEPTED
    assert harness.texts[-1].startswith("Injected: ")
    harness.run(0.5)
    if unit == UNIT.SYSTEM_BATTERY:
        assert harness.vehicle.body.battery.remaining < 0.05
    else:
        assert all(fault.startswith(FAULTS[UNIT(unit)]) for fault in harness.vehicle.faults.active)
        assert harness.vehicle.faults.active
    if unit != UNIT.SYSTEM_MAVLINK_SIGNAL:  # the command that clears the failure is not received
        assert harness.command(CMD.INJECT_FAILURE, unit, TYPE.OK, 0) == RESULT.ACCEPTED
        assert not harness.vehicle.faults.active
        assert harness.texts[-1].startswith("Cleared: ")


@pytest.mark.flight
def test_failure_of_one_motor() -> None:
    harness = Px4Harness().take_off(20)
    assert harness.command(CMD.INJECT_FAILURE, UNIT.SYSTEM_MOTOR, TYPE.OFF, 2) == RESULT.ACCEPTED
    harness.run_until(lambda: harness.height < 0.5, timeout=30)


def test_rc_failure_without_a_transmitter_is_unsupported() -> None:
    assert Px4Harness().command(CMD.INJECT_FAILURE, UNIT.SYSTEM_RC_SIGNAL, TYPE.OFF) == RESULT.UNSUPPORTED


def test_failures_are_denied_without_sys_failure_en() -> None:
    harness = Px4Harness()
    harness.vehicle.parameters.set("SYS_FAILURE_EN", 0)
    assert harness.command(CMD.INJECT_FAILURE, UNIT.SENSOR_GPS, TYPE.OFF) == RESULT.DENIED
