"""Payloads and packets byte by byte, valid or not."""

from __future__ import annotations

import hashlib
import struct
from dataclasses import dataclass
from string import ascii_letters, digits, punctuation
from typing import TYPE_CHECKING, Final

from mavstack.dialects.model import TYPE_SIZES
from mavstack.wire import crc16

if TYPE_CHECKING:
    from collections.abc import Callable
    from random import Random

    from mavstack.dialects.model import FieldDefinition, MessageDefinition

V1: Final = 0xFE
V2: Final = 0xFD
SIGNED: Final = 0x01
MAX_PAYLOAD: Final = 255
_CHARACTERS: Final = (ascii_letters + digits + punctuation + " ").encode()
_FORMATS: Final = {"float": "<f", "double": "<d"}
_INFINITY: Final = float("inf")
#: The numbers that decoders get wrong most often; the NaN is the quiet one of the platform.
_FLOATS: Final = (0.0, -0.0, 1.0, -1.5, _INFINITY, -_INFINITY, float("nan"))

#: Returns the bytes of one element.
if TYPE_CHECKING:
    ElementMaker = Callable[[FieldDefinition], bytes]


@dataclass(frozen=True)
class Sender:
    """The header fields of a packet, apart from its message."""

    system: int = 1
    component: int = 1
    sequence: int = 0
    flags: int = 0
    compatibility: int = 0


def payload(message: MessageDefinition, make: ElementMaker, *, version: int) -> bytes:
    """Return a complete payload; HEARTBEAT.mavlink_version is the version of the dialect."""
    parts = []
    for field in message.wire_order:
        if field.protocol_version:
            parts.append(bytes([version]))
        elif field.type == "char":
            parts.append(_text(field, make))
        else:
            parts.append(b"".join(make(field) for _ in range(max(field.array_length, 1))))
    return b"".join(parts)


def _text(field: FieldDefinition, make: ElementMaker) -> bytes:
    """Return a text of any length with zeros behind it."""
    length = max(field.array_length, 1)
    return make(field)[:length].ljust(length, b"\0")


def zeros(field: FieldDefinition) -> bytes:
    """Return the bytes of a zero."""
    return bytes(TYPE_SIZES[field.type])


def maximum(field: FieldDefinition) -> bytes:
    """Return the largest value, or a text without a terminator."""
    return _limit(field, 1)


def minimum(field: FieldDefinition) -> bytes:
    """Return the smallest value, or an empty text."""
    return _limit(field, 0)


def _limit(field: FieldDefinition, index: int) -> bytes:
    limits = field.value_range
    if limits is None:
        return b"~" * max(field.array_length, 1) * index
    if field.type in _FORMATS:
        return struct.pack(_FORMATS[field.type], limits[index])
    return int(limits[index]).to_bytes(TYPE_SIZES[field.type], "little", signed=limits[0] < 0)


def random_values(random: Random) -> ElementMaker:
    """Return a maker of random values, special ones among them."""

    def make(field: FieldDefinition) -> bytes:
        if field.type == "char":
            return bytes(random.choices(_CHARACTERS, k=random.randint(1, max(field.array_length, 1))))
        if field.type in _FORMATS:
            return _random_float(random, field.type)
        kind = random.randrange(10)
        makers = {0: zeros, 1: maximum, 2: minimum}
        return makers[kind](field) if kind in makers else random.randbytes(TYPE_SIZES[field.type])

    return make


def _random_float(random: Random, kind: str) -> bytes:
    """Return a finite number of any magnitude, or a special one."""
    if random.randrange(4) == 0:
        return struct.pack(_FORMATS[kind], random.choice(_FLOATS))
    if random.randrange(2) == 0:
        return struct.pack(_FORMATS[kind], random.uniform(-1000, 1000))
    value = random.randbytes(TYPE_SIZES[kind])
    (number,) = struct.unpack(_FORMATS[kind], value)
    return value if abs(number) < _INFINITY else bytes(TYPE_SIZES[kind])


def trimmed(data: bytes) -> bytes:
    """Return a payload without its trailing zeros; one byte stays."""
    return data.rstrip(b"\0") or data[:1]


def packet_v1(number: int, extra: int, data: bytes, sender: Sender) -> bytes:
    """Return a MAVLink 1 packet with any payload."""
    body = bytes([len(data), sender.sequence, sender.system, sender.component, number]) + data
    return bytes([V1]) + body + _checksum(body, extra)


def packet_v2(number: int, extra: int, data: bytes, sender: Sender) -> bytes:
    """Return a MAVLink 2 packet with any payload, without its signature."""
    head = [len(data), sender.flags, sender.compatibility, sender.sequence, sender.system, sender.component]
    body = bytes(head) + number.to_bytes(3, "little") + data
    return bytes([V2]) + body + _checksum(body, extra)


def _checksum(body: bytes, extra: int) -> bytes:
    return crc16(bytes([extra]), crc16(body)).to_bytes(2, "little")


def signature(key: bytes, packet: bytes, link_id: int, timestamp: int) -> bytes:
    """Return the 13 bytes of the signature of a packet."""
    head = bytes([link_id]) + timestamp.to_bytes(6, "little")
    return head + hashlib.sha256(key + packet + head).digest()[:6]
