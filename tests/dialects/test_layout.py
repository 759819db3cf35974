"""Layouts, lengths and CRC_EXTRA of every official message, compared with pymavlink's reader of our files."""

import contextlib
import importlib
import io
import os
from pathlib import Path

import pytest

import mavstack.dialects
from mavstack.dialects import Dialect
from mavstack.dialects.layout import assign_offsets, crc_extra, lengths, wire_order
from mavstack.dialects.model import FieldDefinition

DEFINITIONS = Path(mavstack.dialects.__file__).parent / "definitions"
NAMES = sorted(path.stem for path in DEFINITIONS.glob("*.xml"))


def test_wire_order_is_a_stable_sort_by_element_size_with_extensions_last():
    fields = [
        FieldDefinition("a", "uint8_t"),
        FieldDefinition("b", "uint16_t", 3),
        FieldDefinition("c", "uint8_t", 8),
        FieldDefinition("d", "double"),
        FieldDefinition("e", "int16_t"),
        FieldDefinition("f", "uint8_t", extension=True),
        FieldDefinition("g", "uint64_t", extension=True),
    ]
    assert [item.name for item in wire_order(fields)] == ["d", "b", "e", "a", "c", "f", "g"]
    assert [item.offset for item in assign_offsets(fields)] == [16, 8, 17, 0, 14, 25, 26]
    assert lengths(fields) == (25, 34)


def test_crc_extra_excludes_extensions_and_includes_array_lengths():
    base = [FieldDefinition("a", "uint8_t", 4)]
    longer = [FieldDefinition("a", "uint8_t", 5)]
    extended = [*base, FieldDefinition("b", "float", extension=True)]
    assert crc_extra("M", base) == crc_extra("M", extended) != crc_extra("M", longer)


@pytest.mark.parametrize(
    ("name", "number", "crc", "base", "total"),
    [
        ("HEARTBEAT", 0, 50, 9, 9),
        ("SYS_STATUS", 1, 124, 31, 43),
        ("ATTITUDE", 30, 39, 28, 28),
        ("COMMAND_LONG", 76, 152, 33, 33),
        ("STATUSTEXT", 253, 83, 51, 54),
        ("SETUP_SIGNING", 256, 71, 42, 42),
    ],
)
def test_well_known_messages(name, number, crc, base, total):
    definition = Dialect.load("common")[name].definition
    assert (definition.id, definition.crc_extra) == (number, crc)
    assert (definition.base_length, definition.length) == (base, total)


def reference(name):
    """Return the messages and enums of one of our files as read by pymavlink."""
    mavparse = importlib.import_module("pymavlink.generator.mavparse")
    with contextlib.redirect_stdout(io.StringIO()):
        return mavparse.MAVXML(os.fspath(DEFINITIONS / f"{name}.xml"), "2.0")


@pytest.mark.parametrize("name", NAMES)
def test_every_layout_equals_that_of_the_reference(name):
    parsed = reference(name)
    own = {message.name: message for message in Dialect.load(name).own_definition.messages}
    assert own.keys() == {message.name for message in parsed.message}
    for theirs in parsed.message:
        ours = own[theirs.name]
        assert (ours.id, ours.crc_extra) == (theirs.id, theirs.crc_extra), theirs.name
        assert (ours.base_length, ours.length) == (theirs.wire_min_length, theirs.wire_length), theirs.name
        assert [item.name for item in ours.wire_order] == theirs.ordered_fieldnames, theirs.name
        assert {item.name: item.offset for item in ours.fields} == theirs.field_offsets, theirs.name
        for our_field, their_field in zip(ours.fields, theirs.fields, strict=True):
            assert (our_field.type, our_field.array_length) == (their_field.type, their_field.array_length)
            assert (our_field.enum, our_field.multiplier) == (their_field.enum, their_field.multiplier)
            assert f"[{our_field.units}]" == (their_field.units or "[]")


@pytest.mark.parametrize("name", NAMES)
def test_every_enum_equals_that_of_the_reference(name):
    own = {enum.name: enum for enum in Dialect.load(name).own_definition.enums}
    for theirs in reference(name).enum:
        ours = own[theirs.name]
        assert [(entry.name, entry.value) for entry in ours.entries] == [
            (entry.name, entry.value) for entry in theirs.entry
        ]
        assert ours.bitmask == theirs.bitmask


def test_crc_extra_agrees_with_the_generated_module():
    os.environ.setdefault("MAVLINK20", "1")
    module = importlib.import_module("pymavlink.dialects.v20.ardupilotmega")
    dialect = Dialect.load("ardupilotmega")
    common = [theirs for number, theirs in module.mavlink_map.items() if number in dialect]
    assert len(common) > 250
    for theirs in common:
        ours = dialect[theirs.id].definition
        assert (ours.name, ours.crc_extra) == (theirs.msgname, theirs.crc_extra)
