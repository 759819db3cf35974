"""Conversion between definitions and table lines, without loss.

The row of a message is `[id, name, CRC_EXTRA, base length, length, fields]` with `[name, type, array length,
offset, enum]` for each field, in the order of the definition. Its metadata is `[message metadata,
{field: metadata}]`. Metadata objects have only those attributes that differ from their default, so that a
line stays short and a change is one changed line. A field at or after the base length is an extension.
"""

from __future__ import annotations

import json
from operator import attrgetter
from typing import TYPE_CHECKING, Any, NamedTuple

from mavstack.dialects.model import (
    DialectDefinition,
    EnumDefinition,
    EnumEntry,
    EnumParam,
    FieldDefinition,
    MessageDefinition,
    Replacement,
)
from mavstack.dialects.tables import MessageRow, Table

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

_encode = json.JSONEncoder(ensure_ascii=False, separators=(",", ":")).encode


class _Attributes:
    """The attributes of a class in its metadata: all but those in the row."""

    def __init__(self, definition_class: type[NamedTuple], *in_row: str) -> None:
        self.names = tuple(name for name in definition_class._fields if name not in in_row)
        self.defaults = tuple(definition_class._field_defaults.get(name) for name in self.names)
        self.values: Callable[[object], tuple[object, ...]] = attrgetter(*self.names)


_MESSAGE = _Attributes(
    MessageDefinition, "id", "name", "fields", "crc_extra", "base_length", "length", "origin", "line"
)
_FIELD = _Attributes(FieldDefinition, "name", "type", "array_length", "offset", "enum", "extension", "line")
_ENUM = _Attributes(EnumDefinition, "name", "entries", "line")
_ENTRY = _Attributes(EnumEntry, "name", "value", "line")
_PARAM, _REPLACEMENT = _Attributes(EnumParam), _Attributes(Replacement)


def _metadata(value: object, attributes: _Attributes) -> dict[str, Any]:
    """Return the attributes of a definition that differ from their default."""
    values = attributes.values(value)
    if values == attributes.defaults:
        return {}
    items = zip(attributes.names, values, attributes.defaults, strict=True)
    return {name: _plain(content) for name, content, default in items if content != default}


def _plain(content: object) -> object:
    if isinstance(content, Replacement):
        return _metadata(content, _REPLACEMENT)
    return [_metadata(param, _PARAM) for param in content] if isinstance(content, tuple) else content


def _restore(metadata: dict[str, Any]) -> dict[str, Any]:
    """Return the metadata from which `_metadata` was made: with objects."""
    for mark in ("deprecated", "superseded"):
        if mark in metadata:
            metadata[mark] = Replacement(**metadata[mark])
    if "params" in metadata:
        metadata["params"] = tuple([EnumParam(**param) for param in metadata["params"]])
    return metadata


def _line(*values: object) -> str:
    return "\t".join(map(_encode, values))


def message_row(message: MessageDefinition) -> MessageRow:
    """Return the row of a message: the part that every program needs."""
    rows = [[item.name, item.type, item.array_length, item.offset, item.enum] for item in message.fields]
    return [message.id, message.name, message.crc_extra, message.base_length, message.length, rows]


def table_lines(definition: DialectDefinition) -> Iterator[str]:
    """Yield the lines of the table of one definition file."""
    header = {
        "name": definition.name,
        "version": definition.version,
        "number": definition.number,
        "includes": definition.includes,
        "messages": len(definition.messages),
    }
    yield _line(header)
    for message in definition.messages:
        field_metadata = {item.name: _metadata(item, _FIELD) for item in message.fields}
        kept = {name: metadata for name, metadata in field_metadata.items() if metadata}
        yield _line(message_row(message), [_metadata(message, _MESSAGE), kept])
    for enum in definition.enums:
        entries = [[entry.value, entry.name, _metadata(entry, _ENTRY)] for entry in enum.entries]
        yield f"{enum.name}\t{_line([_metadata(enum, _ENUM), entries])}"


def encode_table(definition: DialectDefinition) -> Table:
    """Return the table of one definition file."""
    lines = tuple(table_lines(definition))
    return Table(lambda: lines, definition.path)


def decode_message(row: MessageRow, table: Table) -> MessageDefinition:
    """Return the definition of a message in a table."""
    number, name, crc_extra, base_length, length, field_rows = row
    metadata, field_metadata = table.message_metadata(name)
    fields_ = [
        FieldDefinition(
            field_name,
            kind,
            array_length,
            enum,
            offset=offset,
            extension=offset >= base_length,
            **field_metadata.get(field_name, {}),
        )
        for field_name, kind, array_length, offset, enum in field_rows
    ]
    return MessageDefinition(
        number, name, tuple(fields_), crc_extra, base_length, length, origin=table.name, **_restore(metadata)
    )


def decode_enum(name: str, table: Table) -> EnumDefinition:
    """Return the definition of an enum in a table, with the entries of this file only."""
    metadata, entry_rows = table.enum_row(name)
    entries = [EnumEntry(entry, value, **_restore(more)) for value, entry, more in entry_rows]
    return EnumDefinition(name, tuple(entries), **_restore(metadata))


def decode_table(table: Table) -> DialectDefinition:
    """Return the definition from which a table was made."""
    return DialectDefinition(
        name=table.name,
        version=table.header["version"],
        number=table.header["number"],
        includes=table.includes,
        messages=tuple(decode_message(row, table) for row in table.rows()),
        enums=tuple(decode_enum(name, table) for name in table.enum_names),
        path=table.path,
    )
