"""Conversion between definitions and table lines, without loss.

The row of a message is `[id, name, CRC_EXTRA, base length, length, fields]` with `[name, type, array length,
offset, enum]` for each field, in the order of the definition. Its metadata is `[message metadata,
{field: metadata}]`. Metadata objects have only those attributes that differ from their default, so that a
line stays short and a change is one changed line. A field at or after the base length is an extension.
"""

from __future__ import annotations

import json
from dataclasses import MISSING, fields
from typing import TYPE_CHECKING, Any, TypeVar

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
    from collections.abc import Iterator

_IN_MESSAGE_ROW = frozenset({"id", "name", "fields", "crc_extra", "base_length", "length", "origin", "line"})
_IN_FIELD_ROW = frozenset({"name", "type", "array_length", "offset", "enum", "extension", "line"})
_IN_ENUM_ROW = frozenset({"name", "entries", "line"})
_IN_ENTRY_ROW = frozenset({"name", "value", "line"})

_Value = TypeVar(
    "_Value", MessageDefinition, FieldDefinition, EnumDefinition, EnumEntry, EnumParam, Replacement
)


def _metadata(value: object, excluded: frozenset[str] = frozenset()) -> dict[str, Any]:
    """Return the attributes of a definition that differ from their default."""
    found: dict[str, Any] = {}
    for item in fields(value):  # type: ignore[arg-type]
        content = getattr(value, item.name)
        if item.name in excluded or (item.default is not MISSING and content == item.default):
            continue
        if isinstance(content, Replacement):
            content = _metadata(content)
        elif isinstance(content, tuple):
            content = [_metadata(param) for param in content]
        found[item.name] = content
    return found


def _restore(definition_class: type[_Value], metadata: dict[str, Any], row: dict[str, Any]) -> _Value:
    """Return the definition from which `_metadata` was made."""
    for mark in ("deprecated", "superseded"):
        if mark in metadata:
            row[mark] = Replacement(**metadata[mark])
    if "params" in metadata:
        row["params"] = tuple(EnumParam(**param) for param in metadata["params"])
    return definition_class(**{**metadata, **row})


def _line(*values: object) -> str:
    return "\t".join(json.dumps(value, ensure_ascii=False, separators=(",", ":")) for value in values)


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
        field_metadata = {item.name: _metadata(item, _IN_FIELD_ROW) for item in message.fields}
        kept = {name: metadata for name, metadata in field_metadata.items() if metadata}
        yield _line(message_row(message), [_metadata(message, _IN_MESSAGE_ROW), kept])
    for enum in definition.enums:
        entries = [[entry.value, entry.name, _metadata(entry, _IN_ENTRY_ROW)] for entry in enum.entries]
        yield f"{enum.name}\t{_line([_metadata(enum, _IN_ENUM_ROW), entries])}"


def encode_table(definition: DialectDefinition) -> Table:
    """Return the table of one definition file."""
    return Table(table_lines(definition), definition.path)


def decode_message(row: MessageRow, table: Table) -> MessageDefinition:
    """Return the definition of a message in a table."""
    number, name, crc_extra, base_length, length, field_rows = row
    metadata, field_metadata = table.message_metadata(name)
    fields_ = tuple(
        _restore(
            FieldDefinition,
            field_metadata.get(field_name, {}),
            {
                "name": field_name,
                "type": kind,
                "array_length": array_length,
                "offset": offset,
                "enum": enum,
                "extension": offset >= base_length,
            },
        )
        for field_name, kind, array_length, offset, enum in field_rows
    )
    return _restore(
        MessageDefinition,
        metadata,
        {
            "id": number,
            "name": name,
            "fields": fields_,
            "crc_extra": crc_extra,
            "base_length": base_length,
            "length": length,
            "origin": table.name,
        },
    )


def decode_enum(name: str, table: Table) -> EnumDefinition:
    """Return the definition of an enum in a table, with the entries of this file only."""
    metadata, entry_rows = table.enum_row(name)
    entries = tuple(
        _restore(EnumEntry, more, {"value": value, "name": entry}) for value, entry, more in entry_rows
    )
    return _restore(EnumDefinition, metadata, {"name": name, "entries": entries})


def decode_table(table: Table) -> DialectDefinition:
    """Return the definition from which a table was made."""
    return DialectDefinition(
        name=table.name,
        version=table.header["version"],
        number=table.header["number"],
        includes=table.includes,
        messages=tuple(decode_message(row, table) for row in table.rows),
        enums=tuple(decode_enum(name, table) for name in table.enum_names),
        path=table.path,
    )
