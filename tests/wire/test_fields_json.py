"""JSON written from bytes is the text that Python makes of the same fields."""

from __future__ import annotations

import json
import random
import struct
from typing import TYPE_CHECKING, Any

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from mavstack.dialects import Dialect, common
from mavstack.dialects.message import _jsonable
from mavstack.server.json_values import to_json
from mavstack.wire import Parser, encode, fields_json

if TYPE_CHECKING:
    from mavstack.dialects import Message

ALL = Dialect.load("all")
OWN = """<mavlink><messages><message id="54000" name="OWN"><description>.</description>
<field type="uint8_t" name="class">a reserved word</field><field type="float" name="secret_key">.</field>
<field type="char[4]" name="text">.</field><extensions/><field type="double[2]" name="definition">.</field>
</message></messages></mavlink>"""


def spaced(message: Message) -> str:
    """Return the text with spaces, made by Python."""
    types = {row[0]: row[1] for row in message.__mavlink_row__[5]}
    fields = message.to_dict(enums="value")
    return json.dumps({name: _jsonable(value, types[name]) for name, value in fields.items()})


def strict(message: Message, *, escaped: bool = True) -> str:
    """Return the text without spaces, made by Python."""
    values = to_json(message.to_dict(enums="value"))
    return json.dumps(values, separators=(",", ":"), ensure_ascii=escaped, allow_nan=False)


def check(message: Message) -> None:
    assert fields_json(message) == message.to_json() == spaced(message)
    assert fields_json(message, strict=True) == strict(message)
    assert fields_json(message, strict=True, ascii=False) == strict(message, escaped=False)


def payload(rng: random.Random, length: int) -> bytes:
    """Return random bytes with many zeros, ones and printable characters, for texts, NaN and large values."""
    choices = (0, 255, 127, rng.randrange(32, 127))
    return bytes(rng.choice((*choices, rng.randrange(256))) for _ in range(length))


@pytest.mark.parametrize("message_class", list(ALL), ids=lambda item: item.__name__)
def test_messages_of_all_dialects_have_the_text_of_python(message_class):
    rng = random.Random(message_class.__name__)
    length = message_class.__mavlink_row__[4]
    check(message_class.from_payload(b""))
    check(message_class.from_payload(b"\xff" * length))
    for _ in range(5):
        check(message_class.from_payload(payload(rng, rng.randrange(length + 3))))


@given(st.lists(st.one_of(st.floats(width=32), st.integers(0, 2**32 - 1)), min_size=4, max_size=4))
@example([1e16, 1e-5, 3.4028234663852886e38, 0.00010347366333007812])
@example([1, 2, 0x7F800001, 0xFF800000])
def test_floats_have_the_digits_of_python(values):
    fields = b"".join(struct.pack("<I" if isinstance(value, int) else "<f", value) for value in values)
    check(common.AttitudeTarget.from_payload(b"\0" * 4 + fields))


@given(st.lists(st.floats(), min_size=2, max_size=2), st.binary(max_size=5))
def test_doubles_texts_and_names_of_own_dialects(doubles, text):
    own = Dialect.from_xml(OWN)
    message = own["OWN"].from_payload(struct.pack("<fB4s2d", 1.5, 7, text, *doubles))
    check(message)
    fields = json.loads(fields_json(message))
    assert fields["class"] == 7
    assert fields["secret_key"] != 1.5


def test_packets_have_the_text_of_their_message():
    text = common.Statustext(text="Höhe\n\U0001f681", severity=3)
    parser = Parser(common)
    for version in (1, 2):
        packet = parser.feed(encode(text, system=1, component=1, version=version))[0]
        check(packet.message)
        assert fields_json(packet) == packet.message.to_json()
    longer = bytearray(encode(common.SystemTime(time_unix_usec=2**64 - 1), system=1, component=1))
    assert json.loads(fields_json(parser.feed(longer)[0]))["time_unix_usec"] == 2**64 - 1


def test_a_packet_without_definition_has_no_fields():
    packet = Parser(Dialect.load("minimal")).feed(encode(common.Attitude(), system=1, component=1))[0]
    assert fields_json(packet) is None


def test_other_objects_are_refused():
    item: Any = "text"
    with pytest.raises(TypeError, match="expected a MAVLink message"):
        fields_json(item)
