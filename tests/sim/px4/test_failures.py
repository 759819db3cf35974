"""INJECT_FAILURE: every failure that is ACCEPTED is felt, and ended again."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.sim.px4.failures import TYPES, UNITS
from tests.sim.px4.pilot import CMD, RESULT, Pilot

UNIT, TYPE = common.FailureUnit, common.FailureType
KINDS = {
    UNIT.SENSOR_GPS: "gps",
    UNIT.SENSOR_MAG: "compass",
    UNIT.SENSOR_BARO: "baro",
    UNIT.SYSTEM_MOTOR: "motor",
    UNIT.SYSTEM_ESC: "motor",
    UNIT.SYSTEM_MAVLINK_SIGNAL: "link",
}


@pytest.mark.parametrize("unit", sorted(UNITS.values()))
@pytest.mark.parametrize("kind", sorted(set(TYPES.values()) - {TYPE.OK}))
def test_a_failure_is_a_fault_until_it_is_cleared(unit: int, kind: int) -> None:
    pilot = Pilot()
    result = pilot.command(CMD.INJECT_FAILURE, unit, kind, 0)
    if result == RESULT.UNSUPPORTED:
        assert not pilot.vehicle.faults.active
        return
    assert result == RESULT.ACCEPTED
    assert pilot.texts[-1].startswith("Injected: ")
    pilot.run(0.5)
    if unit == UNIT.SYSTEM_BATTERY:
        assert pilot.vehicle.body.battery.remaining < 0.05
    else:
        assert all(fault.startswith(KINDS[UNIT(unit)]) for fault in pilot.vehicle.faults.active)
        assert pilot.vehicle.faults.active
    if unit != UNIT.SYSTEM_MAVLINK_SIGNAL:  # what would end that is not heard any more
        assert pilot.command(CMD.INJECT_FAILURE, unit, TYPE.OK, 0) == RESULT.ACCEPTED
        assert not pilot.vehicle.faults.active
        assert pilot.texts[-1].startswith("Cleared: ")


def test_one_motor_of_several() -> None:
    pilot = Pilot().in_the_air(20)
    assert pilot.command(CMD.INJECT_FAILURE, UNIT.SYSTEM_MOTOR, TYPE.OFF, 2) == RESULT.ACCEPTED
    pilot.run_until(lambda: pilot.height < 0.5, timeout=30)


def test_a_transmitter_that_is_not_there_cannot_fail() -> None:
    assert Pilot().command(CMD.INJECT_FAILURE, UNIT.SYSTEM_RC_SIGNAL, TYPE.OFF) == RESULT.UNSUPPORTED


def test_failures_are_denied_if_the_parameter_says_so() -> None:
    pilot = Pilot()
    pilot.vehicle.parameters.set("SYS_FAILURE_EN", 0)
    assert pilot.command(CMD.INJECT_FAILURE, UNIT.SENSOR_GPS, TYPE.OFF) == RESULT.DENIED
