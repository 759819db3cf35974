"""Translations of metadata: summaries, TS files and rules, valid, damaged and hostile."""

from __future__ import annotations

import json
import lzma
import subprocess
import sys
from contextlib import suppress

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.dialects import common
from mavstack.errors import MetadataError
from mavstack.services.component_metadata import (
    GENERAL_NAME,
    PARAMETER_RULES,
    ServedMetadata,
    find_locale,
    parse_general,
    parse_translations,
    translate_content,
    unpack_content,
)
from mavstack.services.component_metadata.translation import to_ts

PARAMETER = common.CompMetadataType.PARAMETER
#: As the tools of PX4 and QGroundControl write it.
TS = b"""<?xml version="1.0" encoding="utf-8"?>
<!DOCTYPE TS>
<TS version="2.1" language="de_DE" sourcelanguage="en">
  <context>
    <name>/parameters/P_07/shortDesc</name>
    <message><location filename="p.json"/>
      <source>Height</source><translation>H\xc3\xb6he</translation>
    </message>
  </context>
  <context>
    <name>/parameters/P_08/shortDesc</name>
    <message><source>Speed</source><translation type="unfinished"></translation></message>
  </context>
</TS>
"""


def test_the_locale_of_a_summary():
    summary = json.dumps(
        {"de_AT": {"url": "a"}, "de_DE": {"url": "b"}, "fr_FR": {"url": 3}, "de": 7}
    ).encode()
    found = {
        name: find_locale(summary, name) for name in ("de_DE", "de-DE", "de_DE.UTF-8", "de", "de_CH", "d")
    }
    assert found == {"de_DE": "b", "de-DE": "b", "de_DE.UTF-8": "b", "de": "a", "de_CH": "a", "d": None}
    assert find_locale(lzma.compress(summary), "fr_FR") is None


def test_a_ts_file():
    assert parse_translations(TS) == {"/parameters/P_07/shortDesc": "Höhe"}
    assert parse_translations(lzma.compress(TS)) == parse_translations(TS)
    texts = {"/a/<b>": "x & y", "$globals/group/A": "ä"}
    assert parse_translations(to_ts(texts, "de_DE")) == texts


@pytest.mark.parametrize(
    "data",
    [b"", b"{}", b"<ts/>", TS.replace(b"<!DOCTYPE TS>", b'<!DOCTYPE TS [<!ENTITY a "b">]>'), TS[:-9]],
)
def test_other_files_are_refused(data):
    with pytest.raises(MetadataError):
        parse_translations(data)


def translated(document: dict, rules: dict, texts: dict[str, str]) -> dict:
    found = json.loads(translate_content(json.dumps({**document, "translation": rules}).encode(), texts))
    del found["translation"]
    return found


def test_parameters():
    entry = {"name": "P", "shortDesc": "a", "longDesc": "b", "group": "g", "units": "m"}
    entry["values"] = [{"value": 0, "description": "off"}, {"value": 1, "description": "on"}]
    texts = {
        "/parameters/P/shortDesc": "A", "$globals/group/g": "G", "/parameters/P/values/1/description": "ON",
        "/parameters/P/units": "never", "/parameters/Q/longDesc": "another one",
    }  # fmt: skip
    found = translated({"parameters": [entry]}, PARAMETER_RULES, texts)["parameters"][0]
    values = [{"value": 0, "description": "off"}, {"value": 1, "description": "ON"}]
    assert found == {**entry, "shortDesc": "A", "group": "G", "values": values}


def test_references_wildcards_indexes_and_lists_of_texts():
    document = {
        "components": {"a": {"name": "x", "sub": {"c": {"name": "y"}}}},
        "list": [{"words": ["p", "q", 7]}],
    }
    rules = {
        "items": {
            "components": {"items": {"*": {"$ref": "#/$defs/part"}}},
            "list": {"list": {"translate": ["words"]}},
        },
        "$defs": {
            "part": {"translate": ["name"], "items": {"sub": {"items": {"*": {"$ref": "#/$defs/part"}}}}}
        },
    }
    texts = {"/components/a/name": "X", "/components/a/sub/c/name": "Y", "/list/0/words/1": "Q"}
    assert translated(document, rules, texts) == {
        "components": {"a": {"name": "X", "sub": {"c": {"name": "Y"}}}}, "list": [{"words": ["p", "Q", 7]}]
    }  # fmt: skip


def test_a_file_without_rules_stays_as_it_is():
    assert translate_content(b'{"parameters": []}', {"/a": "b"}) == b'{"parameters": []}'


def test_references_without_an_end():
    rules = {"items": {"a": {"$ref": "#/$defs/x"}}, "$defs": {"x": {"$ref": "#/$defs/x"}}}
    with pytest.raises(MetadataError, match="nested too deeply"):
        translated({"a": {}}, rules, {})


def test_served_files():
    texts = {"/parameters/P/shortDesc": "Höhe"}
    content = json.dumps(
        {"parameters": [{"name": "P", "shortDesc": "Height"}], "translation": PARAMETER_RULES}
    )
    served = ServedMetadata("etc", {PARAMETER: ("p.json", content.encode())}, {PARAMETER: {"de_DE": texts}})
    file = parse_general(unpack_content(served.files[f"etc/{GENERAL_NAME}.xz"]))[PARAMETER]
    assert file.translation_sources == ("mftp://etc/p_summary.json.xz",)
    uri = find_locale(served.files["etc/p_summary.json.xz"], "de_DE")
    assert uri == "mftp://etc/p_de_DE.ts.xz"
    assert parse_translations(served.files["etc/p_de_DE.ts.xz"]) == texts


JSON = st.recursive(
    st.none() | st.integers() | st.text(max_size=3),
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(
            st.sampled_from(["items", "list", "translate", "$ref", "*", "a", "key"]), inner, max_size=4
        )
    ),
    max_leaves=20,
)


@given(
    document=st.dictionaries(st.sampled_from(["a", "items"]), JSON), rules=JSON, data=st.binary(max_size=60)
)
def test_any_rules_and_any_bytes(document, rules, data):
    with suppress(MetadataError):
        translate_content(json.dumps({**document, "translation": rules}).encode(), {"/a": "b"})
    for read in (parse_translations, lambda data: find_locale(data, "de")):
        with suppress(MetadataError):
            read(data)


def test_rules_that_reach_values_in_too_many_ways():
    value = [0] * 50
    for _ in range(14):
        value = {"x": value}
    again = {"$ref": "#/$defs/all"}
    rules = {**again, "$defs": {"all": {"items": {"x": again, "*": again}, "list": {}}}}
    with pytest.raises(MetadataError, match="nested too deeply"):
        translated({"x": value}, rules, {})


def test_programs_with_a_vehicle_import_no_client_of_http():
    program = "import sys\nimport mavstack.vehicle\nprint(' '.join(sys.modules))"
    done = subprocess.run([sys.executable, "-c", program], check=True, capture_output=True, text=True)
    assert {"http.client", "urllib.request", "fractions"}.isdisjoint(done.stdout.split())
