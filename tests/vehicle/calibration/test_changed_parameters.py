"""The parameters that a calibration changes are those that the program holds afterwards."""

from __future__ import annotations

from fnmatch import fnmatchcase

import pytest

from mavstack.dialects import common
from mavstack.services.parameters.server import ParameterServer
from mavstack.sim.parameters.tables import rows
from mavstack.sim.vehicle_types import VehicleType
from mavstack.vehicle import CalibrationKind
from mavstack.vehicle.calibration.changed_parameters import CALIBRATED
from tests.vehicle.world import ALL, PX4, fly

COPTER = (VehicleType.COPTER, PX4)
OFFSET, OTHER = "CAL_GYRO0_XOFF", "CAL_ACC0_XOFF"


def test_a_value_whose_announcement_was_lost_is_read_again():
    async def scenario(world, vehicle):
        await vehicle.params.download()
        world.simulated.parameters.table[OFFSET].value = 0.25
        world.simulated.parameters.table[OTHER].value = 0.5
        await vehicle.calibration.run("gyroscope")
        assert vehicle.params[OFFSET].value == 0.25
        assert vehicle.params[OTHER].value != 0.5

    fly(COPTER, scenario)


def test_parameters_that_the_program_does_not_hold_are_not_read():
    async def scenario(world, vehicle):
        await vehicle.calibration.run("gyroscope")
        assert OFFSET not in vehicle.params.cached

    fly(COPTER, scenario)


def test_announced_values_are_not_read_again():
    async def scenario(world, vehicle):
        await vehicle.params.download()
        table = world.simulated.parameters.table
        values = []
        vehicle.add_listener(common.ParamValue, lambda message: values.append(message.param_id))
        async with vehicle.calibration.start("gyroscope") as session:
            async for _ in session:
                if not values:
                    world.simulated.parameters.set(OFFSET, 0.75)
        assert vehicle.params[OFFSET].value == 0.75
        assert values.count(OFFSET) == 1
        gyroscopes = [each.name for each in table if fnmatchcase(each.name, "CAL_GYRO*")]
        assert sorted(values) == sorted(gyroscopes)

    fly(COPTER, scenario)


def test_a_vehicle_that_answers_no_request_keeps_its_calibration(monkeypatch):
    async def scenario(world, vehicle):
        await vehicle.params.download()
        held = vehicle.params[OFFSET].value
        world.simulated.parameters.table[OFFSET].value = 0.25
        monkeypatch.setattr(ParameterServer, "_read_requested", lambda *_: None)
        await vehicle.calibration.run("gyroscope")
        assert vehicle.params[OFFSET].value == held

    fly(COPTER, scenario)


@pytest.mark.parametrize("kind", CalibrationKind)
def test_each_pattern_names_parameters_of_a_firmware(kind):
    names = {row.name for vehicle_type, firmware in ALL for row in rows(firmware, vehicle_type)}
    assert [each for each in CALIBRATED[kind] if not any(fnmatchcase(name, each) for name in names)] == []
