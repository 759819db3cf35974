"""Definitions as pages of text: a dialect, a message, an enum, an enum entry."""

from __future__ import annotations

from difflib import get_close_matches
from textwrap import wrap
from typing import TYPE_CHECKING, Any, NamedTuple

from mavstack.cli.common.output import table_lines
from mavstack.errors import UnknownMessageError

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from mavstack.dialects import Dialect
    from mavstack.dialects.model import (
        EnumDefinition,
        EnumEntry,
        EnumParam,
        FieldDefinition,
        MessageDefinition,
        Replacement,
    )

_WIDTH = 100


class Found(NamedTuple):
    """A definition that was found by its name, and its page."""

    facts: MessageDefinition | EnumDefinition | EnumEntry
    page: str


def dialect_facts(dialect: Dialect) -> dict[str, Any]:
    """Return the name, version and sizes of a dialect as values for JSON."""
    return {
        "name": dialect.name,
        "version": dialect.version,
        "messages": len(dialect),
        "own_messages": len(dialect.own_definition.messages),
        "enums": len(dialect.enums),
        "includes": [included.name for included in dialect.includes],
    }


def dialects_page(facts: Sequence[dict[str, Any]]) -> str:
    """Return a table of dialects."""
    rows = [
        (
            str(item["name"]),
            "" if item["version"] is None else str(item["version"]),
            str(item["messages"]),
            str(item["own_messages"]),
            str(item["enums"]),
            _shortened(", ".join(item["includes"]), 50),
        )
        for item in facts
    ]
    return _table(("NAME", "VERSION", "MESSAGES", "ITS OWN", "ENUMS", "INCLUDES"), rows, {"NAME", "INCLUDES"})


def contents_page(dialect: Dialect) -> str:
    """All messages and enums of a dialect."""
    definitions = [dialect[name].definition for name in dialect.names]
    rows = [
        (str(item.id), item.name, item.origin, f"{_marks(item)}{item.description}")
        for item in sorted(definitions, key=lambda item: item.id)
    ]
    messages = _table(("ID", "MESSAGE", "FROM", "WHAT"), rows, {"MESSAGE", "FROM", "WHAT"})
    enums = "\n".join(wrap("  ".join(sorted(dialect.enums)), _WIDTH))
    return f"{messages}\n\n{len(dialect.enums)} enums:\n{enums}"


def find(dialect: Dialect, name: str) -> Found:
    """Find a message, enum or entry by its name in any letter case, or a message by its id.

    Raises:
        UnknownMessageError: The dialect has no such definition.
    """
    if name.isdecimal():
        return _message(dialect[int(name)].definition)
    wanted = name.upper()
    for known in dialect.names:
        if known.upper() == wanted:
            return _message(dialect[known].definition)
    for known in dialect.enums:
        if known.upper() == wanted:
            enum = dialect.enum_definition(known)
            return Found(enum, enum_page(enum))
    return _entry(dialect, wanted)


def plain(value: object) -> object:
    """Return a definition as values for JSON, without its empty attributes."""
    if not isinstance(value, tuple):
        return value
    items = [plain(item) for item in value]
    if not hasattr(value, "_fields"):
        return items
    pairs = zip(value._fields, items, strict=True)
    return {name: found for name, found in pairs if name != "line" and not _is_empty(found)}


def _is_empty(found: object) -> bool:
    # 0 is not empty: it may be an id, a value, an offset or a limit.
    return found is None or found is False or found in ("", [])


def message_page(message: MessageDefinition) -> str:
    """Return the page of a message with its fields in the order of declaration."""
    extended = f", {message.length} with extensions" if message.length > message.base_length else ""
    head = [
        f"{message.name} ({message.id}), {message.origin}",
        *wrap(message.description, _WIDTH),
        *_warnings(message),
        f"CRC_EXTRA {message.crc_extra}, payload {message.base_length} bytes{extended}",
        "",
    ]
    rows = [(item.name, _type(item), str(item.offset), _units(item), _notes(item)) for item in message.fields]
    return (
        "\n".join(head)
        + "\n"
        + _table(("FIELD", "TYPE", "OFFSET", "UNITS", "NOTES"), rows, {"FIELD", "TYPE", "UNITS", "NOTES"})
    )


