from __future__ import annotations

import pytest

from mavstack.codegen import make_library
from mavstack.codegen.identifiers import (
    camel_field,
    distinct,
    enum_members,
    package_part,
    pascal_field,
    type_names,
)
from mavstack.dialects import Dialect


def test_members_lose_the_words_of_the_file_that_first_defines_the_enum(tmp_path):
    (tmp_path / "base.xml").write_text(
        '<mavlink><enums><enum name="MAV_KIND"><entry name="MAV_KIND_A" value="1"/>'
        '<entry name="MAV_KIND_2B" value="2"/></enum></enums><messages><message id="1" name="M">'
        '<field type="uint8_t" name="f">x</field></message></messages></mavlink>'
    )
    (tmp_path / "own.xml").write_text(
        '<mavlink><include>base.xml</include><enums><enum name="MAV_KIND">'
        '<entry name="MAV_KIND_ENTRIES" value="3"/><entry name="OTHER" value="4"/></enum></enums></mavlink>'
    )
    library = make_library(Dialect.from_xml(tmp_path / "own.xml"))
    assert enum_members(library, {"ENTRIES"})["MAV_KIND"] == {
        "MAV_KIND_A": "A",
        "MAV_KIND_2B": "_2B",
        "MAV_KIND_ENTRIES": "ENTRIES_",
        "OTHER": "OTHER",
    }


def test_no_name_is_reserved_or_there_twice():
    assert distinct(["a", "b", "a", "a_", "b"], {"b"}) == ["a", "b_", "a_", "a__", "b__"]
    assert type_names(["FOO_BAR", "FOO__BAR", "STRING"], {"String"}) == {
        "FOO_BAR": "FooBar",
        "FOO__BAR": "FooBar_",
        "STRING": "String_",
    }


@pytest.mark.parametrize(
    ("name", "pascal", "camel"),
    [
        ("time_boot_ms", "TimeBootMs", "timeBootMs"),
        ("Vcc", "Vcc", "vcc"),
        ("ICAO_address", "IcaoAddress", "icaoAddress"),
        ("_", "_", "_"),
        ("_1", "_1", "_1"),
        ("aB", "AB", "aB"),
    ],
)
def test_fields_in_upper_and_lower_camel_case(name, pascal, camel):
    assert (pascal_field(name), camel_field(name)) == (pascal, camel)


@pytest.mark.parametrize(
    ("name", "part"),
    [("My-Drone", "my_drone"), ("3dr", "dialect_3dr"), ("<text>", "text"), ("...", "dialect")],
)
def test_names_of_files_in_packages(name, part):
    assert package_part(name) == part
