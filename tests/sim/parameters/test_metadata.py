"""The metadata that simulated vehicles serve: it agrees with their own parameters."""

from __future__ import annotations

import pytest

from mavstack.files.parameter_metadata import parse_parameter_metadata
from mavstack.sim.parameters.metadata import FOLDERS, described, served_metadata
from mavstack.sim.parameters.tables import rows
from mavstack.sim.vehicle_types import Firmware, VehicleType

EVERY_TYPE = [(firmware, kind) for firmware in Firmware for kind in VehicleType]


@pytest.mark.parametrize(("firmware", "kind"), EVERY_TYPE, ids=str)
def test_descriptions_agree_with_the_parameters(firmware, kind):
    known = {row.name: row for row in rows(firmware, kind)}
    found = described(firmware, kind)
    assert len(set(found) & set(known)) > 150
    for name in set(found) & set(known):
        entry, row = found[name], known[name]
        assert entry.short_description, name
        assert entry.read_only or entry.problem(row.value) is None, name
        assert entry.read_only == row.read_only, name


@pytest.mark.parametrize("firmware", list(Firmware))
def test_the_served_file_describes_every_parameter(firmware):
    served = served_metadata(firmware, VehicleType.COPTER)
    assert served is served_metadata(firmware, VehicleType.COPTER)
    table = parse_parameter_metadata(served.files[f"{FOLDERS[firmware]}/parameters.json.xz"], "served")
    for row in rows(firmware, VehicleType.COPTER):
        entry = table[row.name]
        assert (entry.type, entry.default, entry.volatile) == (row.type, row.value, row.volatile)


def test_every_line_is_used():
    for firmware in Firmware:
        names = {row.name for kind in VehicleType for row in rows(firmware, kind)}
        unused = {name for kind in VehicleType for name in described(firmware, kind)} - names
        assert unused == set()
