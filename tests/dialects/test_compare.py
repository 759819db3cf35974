"""Differences between two dialects, and checks of one file."""

import pytest

from mavstack.dialects import Dialect
from mavstack.dialects.checks import check_file
from mavstack.dialects.compare import compare
from mavstack.dialects.xml_definitions import parse_definition

BASE = """<mavlink>
<enums><enum name="E"><description>p</description>
<entry value="1" name="E_A"/><entry value="2" name="E_B"/></enum></enums>
<messages>
<message id="1" name="ONE"><description>d</description><field type="uint8_t" name="a" units="m"/>
<field type="uint8_t" name="b" enum="E"/><extensions/><field type="uint8_t" name="c"/></message>
<message id="2" name="TWO"><description>d</description><field type="uint8_t" name="a"/></message>
</messages></mavlink>"""


def changes(old, new, text=BASE, **options):
    assert old in text
    after = text.replace(old, new)
    first, second = (parse_definition(item.encode(), "x.xml", "x") for item in (text, after))
    return [str(change) for change in compare(first, second, **options)]


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ('id="2"', 'id="3"', ["changed message TWO: id 2 -> 3 (breaks the wire)"]),
        ('units="m"', 'units="cm"', ["changed field ONE.a: units m -> cm"]),
        (' units="m"', "", ["changed field ONE.a: units m -> nothing"]),
        ('value="2"', 'value="4"', ["changed entry E.E_B: value 2 -> 4"]),
        ('<entry value="2" name="E_B"/>', "", ["removed entry E.E_B"]),
        ('name="TWO"', 'name="THREE"', ["added message THREE", "removed message TWO"]),
        ('name="c"/>', 'name="c"/><field type="float" name="d"/>', ["added field ONE.d"]),
        ("<enum ", '<enum bitmask="true" ', ["changed enum E: bitmask False -> True"]),
        ("<description>d<", "<description>e<", []),
    ],
)
def test_differences(old, new, expected):
    assert changes(old, new) == expected


def test_a_changed_type_breaks_the_wire():
    found = changes('type="uint8_t" name="a" units', 'type="uint16_t" name="a" units')
    assert len(found) == 2
    assert all(text.endswith("(breaks the wire)") for text in found)
    assert "CRC_EXTRA" in found[0]


def test_an_inserted_extension_breaks_the_wire():
    found = changes(
        '<field type="uint8_t" name="c"/>', '<field type="float" name="z"/><field type="uint8_t" name="c"/>'
    )
    assert found == [
        "changed field ONE.c: offset 0 -> 4 in the extensions (breaks the wire)",
        "added field ONE.z",
    ]


def test_descriptions_are_compared_on_request():
    assert len(changes("<description>d<", "<description>e<", prose=True)) == 2


def test_deprecations_are_described():
    found = changes(
        'name="TWO">', 'name="TWO"><deprecated since="2020-01" replaced_by="ONE">why</deprecated>'
    )
    assert found == ["changed message TWO: deprecated nothing -> 2020-01 ONE"]


def test_an_official_dialect_equals_itself_and_extends_its_includes():
    small, large = Dialect.load("common").definition, Dialect.load("ardupilotmega").definition
    assert compare(large, large, prose=True) == []
    found = compare(small, large)
    assert {change.kind for change in found} == {"added"}
    assert any(str(change) == "added entry MAV_CMD.MAV_CMD_POWER_OFF_INITIATED" for change in found)


FILE_WITH_WARNINGS = """<mavlink>
<enums>
<enum name="E" bitmask="true" colour="red">
<entry name="E_A"/>
<entry value="6" name="E_B"><param index="1" enum="NONE" units="m&#9;s">p</param></entry>
</enum>
<enum name="EMPTY"></enum>
</enums>
<messages>
<message id="53001" name="A_B"><field type="float" name="x" enum="E"/></message>
<message id="53002" name="A__B"><description>d</description><note/>
<field type="uint8_t" name="x" minValue="3" maxValue="1" units="m&#10;s"/></message>
</messages>
</mavlink>"""


def test_warnings(tmp_path):
    path = tmp_path / "x.xml"
    path.write_text(FILE_WITH_WARNINGS)
    found = [(problem.line, problem.severity, problem.text) for problem in check_file(str(path))]
    assert [(line, severity) for line, severity, _ in found] == [
        (line, "warning") for line in (3, 4, 5, 5, 5, 7, 10, 10, 11, 11, 12, 12)
    ]
    texts = "\n".join(text for _, _, text in found)
    for part in (
        "unknown attribute 'colour'",
        "E_A has no value",
        "6 is not a single bit",
        "enum NONE",
        "EMPTY has no entries",
        "A_B has no description",
        "cannot have the enum E",
        "minimum above",
        "the unit of A__B.x has control characters: 'm\\ns'",
        "the unit of param 1 of E_B has control characters",
        "<note>",
        "same class name",
    ):
        assert part in texts
    assert str(check_file(str(path))[0]).startswith(f"{path}:3: warning: ")


def test_an_error_is_the_only_problem(tmp_path):
    path = tmp_path / "x.xml"
    path.write_text("<mavlink>\n<include>gone.xml</include></mavlink>")
    (problem,) = check_file(str(path))
    assert (problem.severity, problem.line) == ("error", 2)
