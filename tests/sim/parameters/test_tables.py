"""The tables: of all firmwares and types, whole, and readable by clients."""

from __future__ import annotations

from collections import Counter
from importlib.resources import files
from itertools import product

import pytest

from mavstack.dialects import common
from mavstack.services.parameters import ParameterTable, unpack
from mavstack.services.parameters.value import Encoding, fitted, same, survives
from mavstack.sim.parameters import definitions
from mavstack.sim.parameters.tables import _LAYERS, expand, read, rows
from mavstack.sim.vehicle_types import Firmware, VehicleType
from tests.sim.parameters.names import wanted

KIND = common.MavParamType
ALL = list(product(Firmware, VehicleType))
KINDS = {
    Firmware.ARDUPILOT: {KIND.INT8, KIND.INT16, KIND.INT32, KIND.REAL32},
    Firmware.PX4: {KIND.INT32, KIND.REAL32},
}
FILES = sorted(file.name for file in (files("mavstack.sim.parameters") / "tables").iterdir())


def table(firmware, type_) -> ParameterTable:
    made = ParameterTable()
    for definition in definitions(firmware, type_):
        made.add(definition)
    return made


@pytest.mark.parametrize(("firmware", "type_"), ALL)
def test_a_table_is_as_long_as_a_real_one_and_clients_can_list_it(firmware, type_) -> None:
    found = rows(firmware, type_)
    assert 400 <= len(found) <= 1200
    assert len({row.name for row in found}) == len(found)
    assert all(1 <= len(row.name) <= 16 and row.name.replace("_", "").isalnum() for row in found)
    assert {row.kind for row in found} == KINDS[firmware]


@pytest.mark.parametrize(("firmware", "type_"), ALL)
def test_values_fit_their_types_limits_and_encoding(firmware, type_) -> None:
    encoding = Encoding.C_CAST if firmware is Firmware.ARDUPILOT else Encoding.BYTEWISE
    for row, definition in zip(rows(firmware, type_), definitions(firmware, type_), strict=True):
        assert fitted(row.value, row.kind) is not None, row
        assert survives(definition.value, row.kind, encoding), row
        assert row.minimum is None or row.minimum <= row.value <= row.maximum
        assert same(definition.value, fitted(definition.default, row.kind))


@pytest.mark.parametrize(("firmware", "type_"), ALL)
def test_what_the_autopilot_reads_is_there_with_the_types_of_real_programs(firmware, type_) -> None:
    kinds = {row.name: row.kind.name for row in rows(firmware, type_)}
    missing = {name: kind for name, kind in wanted(firmware, type_).items() if kinds.get(name) != kind}
    assert not missing


def test_the_types_of_vehicle_are_told_apart() -> None:
    ardupilot = {type_: table(Firmware.ARDUPILOT, type_) for type_ in VehicleType}
    assert ardupilot[VehicleType.ROVER]["FRAME_CLASS"].value == 1
    assert ardupilot[VehicleType.BOAT]["FRAME_CLASS"].value == 2
    assert ardupilot[VehicleType.PLANE]["Q_ENABLE"].value == 0
    assert "Q_RTL_MODE" not in ardupilot[VehicleType.PLANE]
    assert ardupilot[VehicleType.VTOL]["Q_ENABLE"].value == 1
    kinds = {type_: table(Firmware.PX4, type_)["MAV_TYPE"].value for type_ in VehicleType}
    assert kinds == {type_: type_.mav_type for type_ in VehicleType}
    assert len({table(Firmware.PX4, type_)["SYS_AUTOSTART"].value for type_ in VehicleType}) == 6


def test_px4_lists_by_name_and_ardupilot_in_an_order_of_its_own() -> None:
    for type_ in VehicleType:
        names = [row.name for row in rows(Firmware.PX4, type_)]
        assert names == sorted(names)
    assert (
        rows(Firmware.ARDUPILOT, VehicleType.COPTER)[:2] == rows(Firmware.ARDUPILOT, VehicleType.COPTER)[:2]
    )
    assert rows(Firmware.ARDUPILOT, VehicleType.PLANE)[1].name == "SYSID_THISMAV"


@pytest.mark.parametrize(("firmware", "type_"), ALL)
def test_the_packed_file_reads_back_to_the_table(firmware, type_) -> None:
    whole = table(firmware, type_)
    packed = unpack(whole.packed(with_defaults=True))
    assert packed is not None
    assert packed.whole
    assert packed.parameters == tuple(whole.parameters())
    assert [same(packed.defaults[row.name], row.definition().value) for row in rows(firmware, type_)].count(
        False
    ) == 0


@pytest.mark.parametrize("name", FILES)
def test_a_file_is_used_and_names_nothing_twice(name) -> None:
    text = (files("mavstack.sim.parameters") / "tables" / name).read_text("ascii")
    lines = text.splitlines()
    assert lines[0].startswith("# ")
    assert len(lines) <= 400
    assert not [name for name, times in Counter(row.name for row in read(text)).items() if times > 1]
    assert name in {
        f"{firmware}_{layer}.txt" for (firmware, _), layers in _LAYERS.items() for layer in layers
    }


def test_every_line_of_an_upper_file_says_something_new() -> None:
    folder = files("mavstack.sim.parameters") / "tables"
    said: dict[str, list[bool]] = {}
    for (firmware, _), layers in _LAYERS.items():
        below = {}
        for layer in layers:
            for row in read((folder / f"{firmware}_{layer}.txt").read_text("ascii")):
                said.setdefault(f"{firmware}_{layer} {row.name}", []).append(below.get(row.name) != row)
                below[row.name] = row
    assert not [line for line, news in said.items() if not any(news)]


def test_series_stand_for_their_members() -> None:
    assert expand("RC{9..11}_MIN") == ["RC9_MIN", "RC10_MIN", "RC11_MIN"]
    assert expand("OFS{,2}_{X,Y}") == ["OFS_X", "OFS_Y", "OFS2_X", "OFS2_Y"]
    assert expand("PLAIN") == ["PLAIN"]


def test_a_line_tells_type_value_limits_and_marks() -> None:
    first, second = read("# a remark\n\nA{1,2} INT16 3 1..9 read-only volatile\n")
    assert second == first._replace(name="A2")
    assert first == ("A1", KIND.INT16, 3, 1, 9, True, True)
    (real,) = read("B REAL32 -0.5 -1..+1")
    assert real == ("B", KIND.REAL32, -0.5, -1.0, 1.0, False, False)
    assert isinstance(real.minimum, float)


@pytest.mark.parametrize("line", ["NAME", "NAME INT8", "NAME INT8 1 2", "NAME INT8 1.5", " NAME INT8 1"])
def test_a_line_that_is_none_is_told(line) -> None:
    with pytest.raises(ValueError, match=r"line 1|invalid literal"):
        list(read(line))


def test_an_unknown_type_is_told() -> None:
    with pytest.raises(KeyError):
        list(read("NAME INT7 1"))
