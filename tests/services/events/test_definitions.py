from __future__ import annotations

import json
import lzma
import struct
from random import Random

import pytest

from mavstack.errors import MetadataError
from mavstack.services.events import EventContent, decode_content, parse_event_metadata

ENUM = {
    "type": "uint8_t",
    "entries": {"1": {"name": "hot", "description": "too hot"}, "2": {"name": "wet", "description": ""}},
}
ARGUMENTS = [{"name": "cause", "type": "cause_t"}, {"name": "height", "type": "float"}]
EVENT = {"name": "stopped", "message": "Stopped: {1} at {2:.1m_v}", "arguments": ARGUMENTS}


def document(event=EVENT, enum=ENUM) -> bytes:
    component = {
        "namespace": "sample",
        "enums": {"cause_t": enum},
        "event_groups": {"default": {"events": {"5": event}}},
    }
    return json.dumps({"version": 2, "components": {"1": component}}).encode()


def decoded(event, arguments: bytes = b"", enum=ENUM) -> EventContent:
    return decode_content(parse_event_metadata(document(event, enum))[0x01000005], arguments)


def test_arguments_are_decoded_and_put_into_the_message():
    found = decoded(EVENT, struct.pack("<Bf", 1, 2.25).ljust(40, b"\0"))
    assert (found.name, found.message) == ("sample::stopped", "Stopped: too hot at 2.2 m")
    assert found.arguments == {"cause": "hot", "height": 2.25}


def test_version_1_and_compressed_files_are_read():
    entries = [{"value": int(value), **entry} for value, entry in ENUM["entries"].items()]
    component = {
        "component_id": 1,
        "namespace": "sample",
        "enums": [{"name": "cause_t", "type": "uint8_t", "entries": entries}],
        "event_groups": [{"name": "default", "events": [{"sub_id": 5, **EVENT}]}],
    }
    data = json.dumps({"version": 1, "components": [component]}).encode()
    assert parse_event_metadata(lzma.compress(data)) == parse_event_metadata(document())


def test_values_without_a_name_and_bitfields():
    assert decoded(EVENT, b"\x09").arguments["cause"] == "9"
    assert decoded(EVENT, b"\x02").message == "Stopped: wet at 0.0 m"
    bits = {**ENUM, "is_bitfield": True}
    assert decoded(EVENT, b"\x03", bits).arguments["cause"] == "hot|wet"
    assert decoded(EVENT, b"\x13", bits).arguments["cause"] == "hot|wet|16"
    assert decoded(EVENT, b"\x00", bits).arguments["cause"] == "0"
    assert decoded(EVENT, b"\x03", {**bits, "separator": " and "}).message.startswith(
        "Stopped: too hot and wet"
    )


@pytest.mark.parametrize(
    ("message", "text"),
    [
        (r"\{1\} and \<a\>", "{1} and <a>"),
        ("set <param>MY_PARAM</param>", "set MY_PARAM"),
        ('see <a href="https://example.org">here</a>', "see here"),
        ('a<profile name="dev"> b</profile><profile name="!dev"> c</profile>', "a c"),
        ("{7} {0} {99999999999999999999}", "{7} {0} {99999999999999999999}"),
        ("{2:.99}", "0.000000000"),
        ("{2:C}", "0 °C"),
        ("{2m/s} {2:.1m^2} {2feet}", "0 m/s 0.0 m^2 {2feet}"),
        ("a<b>not for you</b> <i>{1}</i>c ", "a c"),
        ("1 < 2", "1 < 2"),
    ],
)
def test_texts_are_formatted(message, text):
    assert decoded({**EVENT, "message": message}).message == text


@pytest.mark.parametrize(
    "event",
    [
        {**EVENT, "arguments": [{"name": "a", "type": "unknown_t"}]},
        {**EVENT, "arguments": "none"},
        {**EVENT, "arguments": ["none"]},
        {**EVENT, "name": 5},
        "none",
    ],
)
def test_invalid_events_are_left_out(event):
    assert parse_event_metadata(document(event)) == {}


@pytest.mark.parametrize("data", [b"", b"[]", b"{}", b'{"components": 5}', b"\xfd7zXZ\0damaged"])
def test_other_files_are_refused(data):
    with pytest.raises(MetadataError):
        parse_event_metadata(data)


def test_damaged_files_raise_nothing_else():
    random, whole = Random(1), document()
    for _ in range(500):
        data = bytearray(whole)
        for _ in range(random.randint(1, 4)):
            data[random.randrange(len(data))] = random.randrange(256)
        try:
            table = parse_event_metadata(bytes(data))
        except MetadataError:
            continue
        for definition in table.values():
            decode_content(definition, random.randbytes(random.randint(0, 40)))
