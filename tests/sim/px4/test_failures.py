"""INJECT_FAILURE: every accepted failure has an effect and can be cleared."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.sim.px4.failures import TYPES, UNITS
from tests.sim.harness import SimulationHarness, airborne, grounded
from tests.sim.px4.harness import CMD, RESULT, Px4Harness

SIMULATION = SimulationHarness()
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


@pytest.mark.parametrize(
    ("unit", "kind", "what"),
    [
        (UNIT.SENSOR_GPS, TYPE.OFF, {"gps"}),
        (UNIT.SENSOR_GPS, TYPE.WRONG, {"gps spoof"}),
        (UNIT.SENSOR_MAG, TYPE.STUCK, {"compass"}),
        (UNIT.SENSOR_BARO, TYPE.WRONG, {"baro"}),
        (UNIT.SYSTEM_MOTOR, TYPE.OFF, {"motor 1", "motor 2", "motor 3", "motor 4"}),
    ],
)
def test_px4_takes_failures_by_command(unit, kind, what) -> None:
    one = SIMULATION.vehicles[0] if SIMULATION.vehicles else SIMULATION.add("copter", "px4").run(3)
    assert one.command(CMD.INJECT_FAILURE, unit, kind, 0) == RESULT.ACCEPTED
    assert set(one.vehicle.faults.active) == what
    assert one.command(CMD.INJECT_FAILURE, unit, TYPE.OK, 0) == RESULT.ACCEPTED
    assert not one.vehicle.faults.active


@pytest.mark.flight
def test_px4_takes_one_motor_and_a_failing_link_by_command() -> None:
    copter = airborne("copter", "px4")
    assert copter.command(CMD.INJECT_FAILURE, UNIT.SYSTEM_MOTOR, TYPE.OFF, 2) == RESULT.ACCEPTED
    assert set(copter.vehicle.faults.active) == {"motor 2"}
    assert copter.command(CMD.INJECT_FAILURE, UNIT.SYSTEM_MAVLINK_SIGNAL, TYPE.OFF, 0) == RESULT.ACCEPTED
    assert copter.vehicle.cut_off
    copter.set(SYS_FAILURE_EN=0).inject("link on")
    assert copter.command(CMD.INJECT_FAILURE, UNIT.SENSOR_GPS, TYPE.OFF, 0) == RESULT.DENIED


def test_px4_takes_failures_from_its_shell() -> None:
    copter = grounded("copter", "px4")
    for line, active in (("failure gps off", {"gps"}), ("failure gps ok", set())):
        data = f"{line}\n".encode().ljust(70, b"\0")
        flags = common.SerialControlFlag.RESPOND | common.SerialControlFlag.EXCLUSIVE
        copter.send(common.SerialControl(device=10, flags=flags, count=len(line) + 1, data=data))
        copter.run(1)
        assert set(copter.vehicle.faults.active) == active
