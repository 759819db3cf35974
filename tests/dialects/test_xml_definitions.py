"""Reading definition files: the schema, and one DialectError for a malformed or malicious file."""

import pytest

from mavstack.dialects import Dialect
from mavstack.dialects.xml_definitions import parse_definition
from mavstack.dialects.xml_reader import MAX_DEPTH, MAX_FILE_BYTES
from mavstack.errors import DialectError

FIELD = '<field type="uint8_t" name="a">text</field>'


def messages(inside):
    return f"<mavlink>\n<messages>\n{inside}\n</messages>\n</mavlink>"


def message(fields, name="M", number=1):
    return messages(
        f'<message id="{number}" name="{name}">\n<description>d</description>\n{fields}\n</message>'
    )


def enums(inside):
    return f"<mavlink>\n<enums>\n{inside}\n</enums>\n</mavlink>"


def enum(entries):
    return enums(f'<enum name="E">\n{entries}\n</enum>')


def read(text):
    data = text if isinstance(text, bytes) else text.encode()
    return parse_definition(data, "some/file.xml", "file")


BROKEN = {
    "empty file": (b"", 1, "empty"),
    "only space": (b" \n ", 1, "empty"),
    "not xml": (b"hello", 1, "not well-formed"),
    "cut short": ("<mavlink>\n<messages>\n", 3, "not well-formed"),
    "mismatched tag": ("<mavlink>\n</mavlunk>", 2, "not well-formed"),
    "not utf-8": (b"<mavlink>\n<!-- caf\xe9 -->\n</mavlink>", 2, "UTF-8"),
    "unknown encoding": (b'<?xml version="1.0" encoding="nothing"?><mavlink/>', 1, ""),
    "wrong root": ("<html></html>", 1, "<html>"),
    "doctype": ('<!DOCTYPE mavlink SYSTEM "http://example.org/x.dtd">\n<mavlink/>', 1, "not allowed"),
    "entity bomb": (
        "<mavlink/>\n".replace("<", '<!DOCTYPE m [\n<!ENTITY a "aa">\n<!ENTITY b "&a;&a;">\n]>\n<', 1),
        1,
        "not allowed",
    ),
    "undefined entity": ("<mavlink>\n&lol;\n</mavlink>", 2, "undefined entity"),
    "too deep": ("<mavlink>" + "<a>" * MAX_DEPTH, 1, "deeper"),
    "too large": (b"<mavlink>" + b" " * MAX_FILE_BYTES, None, "larger"),
    "version no number": ("<mavlink>\n<version>x</version>\n</mavlink>", 2, "<version> 'x'"),
    "version too big": ("<mavlink>\n<version>256</version>\n</mavlink>", 2, "0 to 255"),
    "dialect no number": ("<mavlink>\n<dialect></dialect>\n</mavlink>", 2, "<dialect>"),
    "empty include": ("<mavlink>\n<include></include>\n</mavlink>", 2, "<include>"),
    "include of a URL": ("<mavlink>\n<include>http://x/y.xml</include>\n</mavlink>", 2, "<include>"),
    "message without id": (messages(f'<message name="M">{FIELD}</message>'), 3, "'id'"),
    "message without name": (messages(f'<message id="1">{FIELD}</message>'), 3, "'name'"),
    "message id no number": (message(FIELD, number="one"), 3, "'one' is not an integer"),
    "message id negative": (message(FIELD, number=-1), 3, "0 to 16777215"),
    "message id too big": (message(FIELD, number=1 << 24), 3, "0 to 16777215"),
    "message id twice": (
        messages(f'<message id="1" name="A">{FIELD}</message>\n<message id="1" name="B">{FIELD}</message>'),
        4,
        "already used by A",
    ),
    "message name twice": (
        messages(f'<message id="1" name="A">{FIELD}</message>\n<message id="2" name="A">{FIELD}</message>'),
        4,
        "defined twice",
    ),
    "message name no identifier": (message(FIELD, name="A-B"), 3, "'A-B'"),
    "message name endless": (message(FIELD, name="A" * 10_000), 3, "not a valid name"),
    "enum reference no identifier": (message('<field type="uint8_t" name="a" enum="E F"/>'), 5, "'E F'"),
    "no fields": (message(""), 3, "0 fields"),
    "too many fields": (
        message("".join(f'<field type="uint8_t" name="f{i}"/>' for i in range(65))),
        3,
        "65 fields",
    ),
    "field twice": (message(f"{FIELD}\n{FIELD}"), 6, "two fields called 'a'"),
    "field without type": (message('<field name="a"/>'), 5, "'type'"),
    "field without name": (message('<field type="uint8_t"/>'), 5, "'name'"),
    "field name no identifier": (message('<field type="uint8_t" name="1a"/>'), 5, "'1a'"),
    "field name with bracket": (message('<field type="uint8_t" name="a[2]"/>'), 5, "'a[2]'"),
    "field name not ascii": (message('<field type="uint8_t" name="ä"/>'), 5, "'ä'"),
    "unknown type": (message('<field type="uint24_t" name="a"/>'), 5, "'uint24_t'"),
    "type with space": (message('<field type="uint8_t [3]" name="a"/>'), 5, "unknown field type"),
    "array of versions": (
        message('<field type="uint8_t_mavlink_version[2]" name="a"/>'),
        5,
        "unknown field type",
    ),
    "array length zero": (message('<field type="uint8_t[0]" name="a"/>'), 5, "1 to 255"),
    "array length 256": (message('<field type="uint8_t[256]" name="a"/>'), 5, "1 to 255"),
    "array length huge": (message(f'<field type="uint8_t[{"9" * 5000}]" name="a"/>'), 5, "not an integer"),
    "payload too long": (
        message('<field type="uint8_t[200]" name="a"/><field type="double[7]" name="b"/>'),
        3,
        "256",
    ),
    "payload too long by an extension": (
        message('<field type="uint8_t[255]" name="a"/><extensions/><field type="uint8_t" name="b"/>'),
        3,
        "256",
    ),
    "second extensions mark": (message(f"{FIELD}\n<extensions/>\n<extensions/>"), 7, "second <extensions/>"),
    "bad minimum": (message('<field type="uint8_t" name="a" minValue="low"/>'), 5, "minValue 'low'"),
    "bad multiplier": (message('<field type="uint8_t" name="a" multiplier="1/0"/>'), 5, "multiplier '1/0'"),
    "bad instance": (message('<field type="uint8_t" name="a" instance="maybe"/>'), 5, "instance 'maybe'"),
    "enum without name": (enums("<enum></enum>"), 3, "'name'"),
    "enum twice": (enums('<enum name="E"></enum>\n<enum name="E"></enum>'), 4, "defined twice"),
    "enum bad bitmask": (enums('<enum name="E" bitmask="yes"></enum>'), 3, "bitmask 'yes'"),
    "entry without name": (enum('<entry value="1"/>'), 4, "'name'"),
    "entry name twice": (
        enum('<entry value="1" name="A"/>\n<entry value="2" name="A"/>'),
        5,
        "two entries called A",
    ),
    "entry value twice": (
        enum('<entry value="1" name="A"/>\n<entry value="0x1" name="B"/>'),
        5,
        "has the value 1 twice: A and B",
    ),
    "entry value no number": (enum('<entry value="1+1" name="A"/>'), 4, "'1+1'"),
    "entry value code": (enum('<entry value="__import__(\'os\')" name="A"/>'), 4, "is not an integer"),
    "entry value too big": (enum('<entry value="2**64" name="A"/>'), 4, "outside"),
    "param without index": (enum('<entry value="1" name="A"><param/></entry>'), 4, "'index'"),
    "param index zero": (enum('<entry value="1" name="A"><param index="0"/></entry>'), 4, "1 to 255"),
    "param twice": (
        enum('<entry value="1" name="A"><param index="1"/>\n<param index="1"/></entry>'),
        5,
        "twice",
    ),
    "param bad maximum": (
        enum('<entry value="1" name="A"><param index="1" maxValue="x"/></entry>'),
        4,
        "maxValue",
    ),
}


