from __future__ import annotations

import pytest

from mavstack.codegen import make_library
from mavstack.codegen.message_facts import (
    EnumNumber,
    enum_numbers,
    field_description,
    message_facts,
    table_row,
)
from mavstack.codegen.templates import one_line
from mavstack.dialects import Dialect
from mavstack.dialects.model import FieldDefinition


def library(values: list[int], kind: str = "uint8_t"):
    entries = "".join(f'<entry name="E_{index}" value="{value}"/>' for index, value in enumerate(values))
    return make_library(
        Dialect.from_xml(
            f'<mavlink><enums><enum name="E">{entries}</enum></enums><messages><message id="1" name="M">'
            f'<field type="{kind}" name="f" enum="E" units="m">x</field></message></messages></mavlink>'
        )
    )


@pytest.mark.parametrize(
    ("values", "kind", "number"),
    [
        ([0, 255], "uint8_t", EnumNumber(signed=False, bits=8)),
        ([0, 256], "uint8_t", EnumNumber(signed=False, bits=16)),
        ([0, 1], "uint32_t", EnumNumber(signed=False, bits=32)),
        ([-128, 127], "uint8_t", EnumNumber(signed=True, bits=16)),
        ([-1, 128], "int8_t", EnumNumber(signed=True, bits=16)),
        ([-129], "int8_t", EnumNumber(signed=True, bits=16)),
        ([0, 1], "int8_t", EnumNumber(signed=True, bits=8)),
        ([0, 255], "int8_t", EnumNumber(signed=True, bits=16)),
        ([0, 1], "int32_t", EnumNumber(signed=True, bits=32)),
        ([2**64 - 1], "uint8_t", EnumNumber(signed=False, bits=64)),
        ([-(2**63)], "uint8_t", EnumNumber(signed=True, bits=64)),
    ],
)
def test_an_enum_is_as_wide_as_its_field_and_its_values(values, kind, number):
    assert enum_numbers(library(values, kind)) == {"E": number}


def test_an_enum_that_no_field_has_takes_32_bits():
    found = enum_numbers(make_library(Dialect.from_xml(
        '<mavlink><enums><enum name="E"><entry name="E_A" value="1"/></enum></enums><messages>'
        '<message id="1" name="M"><field type="uint8_t" name="f">x</field></message></messages></mavlink>'
    )))  # fmt: skip
    assert found == {"E": EnumNumber(signed=False, bits=32)}


def test_facts_of_a_message():
    message = next(
        item for item in make_library(Dialect.load("minimal")).messages if item.name == "HEARTBEAT"
    )
    assert message_facts(message) == {
        "name": "HEARTBEAT", "id": 0, "length": 9, "base_length": 9, "crc_extra": 50
    }  # fmt: skip
    assert table_row(message) == "0, 0x1320909,"
    battery = make_library(Dialect.load("common"), only=["BATTERY_STATUS"]).messages[0]
    assert table_row(battery) == "147, 0x19A2436,"


@pytest.mark.parametrize(
    ("field", "text"),
    [
        (FieldDefinition("f", "uint8_t"), "`uint8_t`."),
        (
            FieldDefinition("f", "float", 3, units="m/*", multiplier="1E-2", invalid="`NaN", extension=True),
            "`float[3]`, in m/ *, times 1E-2, `'NaN` if unknown, extension.",
        ),
        (FieldDefinition("f", "char", description="Name.", units="m"), "Name. (`char`, in m)"),
    ],
)
def test_the_description_of_a_field_has_its_facts(field, text):
    assert field_description(field, one_line) == text
