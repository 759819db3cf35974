"""Every message of every official dialect, compared with pymavlink byte for byte and field for field.

pymavlink's generator runs on our definition files, once per wire version: a MAVLink 2 module that is forced
to version 1 sends the extensions too (`test_forced_version_1_of_pymavlink_sends_extensions`), which no
version 1 receiver expects. Its MAVLink 1 modules follow the specification, and lack ids above 255.
"""

from __future__ import annotations

import copy
import math
import pickle
import random
from typing import TYPE_CHECKING, Any

import pytest

import mavstack
from mavstack.dialects import Dialect, common
from mavstack.dialects.tables import official_names
from mavstack.errors import EncodeError

from . import peers
from .values import CASES, comparable, field_values, random_message, text_of

if TYPE_CHECKING:
    from pathlib import Path
    from types import ModuleType

SEQUENCE = 201


def _link(module: ModuleType) -> Any:
    link = peers.link(module, system=250, component=3)
    link.seq = SEQUENCE
    return link


def _assert_fields_equal(message: Any, theirs: Any, values: dict[Any, Any]) -> None:
    for field, value in values.items():
        ours, decoded = getattr(message, field.name), peers.raw_value(theirs, field)
        if field.type == "char":
            assert ours == text_of(value) == text_of(decoded), field
        else:
            assert (
                comparable(ours, field.type)
                == comparable(value, field.type)
                == comparable(decoded, field.type)
            ), field


def _exchange(dialect: Dialect, module: ModuleType, version: int) -> int:
    """Send every message with every set of values in both directions; return the number of messages."""
    parser = mavstack.Parser(dialect)
    compared = 0
    for message_class in dialect:
        definition = message_class.definition
        if definition.id not in module.mavlink_map:
            continue
        compared += 1
        fields = [field for field in definition.fields if version == 2 or not field.extension]
        for case in CASES if definition.origin == dialect.name else ("random",):
            all_values = field_values(message_class, case, dialect.name)
            ours = mavstack.encode(
                message_class(**all_values), system=250, component=3, sequence=SEQUENCE, version=version
            )
            values = {field: all_values[field.name] for field in fields}
            theirs = peers.message(module, definition.id, values).pack(_link(module))
            assert ours == theirs, (definition.name, case)
            (read,) = _link(module).parse_buffer(ours)
            (packet,) = parser.feed(theirs)
            assert packet.raw == theirs
            assert (packet.version, packet.system, packet.component, packet.sequence) == (
                version,
                250,
                3,
                SEQUENCE,
            )
            assert packet.name == read.get_type() == definition.name
            assert type(packet.message) is message_class
            _assert_fields_equal(packet.message, read, values)
    assert parser.statistics.bad_bytes == 0
    return compared


# "all" has the messages of all others.
@pytest.mark.fast_cases(2)
@pytest.mark.parametrize("version", [1, 2])
@pytest.mark.parametrize("name", sorted(official_names(), key=lambda name: name != "all"))
def test_every_message_in_both_directions(name: str, version: int, tmp_path: Path) -> None:
    """CRC_EXTRA and length of all messages, then bytes and fields of each with every set of values."""
    dialect, module = Dialect.load(name), peers.generate(name, f"{version}.0", tmp_path)
    definitions = [message.definition for message in dialect if version == 2 or message.definition.id < 256]
    ours = {
        item.id: (item.name, item.crc_extra, item.length if version == 2 else item.base_length)
        for item in definitions
    }
    theirs = {
        number: (peer.msgname, peer.crc_extra, peer.unpacker.size)
        for number, peer in module.mavlink_map.items()
    }
    assert ours == theirs
    assert _exchange(dialect, module, version) == len(definitions)


@pytest.mark.parametrize("name", official_names())
def test_version_1_refuses_every_id_above_255(name: str) -> None:
    for message_class in Dialect.load(name):
        if message_class.definition.id > 255:
            with pytest.raises(EncodeError, match="over 255"):
                mavstack.encode(message_class(), system=1, component=1, version=1)


