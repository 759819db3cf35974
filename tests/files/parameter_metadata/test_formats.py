"""The files of firmware projects: small files of the same form, and hostile ones."""

from __future__ import annotations

import gzip
import json
import lzma
from contextlib import suppress

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.dialects import common
from mavstack.errors import MetadataError
from mavstack.files.parameter_metadata import parse_parameter_metadata, read_parameter_metadata

APM_JSON = {
    "json": {"version": 0},
    "Copter": {
        "WAY_ALT": {
            "DisplayName": "Way altitude",
            "Description": "How high\nit flies.",
            "Units": "cm",
            "Range": {"low": "-10", "high": "300.5"},
            "Increment": "10",
            "User": "Standard",
            "RebootRequired": "True",
        }
    },
    "FS_": {
        "FS_ACT": {
            "DisplayName": "Action",
            "Values": {"0": "None", "2": "Land", "x": "odd"},
            "ReadOnly": "True",
        },
        "FS_BITS": {
            "Description": "Bits",
            "Bitmask": {"0": "Roll", "31": "Yaw", "99": "odd"},
            "Range": "broken",
        },
        "HEAD": {"something": "else"},
    },
}
APM_XML = """<?xml version="1.0" encoding="utf-8"?>
<!-- generated -->
<paramfile>
  <vehicles>
    <parameters name="Copter">
      <param humanName="Way altitude" name="Copter:WAY_ALT" documentation="How high
        it flies." user="Standard">
        <field name="Units">cm</field>
        <field name="Range">-10 300.5</field>
        <field name="Increment">10</field>
        <field name="RebootRequired">True</field>
      </param>
    </parameters>
  </vehicles>
  <libraries>
    <parameters name="FS_">
      <param humanName="Action" name="FS_ACT">
        <field name="ReadOnly">True</field>
        <values><value code="0">None</value><value code="2">Land</value><value code="x">odd</value></values>
      </param>
      <param name="FS_BITS" documentation="Bits">
        <field name="Range">broken</field>
        <field name="Bitmask">0:Roll,31:Yaw,99:odd</field>
      </param>
    </parameters>
  </libraries>
</paramfile>
"""
PX4_JSON = {
    "version": 1,
    "parameters": [
        {
            "name": "WAY_ALT",
            "type": "Float",
            "group": "Way",
            "category": "Standard",
            "shortDesc": "Way altitude",
            "longDesc": "How high it flies.",
            "units": "m",
            "default": 5.5,
            "min": 0.0,
            "max": 100.0,
            "decimalPlaces": 1,
            "increment": 0.5,
            "rebootRequired": True,
            "volatile": True,
        },
        {"name": "FS_ACT", "type": "Int32", "values": [{"value": 0, "description": "None"}, {"value": 2}]},
        {"name": "FS_BITS", "type": "Int32", "bitmask": [{"index": 3, "description": "Yaw"}, "odd"]},
        {"type": "Int32"},
        7,
    ],
}
PX4_OLD_JSON = {
    "parameters": [
        {
            "name": "WAY_ALT",
            "shortDescription": "Way",
            "minValue": "0",
            "maxValue": "9.5",
            "defaultValue": "5",
        }
    ]
}
PX4_XML = """<?xml version='1.0' encoding='UTF-8'?>
<parameters>
  <version>3</version>
  <group name="Way">
    <parameter name="WAY_ALT" default="5.5" type="FLOAT" category="Standard" volatile="true">
      <short_desc>Way altitude</short_desc>
      <long_desc>How high it flies.</long_desc>
      <min>0.0</min>
      <max>100.0</max>
      <unit>m</unit>
      <decimal>1</decimal>
      <increment>0.5</increment>
      <reboot_required>true</reboot_required>
    </parameter>
    <parameter name="FS_ACT" default="0" type="INT32">
      <values><value code="0">None</value><value code="2">Land</value></values>
    </parameter>
    <parameter name="FS_BITS" default="0" type="INT32"><bitmask><bit index="3">Yaw</bit></bitmask></parameter>
    <parameter name="ON" default="0" type="INT32" boolean="true"/>
  </group>
</parameters>
"""


def parse(content: str | dict):
    text = content if isinstance(content, str) else json.dumps(content)
    return parse_parameter_metadata(text.encode(), "the file")


@pytest.mark.parametrize("content", [APM_JSON, APM_XML], ids=["json", "xml"])
def test_ardupilot(content):
    table = parse(content)
    assert set(table) == {"WAY_ALT", "FS_ACT", "FS_BITS"}
    way = table["WAY_ALT"]
    assert (way.short_description, way.long_description) == ("Way altitude", "How high it flies.")
    assert (way.unit, way.minimum, way.maximum, way.increment) == ("cm", -10, 300.5, 10)
    assert (way.reboot_required, way.group, way.category) == (True, "Copter", "Standard")
    action, bits = table["FS_ACT"], table["FS_BITS"]
    assert (action.values, action.read_only, action.group) == ({0: "None", 2: "Land"}, True, "FS_")
    assert (bits.bitmask, bits.has_range) == ({0: "Roll", 31: "Yaw"}, False)


