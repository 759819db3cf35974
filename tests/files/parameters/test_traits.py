from __future__ import annotations

import pytest

from mavstack.files.parameters import Owner, needs_reboot, owned_patterns, owner_of
from mavstack.files.parameters.traits import round_of
from mavstack.sim.parameters.tables import rows
from mavstack.sim.vehicle_types import Firmware, VehicleType


@pytest.mark.parametrize(
    ("name", "owner"),
    [
        ("STAT_RUNTIME", Owner.COUNTER),
        ("BARO1_GND_PRESS", Owner.COUNTER),
        ("LND_FLIGHT_T_HI", Owner.COUNTER),
        ("SYSID_THISMAV", Owner.IDENTITY),
        ("MAV_SYS_ID", Owner.IDENTITY),
        ("COMPASS_DEV_ID2", Owner.CALIBRATION),
        ("COMPASS_OFS3_X", Owner.CALIBRATION),
        ("INS_ACC2OFFS_Y", Owner.CALIBRATION),
        ("INS_GYR_ID", Owner.CALIBRATION),
        ("CAL_MAG0_ID", Owner.CALIBRATION),
        ("ins_acc_id", Owner.CALIBRATION),
        ("COMPASS_ENABLE", None),
        ("COMPASS_OFFS_MAX", None),
        ("INS_ACCEL_FILTER", None),
        ("TC_A_ENABLE", None),
        ("RTL_ALT", None),
        ("SYSID_MYGCS", None),
    ],
)
def test_parameters_of_one_vehicle(name, owner):
    assert owner_of(name) is owner


@pytest.mark.parametrize("firmware", Firmware)
def test_read_only_parameters_belong_to_one_vehicle(firmware):
    fixed = [row.name for row in rows(firmware, VehicleType.COPTER) if row.read_only]
    assert [name for name in fixed if owner_of(name) is None] == []


def test_turns():
    assert round_of("Q_ENABLE") < round_of("Q_A_RAT_RLL_P") < round_of("SYSID_THISMAV")


@pytest.mark.parametrize(
    ("name", "needed"),
    [("FRAME_CLASS", True), ("SERIAL2_PROTOCOL", True), ("SYS_AUTOSTART", True), ("RTL_ALT", False)],
)
def test_parameters_that_need_a_reboot(name, needed):
    assert needs_reboot(name) is needed


def test_the_patterns_of_owned_parameters_are_those_of_the_list():
    patterns = owned_patterns()
    assert {"SYSID_THISMAV", "MAV_SYSID", "MAV_SYS_ID"} <= set(patterns[Owner.IDENTITY])
    assert list(patterns) == list(Owner)
    names = {owner: [each.replace("*", "1").replace("?", "1") for each in patterns[owner]] for owner in Owner}
    assert all(owner_of(name) is owner for owner in Owner for name in names[owner])