def test_every_message_survives_python_conversions() -> None:
    """Text, dictionary, JSON, copy and pickle of a message preserve its payload."""
    for message_class in Dialect.load("all"):
        message = random_message(message_class)
        assert message_class.from_payload(message.to_payload()) == message
        assert copy.copy(message) == message
        assert pickle.loads(pickle.dumps(message)) == message
        assert message.replace() == message
        assert repr(message).startswith(f"{message_class.__name__}(")
        values = message.to_dict(enums="value", secrets=True)
        # A text truncated inside a character reads shorter than it is: see test_pitfalls.
        values |= {field.name: "x" for field in message_class.definition.fields if field.type == "char"}
        again = message_class.from_json(message_class.from_dict(values).to_json(secrets=True))
        fields = again.to_dict(enums="value", secrets=True)
        for field in message_class.definition.fields:
            assert _exact(fields[field.name], field.type) == _exact(values[field.name], field.type), field


def _exact(value: Any, kind: str) -> Any:
    """Convert a value to a form for which `==` compares all bits, except the payload of a NaN."""
    if isinstance(value, float):
        return comparable(math.nan if math.isnan(value) else value, kind)
    return [_exact(element, kind) for element in value] if isinstance(value, tuple) else value


def test_forced_version_1_of_pymavlink_sends_extensions(tmp_path: Path) -> None:
    """Packets of pymavlink are longer than the specification allows; our parser accepts them."""
    module = peers.generate("common", "2.0", tmp_path)
    fields = common.Statustext.definition.fields
    values = dict(zip(fields, (4, b"chunked", 5, 1), strict=True))
    theirs = peers.message(module, 253, values).pack(_link(module), force_mavlink1=True)
    ours = mavstack.encode(
        common.Statustext(4, "chunked", 5, 1), system=250, component=3, sequence=SEQUENCE, version=1
    )
    assert len(theirs) == len(ours) + 3
    assert ours[:1] + ours[2:6] == theirs[:1] + theirs[2:6]
    assert ours[6:-2] == theirs[6:-5]
    (packet,) = mavstack.Parser(common).feed(theirs)
    assert packet.raw == theirs
    assert packet.message.text == "chunked"


def test_the_definitions_of_pymavlink_agree() -> None:
    """Its copy of the official definitions is older, so that the last fields may be missing."""
    from pymavlink.dialects.v20 import all as shipped

    # Id 53 was removed from the official definitions.
    known = {number: peer for number, peer in shipped.mavlink_map.items() if number != 53}
    dialect = Dialect.load("all")
    for number, peer in known.items():
        ours = dialect[number].definition
        assert (ours.name, ours.crc_extra) == (peer.msgname, peer.crc_extra)
        assert ours.length >= peer.unpacker.size
        assert [field.name for field in ours.fields][: len(peer.fieldnames)] == peer.fieldnames
    assert len(known) > 340


def _damaged_stream(rng: random.Random) -> bytes:
    stream = bytearray()
    encoders = {version: mavstack.Encoder(1, version, version=version) for version in (1, 2)}
    classes = [item for item in Dialect.load("common") if item.definition.id < 256]
    for number in range(80):
        stream += encoders[rng.choice((1, 2))].encode(random_message(rng.choice(classes), "random", number))
    for _ in range(30):
        position = rng.randrange(len(stream))
        choice = rng.randrange(4)
        if choice == 0:
            stream[position] ^= 1 << rng.randrange(8)
        elif choice == 1:
            del stream[position : position + rng.randrange(12)]
        elif choice == 2:
            stream[position:position] = rng.randbytes(rng.randrange(12))
        else:
            stream[position:position] = bytes([rng.choice((0xFD, 0xFE)), rng.randrange(256)])
    return bytes(stream)


def test_all_messages_that_pymavlink_finds_in_damaged_streams_are_found() -> None:
    from pymavlink.dialects.v20 import common as peer

    rng, additional = random.Random(11), 0
    for _ in range(25):
        stream = _damaged_stream(rng)
        link = peers.link(peer)
        link.robust_parsing = True
        found = [item for item in link.parse_buffer(stream) or [] if item.get_msgId() in peer.mavlink_map]
        theirs = {bytes(item.get_msgbuf()) for item in found if item.get_type() != "BAD_DATA"}
        parser = mavstack.Parser(common)
        ours = {packet.raw for packet in parser.feed(stream) + parser.flush()}
        assert theirs <= ours
        additional += len(ours) - len(theirs)
    assert additional > 0