@pytest.mark.parametrize("content", [PX4_JSON, PX4_XML], ids=["json", "xml"])
def test_px4(content):
    table = parse(content)
    assert {"WAY_ALT", "FS_ACT", "FS_BITS"} <= set(table)
    way = table["WAY_ALT"]
    assert (way.short_description, way.long_description) == ("Way altitude", "How high it flies.")
    assert (way.unit, way.minimum, way.maximum, way.increment, way.default) == ("m", 0, 100, 0.5, 5.5)
    assert (way.decimal_places, way.type) == (1, common.MavParamType.REAL32)
    assert (way.reboot_required, way.volatile, way.group, way.category) == (True, True, "Way", "Standard")
    assert set(table["FS_ACT"].values) == {0, 2}
    assert table["FS_BITS"].bitmask == {3: "Yaw"}


def test_px4_boolean():
    assert parse(PX4_XML)["ON"].values == {0: "Disabled", 1: "Enabled"}


def test_older_json_of_px4():
    way = parse(PX4_OLD_JSON)["WAY_ALT"]
    assert (way.short_description, way.minimum, way.maximum, way.default) == ("Way", 0, 9.5, 5)


def test_compressed_files(tmp_path):
    for name, data in {
        "a.gz": gzip.compress(APM_XML.encode()),
        "b.xz": lzma.compress(APM_XML.encode()),
    }.items():
        path = tmp_path / name
        path.write_bytes(data)
        table = read_parameter_metadata(path)
        assert (len(table), table.source) == (3, str(path))


@pytest.mark.parametrize(
    ("content", "problem"),
    [
        ("", "neither XML nor JSON"),
        ("RTL_ALT,1500", "neither XML nor JSON"),
        ("{}", "describes no parameter"),
        ('{"parameters": 3}', "not an array"),
        ('{"parameters": []}', "describes no parameter"),
        ("<mavlink/>", "<mavlink> is not the root"),
        ("<paramfile/>", "describes no parameter"),
        ("<paramfile>", "the file:1: not well-formed"),
        ('<!DOCTYPE x [<!ENTITY a "b">]><paramfile>&a;</paramfile>', "entity declarations are not allowed"),
        ("<a>" * 100, "nested deeper"),
    ],
)
def test_other_files_are_refused(content, problem):
    with pytest.raises(MetadataError, match=problem):
        parse(content)


def test_hostile_facts_are_left_out():
    entry = {"name": "A", "min": 10, "max": 5, "default": float("nan"), "increment": 10**400, "units": ["m"],
             "decimalPlaces": -1, "values": {"0": 1}, "bitmask": [{"index": 1.5, "description": "x"}],
             "shortDesc": "a" * 100_000, "rebootRequired": "maybe", "type": 7}  # fmt: skip
    names = [{"name": "x" * 100}, {"name": "\x1b[2J"}, {"name": ""}, {"name": None}]
    table = parse({"parameters": [entry, *names]})
    assert list(table) == ["A"]
    found = table["A"]
    assert (found.minimum, found.default, found.increment, found.unit, found.type) == (
        None,
        None,
        None,
        "",
        None,
    )
    assert (found.values, found.bitmask, found.reboot_required) == ({}, {}, False)
    assert len(found.short_description) == 10_000


TEXTS = st.text(alphabet="aA0:. -\x1b\u20ac\ud800", max_size=8)
JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | TEXTS,
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.dictionaries(
            st.sampled_from(
                ["parameters", "name", "values", "value", "bitmask", "index", "min", "Range", "low", "json"]
            )
            | st.text(max_size=5),
            inner,
            max_size=5,
        )
    ),
    max_leaves=25,
)


@given(st.dictionaries(st.sampled_from(["parameters", "json", "Copter", ""]), JSON, max_size=3))
def test_any_json_raises_only_our_error(document):
    with suppress(MetadataError):
        for entry in parse(document).values():
            entry.problem(3)
            entry.describe(3)


@given(st.data())
def test_damaged_files_raise_only_our_error(data):
    content = data.draw(
        st.sampled_from([APM_XML, PX4_XML, json.dumps(APM_JSON), json.dumps(PX4_JSON)])
    ).encode()
    packed = data.draw(st.sampled_from([content, gzip.compress(content, mtime=0), lzma.compress(content)]))
    position = data.draw(st.integers(0, len(packed)))
    damaged = (
        packed[:position]
        + data.draw(st.binary(max_size=5))
        + packed[data.draw(st.integers(0, len(packed))) :]
    )
    with suppress(MetadataError):
        parse_parameter_metadata(damaged, "the file")
