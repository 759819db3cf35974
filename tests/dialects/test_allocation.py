from __future__ import annotations

import pytest

from mavstack.dialects import Dialect
from mavstack.dialects.allocation import id_warnings
from mavstack.dialects.tables import official_names

XML = """<mavlink><include>minimal.xml</include>{enums}<messages>
<message id="{id}" name="{name}"><field type="uint8_t" name="value"/></message></messages></mavlink>"""
COMMANDS = '<enums><enum name="MAV_CMD"><entry name="{}" value="{}"/></enum></enums>'


def warnings(number: int, name: str = "OWN_STATUS", enums: str = "") -> list[str]:
    dialect = Dialect.from_xml(XML.format(id=number, name=name, enums=enums))
    return [text for _, text in id_warnings(dialect.own_definition)]


@pytest.mark.parametrize("number", [229, 53000, 17_000_00, 16_777_215])
def test_ids_for_custom_messages(number):
    assert warnings(number) == []


@pytest.mark.parametrize(
    ("number", "problem"),
    [
        (13, "message OWN_STATUS has the reserved id 13; custom messages have ids above 255, or 180 to 229"),
        (255, "message OWN_STATUS has the reserved id 255"),
        (8500, "message OWN_STATUS has the id 8500 of the range of ASLUAV"),
        (60049, "message OWN_STATUS has the id 60049 of the range of storm32"),
        (30, "message OWN_STATUS has the id 30 of ATTITUDE of common"),
        (11000, "message OWN_STATUS has the id 11000 of DEVICE_OP_READ of ardupilotmega"),
    ],
)
def test_reserved_and_used_ids(number, problem):
    (found,) = warnings(number)
    assert found.startswith(problem)


def test_messages_that_official_dialects_define_otherwise():
    assert warnings(53000, "ATTITUDE") == ["message ATTITUDE has the id 53000, in common it has 30"]
    (found,) = warnings(30, "ATTITUDE")
    assert "message ATTITUDE has CRC_EXTRA " in found
    assert "in common 39: neither side reads the other's packets" in found


def test_commands_of_official_dialects():
    own, official = COMMANDS.format("MAV_CMD_OWN", 22), COMMANDS.format("MAV_CMD_NAV_TAKEOFF", 22)
    assert warnings(53000, enums=own) == ["MAV_CMD_OWN has the value 22 of MAV_CMD_NAV_TAKEOFF of common"]
    assert warnings(53000, enums=official) == []
    assert warnings(53000, enums=COMMANDS.format("MAV_CMD_OWN", 53000)) == []


@pytest.mark.parametrize("name", official_names())
def test_official_dialects_do_not_conflict(name):
    assert list(id_warnings(Dialect.load(name).own_definition)) == []