def enum_page(enum: EnumDefinition) -> str:
    """Return the page of an enum with its entries."""
    kind = "a bitmask" if enum.bitmask else "an enum"
    rows = [(_value(entry, enum), entry.name, f"{_marks(entry)}{_labels(entry)}") for entry in enum.entries]
    head = [
        f"{enum.name}, {kind} of {len(enum.entries)}",
        *wrap(enum.description, _WIDTH),
        *_warnings(enum),
        "",
    ]
    return "\n".join(head) + "\n" + _table(("VALUE", "ENTRY", "NOTES"), rows, {"ENTRY", "NOTES"})


def entry_page(entry: EnumEntry, enum: EnumDefinition) -> str:
    """Return the page of an enum entry; for a command with its parameters."""
    head = [
        f"{entry.name} ({_value(entry, enum)}), an entry of {enum.name}",
        *wrap(entry.description, _WIDTH),
        *_warnings(entry),
    ]
    if not entry.params:
        return "\n".join(head)
    rows = [
        (str(param.index), "reserved" if param.reserved else param.label, param.units, _param_notes(param))
        for param in entry.params
    ]
    table = _table(("PARAM", "LABEL", "UNITS", "NOTES"), rows, {"LABEL", "UNITS", "NOTES"})
    return "\n".join([*head, "", table])


def _message(message: MessageDefinition) -> Found:
    return Found(message, message_page(message))


def _entry(dialect: Dialect, wanted: str) -> Found:
    for name in dialect.enums:
        if wanted in map(str.upper, dialect.enum_values(name)):
            enum = dialect.enum_definition(name)
            entry = next(entry for entry in enum.entries if entry.name.upper() == wanted)
            return Found(entry, entry_page(entry, enum))
    near = get_close_matches(wanted, [*dialect.names, *dialect.enums], n=1)
    hint = f"; did you mean {near[0]}?" if near else ""
    raise UnknownMessageError(f"dialect {dialect.name} has no message, enum or entry {wanted}{hint}")


def _table(head: Sequence[str], rows: Sequence[Sequence[str]], left: set[str]) -> str:
    return "\n".join(table_lines(head, rows, left))


def _type(item: FieldDefinition) -> str:
    return f"{item.type}[{item.array_length}]" if item.array_length else item.type


def _units(item: FieldDefinition) -> str:
    return f"{item.units} × {item.multiplier}" if item.multiplier else item.units  # noqa: RUF001


def _notes(item: FieldDefinition) -> str:
    parts = [
        "extension" if item.extension else "",
        item.enum,
        "instance" if item.instance else "",
        _range(item.minimum, item.maximum),
        f"unknown: {item.invalid}" if item.invalid else "",
        item.description,
    ]
    return _joined(parts)


def _param_notes(param: EnumParam) -> str:
    default = f"default {param.default}" if param.default else ""
    return _joined([param.enum, _range(param.minimum, param.maximum), default, param.description])


def _range(minimum: float | None, maximum: float | None) -> str:
    if minimum is None and maximum is None:
        return ""
    return f"{'' if minimum is None else minimum} … {'' if maximum is None else maximum}".strip()


def _value(entry: EnumEntry, enum: EnumDefinition) -> str:
    return f"0x{entry.value:X}" if enum.bitmask else str(entry.value)


def _labels(entry: EnumEntry) -> str:
    """Return the description of an entry and the labels of its parameters."""
    labels = ", ".join(param.label for param in entry.params if param.label)
    return _shortened(_joined([entry.description, labels]), 90)


def _marks(item: MessageDefinition | EnumEntry) -> str:
    """Return a warning in one word for a line of a list; empty if there is none."""
    if item.deprecated:
        return "[deprecated] "
    return "[superseded] " if item.superseded else "[work in progress] " if item.wip else ""


def _warnings(item: MessageDefinition | EnumDefinition | EnumEntry) -> Iterator[str]:
    """Yield the warnings about a definition, with its replacement."""
    for word, mark in (("deprecated", item.deprecated), ("superseded", item.superseded)):
        if mark is not None:
            yield f"{word}{_since(mark)}"
    if item.wip:
        yield "work in progress: it may still change"


def _since(mark: Replacement) -> str:
    since = f" since {mark.since}" if mark.since else ""
    return f"{since}, use {mark.replaced_by}" if mark.replaced_by else since


def _joined(parts: Sequence[str]) -> str:
    return "; ".join(part for part in parts if part)


def _shortened(text: str, width: int) -> str:
    return text if len(text) <= width else f"{text[: width - 1]}…"
