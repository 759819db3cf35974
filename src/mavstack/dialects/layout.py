"""The order of fields on the wire, and the CRC_EXTRA of a message.

Base fields are sorted by element size, largest first, and fields of equal size keep the order of the
definition; extension fields follow in the order of the definition. CRC_EXTRA is a CRC-16/MCRF4XX over `NAME `
and, for each base field in wire order, `type name ` and the length of an array as one byte, folded to eight
bits. Extensions are excluded, so that peers with and without them can communicate.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavstack._core import crc16
from mavstack.dialects.model import TYPE_SIZES, FieldDefinition

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

MAX_PAYLOAD = 255
MAX_FIELDS = 64
MAX_MESSAGE_ID = 0xFFFFFF


def wire_order(fields: Sequence[FieldDefinition]) -> list[FieldDefinition]:
    """Return the fields in the order of the payload."""
    base = [item for item in fields if not item.extension]
    extensions = [item for item in fields if item.extension]
    return sorted(base, key=lambda item: -TYPE_SIZES[item.type]) + extensions


def assign_offsets(fields: Sequence[FieldDefinition]) -> tuple[FieldDefinition, ...]:
    """Return the fields in their given order, with their payload offsets."""
    offsets = {}
    position = 0
    for item in wire_order(fields):
        offsets[item.name] = position
        position += item.size
    return tuple([item._replace(offset=offsets[item.name]) for item in fields])


def lengths(fields: Iterable[FieldDefinition]) -> tuple[int, int]:
    """Return the payload length without and with extensions, in bytes."""
    base = total = 0
    for item in fields:
        size = item.size
        total += size
        base += 0 if item.extension else size
    return base, total


def crc_extra(name: str, fields: Sequence[FieldDefinition]) -> int:
    """Return the CRC_EXTRA of a message, which sender and receiver add to the checksum."""
    parts = [f"{name} ".encode()]
    for item in wire_order([item for item in fields if not item.extension]):
        parts.append(f"{item.type} {item.name} ".encode())
        if item.array_length:
            parts.append(bytes([item.array_length]))
    crc = crc16(b"".join(parts))
    return (crc & 0xFF) ^ (crc >> 8)
