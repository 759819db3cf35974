"""Parameter tables of all firmwares and vehicle types: complete and readable by clients."""

from __future__ import annotations

from collections import Counter
from importlib.resources import files
from itertools import product

import pytest

from mavstack.dialects import common
from mavstack.services.parameters import ParameterTable, unpack
from mavstack.services.parameters.value import Encoding, fitted, same, survives
from mavstack.sim.parameters import definitions
from mavstack.sim.parameters.tables import _LAYERS, expand, parse, rows
from mavstack.sim.vehicle_types import Firmware, VehicleType
from tests.sim.parameters.names import required_types

KIND = common.MavParamType
ALL = list(product(Firmware, VehicleType))
KINDS = {
    Firmware.ARDUPILOT: {KIND.INT8, KIND.INT16, KIND.INT32, KIND.REAL32},
    Firmware.PX4: {KIND.INT32, KIND.REAL32},
}
#: Parameters that are shown once another one enables them.
GROUPS = {
    "ardupilot_follow.txt", "ardupilot_follow_rover.txt", "ardupilot_precision_landing.txt",
}  # fmt: skip
FILES = sorted(file.name for file in (files("mavstack.sim.parameters") / "tables").iterdir())


def table(firmware, vehicle) -> ParameterTable:
    result = ParameterTable()
    for definition in definitions(firmware, vehicle):
        result.add(definition)
    return result


@pytest.mark.parametrize(("firmware", "vehicle"), ALL)
def test_table_size_names_and_types(firmware, vehicle) -> None:
    found = rows(firmware, vehicle)
    assert 400 <= len(found) <= 1200
    assert len({row.name for row in found}) == len(found)
    assert all(1 <= len(row.name) <= 16 and row.name.replace("_", "").isalnum() for row in found)
    assert {row.type for row in found} == KINDS[firmware]


@pytest.mark.parametrize(("firmware", "vehicle"), ALL)
def test_values_fit_their_types_limits_and_encoding(firmware, vehicle) -> None:
    encoding = Encoding.C_CAST if firmware is Firmware.ARDUPILOT else Encoding.BYTEWISE
    for row, definition in zip(rows(firmware, vehicle), definitions(firmware, vehicle), strict=True):
        assert fitted(row.value, row.type) is not None, row
        assert survives(definition.value, row.type, encoding), row
        assert row.minimum is None or row.minimum <= row.value <= row.maximum
        assert same(definition.value, fitted(definition.default, row.type))


@pytest.mark.parametrize(("firmware", "vehicle"), ALL)
def test_parameters_read_by_the_autopilot_have_the_types_of_real_firmware(firmware, vehicle) -> None:
    kinds = {row.name: row.type.name for row in rows(firmware, vehicle)}
    missing = {
        name: kind for name, kind in required_types(firmware, vehicle).items() if kinds.get(name) != kind
    }
    assert not missing


def test_vehicle_types_have_different_values() -> None:
    ardupilot = {vehicle: table(Firmware.ARDUPILOT, vehicle) for vehicle in VehicleType}
    assert ardupilot[VehicleType.ROVER]["FRAME_CLASS"].value == 1
    assert ardupilot[VehicleType.BOAT]["FRAME_CLASS"].value == 2
    assert ardupilot[VehicleType.PLANE]["Q_ENABLE"].value == 0
    assert "Q_RTL_MODE" not in ardupilot[VehicleType.PLANE]
    assert ardupilot[VehicleType.VTOL]["Q_ENABLE"].value == 1
    kinds = {vehicle: table(Firmware.PX4, vehicle)["MAV_TYPE"].value for vehicle in VehicleType}
    assert kinds == {vehicle: vehicle.mav_type for vehicle in VehicleType}
    assert len({table(Firmware.PX4, vehicle)["SYS_AUTOSTART"].value for vehicle in VehicleType}) == 6


def test_order_of_parameters() -> None:
    for vehicle in VehicleType:
        names = [row.name for row in rows(Firmware.PX4, vehicle)]
        assert names == sorted(names)
    assert (
        rows(Firmware.ARDUPILOT, VehicleType.COPTER)[:2] == rows(Firmware.ARDUPILOT, VehicleType.COPTER)[:2]
    )
    assert rows(Firmware.ARDUPILOT, VehicleType.PLANE)[1].name == "SYSID_THISMAV"


@pytest.mark.parametrize(("firmware", "vehicle"), ALL)
def test_packed_file_round_trip(firmware, vehicle) -> None:
    complete = table(firmware, vehicle)
    packed = unpack(complete.packed(with_defaults=True))
    assert packed is not None
    assert packed.complete
    assert packed.parameters == tuple(complete.parameters())
    assert [same(packed.defaults[row.name], row.definition().value) for row in rows(firmware, vehicle)].count(
        False
    ) == 0


@pytest.mark.parametrize("name", FILES)
def test_every_file_is_used_and_has_no_duplicates(name) -> None:
    text = (files("mavstack.sim.parameters") / "tables" / name).read_text("ascii")
    lines = text.splitlines()
    assert lines[0].startswith("# ")
    assert len(lines) <= 400
    assert not [name for name, times in Counter(row.name for row in parse(text)).items() if times > 1]
    assert name in GROUPS | {
        f"{firmware}_{layer}.txt" for (firmware, _), layers in _LAYERS.items() for layer in layers
    }


def test_no_line_repeats_a_lower_file() -> None:
    folder = files("mavstack.sim.parameters") / "tables"
    lines: dict[str, list[bool]] = {}
    for (firmware, _), layers in _LAYERS.items():
        below = {}
        for layer in layers:
            for row in parse((folder / f"{firmware}_{layer}.txt").read_text("ascii")):
                lines.setdefault(f"{firmware}_{layer} {row.name}", []).append(below.get(row.name) != row)
                below[row.name] = row
    assert not [line for line, changes in lines.items() if not any(changes)]


def test_expand_series() -> None:
    assert expand("RC{9..11}_MIN") == ["RC9_MIN", "RC10_MIN", "RC11_MIN"]
    assert expand("OFS{,2}_{X,Y}") == ["OFS_X", "OFS_Y", "OFS2_X", "OFS2_Y"]
    assert expand("PLAIN") == ["PLAIN"]


def test_parse_type_value_limits_and_flags() -> None:
    first, second = parse("# a remark\n\nA{1,2} INT16 3 1..9 read-only volatile\n")
    assert second == first._replace(name="A2")
    assert first == ("A1", KIND.INT16, 3, 1, 9, True, True)
    (real,) = parse("B REAL32 -0.5 -1..+1")
    assert real == ("B", KIND.REAL32, -0.5, -1.0, 1.0, False, False)
    assert isinstance(real.minimum, float)


@pytest.mark.parametrize("line", ["NAME", "NAME INT8", "NAME INT8 1 2", "NAME INT8 1.5", " NAME INT8 1"])
def test_invalid_line_is_refused(line) -> None:
    with pytest.raises(ValueError, match=r"line 1|invalid literal"):
        list(parse(line))


def test_unknown_type_is_refused() -> None:
    with pytest.raises(KeyError):
        list(parse("NAME INT7 1"))