@pytest.mark.parametrize(("text", "line", "problem"), BROKEN.values(), ids=BROKEN.keys())
def test_a_malformed_file_raises_with_file_and_line(text, line, problem):
    with pytest.raises(DialectError) as caught:
        read(text)
    assert caught.value.path == "some/file.xml"
    assert caught.value.line == line
    assert problem in caught.value.problem
    position = "some/file.xml: " if line is None else f"some/file.xml:{line}: "
    assert str(caught.value).startswith(position)
    assert len(str(caught.value)) < 400


@pytest.mark.parametrize(("text", "line", "problem"), BROKEN.values(), ids=BROKEN.keys())
def test_from_xml_raises_the_same_error(tmp_path, text, line, problem):
    path = tmp_path / "bad.xml"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(DialectError) as caught:
        Dialect.from_xml(path)
    assert (caught.value.path, caught.value.line) == (str(path), line)


def test_a_missing_file_and_a_directory_raise(tmp_path):
    with pytest.raises(DialectError, match="no such file"):
        Dialect.from_xml(tmp_path / "none.xml")
    with pytest.raises(DialectError, match="cannot be read"):
        Dialect.from_xml(tmp_path)


@pytest.mark.parametrize(
    ("text", "value"),
    [("7", 7), ("0x1F", 31), ("0b101", 5), ("2**40", 1 << 40), (str(2**64 - 1), 2**64 - 1), ("-3", -3)],
)
def test_entry_values_have_four_notations(text, value):
    assert read(enum(f'<entry value="{text}" name="A"/>')).enums[0].entries[0].value == value


