"""Failures are injected into a simulated PX4 that allows them."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.errors import CommandDenied, InvalidArgumentError
from mavstack.node.failure import failure_types, failure_units


def test_names():
    assert failure_units()["rc_signal"] == common.FailureUnit.SYSTEM_RC_SIGNAL
    assert len(failure_units()) == len(common.FailureUnit)
    assert failure_types()["off"] == common.FailureType.OFF


@pytest.mark.vehicle(firmware="px4")
def test_a_failure_and_its_end(virtual_vehicle):
    async def flight(vehicle):
        simulated = virtual_vehicle.vehicle
        await vehicle.params.set("SYS_FAILURE_EN", 0)
        with pytest.raises(CommandDenied, match="DENIED"):
            await vehicle.failure.inject("gps")
        await vehicle.params.set("SYS_FAILURE_EN", 1)
        await vehicle.failure.inject("gps", "off")
        assert simulated.faults.active == {"gps": "gps off"}
        await vehicle.failure.inject("gps", "ok")
        await vehicle.failure.inject("motor", "off", 2)
        assert simulated.faults.active == {"motor 2": "motor 2 off"}
        with pytest.raises(CommandDenied, match="UNSUPPORTED"):
            await vehicle.failure.inject("vio", "drift")
        for wrong in (("wing",), ("gps", "broken"), ("gps", "off", 256)):
            with pytest.raises(InvalidArgumentError):
                await vehicle.failure.inject(*wrong)

    virtual_vehicle.run(flight)


def test_ardupilot_has_none(virtual_vehicle):
    async def flight(vehicle):
        with pytest.raises(CommandDenied, match="UNSUPPORTED"):
            await vehicle.failure.inject("gps")

    virtual_vehicle.run(flight)