def test_entries_without_value_follow_the_highest_one():
    entries = read(enum('<entry name="A"/><entry name="B" value="10"/><entry name="C"/>')).enums[0].entries
    assert [(entry.value, entry.automatic) for entry in entries] == [(1, True), (10, False), (11, True)]


def test_all_attributes_of_a_field():
    text = message(
        '<field type="uint16_t" name="a" units="cV" multiplier="1E-2" invalid="UINT16_MAX" instance="true"'
        ' print_format="0x%04x" display="bitmask" minValue="-1" maxValue="1.5" increment="0.5"'
        ' default="NaN">some text'
        '</field><extensions/><field type="char[5]" name="b"><description>more</description></field>'
    )
    first, second = read(text).messages[0].fields
    assert (first.units, first.factor, first.invalid, first.print_format) == (
        "cV",
        0.01,
        "UINT16_MAX",
        "0x%04x",
    )
    assert (first.display, first.minimum, first.maximum, first.increment) == ("bitmask", -1, 1.5, 0.5)
    assert (first.default, first.instance, first.extension, first.description) == (
        "NaN",
        True,
        False,
        "some text",
    )
    assert (second.type, second.array_length, second.extension, second.description) == (
        "char",
        5,
        True,
        "more",
    )


def test_all_attributes_of_an_entry():
    text = enum(
        '<entry value="1" name="A" hasLocation="true" isDestination="true" missionOnly="true" mission="true">'
        '<deprecated since="2020-01" replaced_by="B">why</deprecated><description>what</description>'
        '<param index="2" label="L" units="m" minValue="0" maxValue="2.5" increment="0.5" enum="X"'
        ' default="NaN" reserved="true" decimalPlaces="2">prose</param></entry>'
        '<entry value="2" name="B"><wip since="2024-01"/>'
        '<superseded since="2021-02" replaced_by="C"/></entry>'
    )
    first, second = read(text).enums[0].entries
    assert (first.has_location, first.is_destination, first.mission_only, first.mission) == (True,) * 4
    assert (first.fence, first.has_altitude_only) == (False, False)
    assert (first.deprecated.since, first.deprecated.replaced_by) == ("2020-01", "B")
    assert (first.deprecated.description, first.description) == ("why", "what")
    param = first.params[0]
    assert (param.index, param.label, param.units, param.minimum, param.maximum) == (2, "L", "m", 0, 2.5)
    assert (param.increment, param.enum, param.default, param.reserved) == (0.5, "X", "NaN", True)
    assert (param.decimal_places, param.description) == (2, "prose")
    assert (second.wip, second.wip_since, second.superseded.replaced_by) == (True, "2024-01", "C")


def test_comments_unknown_elements_and_unknown_attributes_are_skipped():
    definition = read(message('<!-- c --><note>n</note><field type="uint8_t" name="a" colour="red"/>'))
    assert [item.name for item in definition.messages[0].fields] == ["a"]


def test_a_file_may_have_another_encoding_and_a_byte_order_mark():
    latin = '<?xml version="1.0" encoding="ISO-8859-1"?>\n' + message(FIELD).replace(">d<", ">caf\xe9<")
    assert read(latin.encode("latin-1")).messages[0].description == "caf\xe9"
    assert read(b"\xef\xbb\xbf" + message(FIELD).encode()).messages[0].name == "M"


def test_the_version_type_is_uint8_in_crc_extra():
    version = read(message('<field type="uint8_t_mavlink_version" name="a"/>')).messages[0]
    assert version.fields[0].protocol_version
    assert version.fields[0].type == "uint8_t"
    assert version.crc_extra == read(message(FIELD)).messages[0].crc_extra
