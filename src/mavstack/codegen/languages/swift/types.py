"""Names, types and expressions of Swift."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

from mavstack.codegen.identifiers import distinct, enum_members, type_names
from mavstack.codegen.message_facts import enum_numbers, field_description, message_facts
from mavstack.codegen.templates import camel_case, one_line, string_literal

if TYPE_CHECKING:
    from collections.abc import Iterable

    from mavstack.codegen.library import Library
    from mavstack.dialects.model import FieldDefinition, MessageDefinition

_WORDS: Final = """
_ Any Protocol Self Type as associatedtype async await break case catch class continue default defer deinit do
else enum extension fallthrough false fileprivate for func guard if import in init inout internal is let nil
open operator precedencegroup private protocol public repeat rethrows return self static struct subscript
super switch throw throws true try typealias var where while
"""
RESERVED_WORDS: Final = frozenset(_WORDS.split())
#: Names of the runtime's types, and of the standard library's types that the runtime uses.
_TYPES: Final = """
Array ArraySlice Bool Checksum CustomStringConvertible Dialect Double EncodeError Encoder Error
ExpressibleByStringLiteral FieldDefinition FixedWidthInteger Float Hashable Header Int Int16 Int32 Int64 Int8
Message MessageDefinition MessageEncoder OptionSet Optional Packet Parser PayloadReader PayloadWriter
RawRepresentable Refusal SHA256 Sendable Sequence Signer SigningKey SigningTime Statistics String Text UInt16
UInt32 UInt64 UInt8 UTF8 Verifier Version WritableKeyPath
"""
_TAKEN_TYPES: Final = RESERVED_WORDS | frozenset(_TYPES.split())
#: Members of the struct of an enum, which an entry must not be named.
_TAKEN_ENTRIES: Final = RESERVED_WORDS | {"description", "hash", "hashValue", "rawValue"}
#: Members of the structs of messages; `payload` is the argument of an initializer.
_TAKEN_PROPERTIES: Final = RESERVED_WORDS | {"encodePayload", "hash", "hashValue"}

#: Types of values by their type in the definition.
WIRE_TYPES: Final = {
    "char": "UInt8",
    "uint8_t": "UInt8",
    "int8_t": "Int8",
    "uint16_t": "UInt16",
    "int16_t": "Int16",
    "uint32_t": "UInt32",
    "int32_t": "Int32",
    "uint64_t": "UInt64",
    "int64_t": "Int64",
    "float": "Float",
    "double": "Double",
}


class EnumType(NamedTuple):
    """The struct of an enum.

    Attributes:
        name: Name of the struct.
        number: Type of its raw value.
    """

    name: str
    number: str


def message_types(library: Library) -> dict[str, str]:
    """Return the names of the structs of all messages, by the name of the message."""
    return type_names((message.name for message in library.messages), _TAKEN_TYPES)


def properties(message: MessageDefinition) -> dict[str, str]:
    """Return the names of the properties by those of the fields."""
    # `init(payload:)` decodes a payload, so the only field of a message must not have this name.
    taken = _TAKEN_PROPERTIES | ({"payload"} if len(message.fields) == 1 else set())
    names = distinct((_camel(item.name) for item in message.fields), taken)
    return dict(zip((item.name for item in message.fields), names, strict=True))


def _camel(name: str) -> str:
    camel = camel_case(name)
    return camel if camel[:1].isalpha() else f"_{camel}"


def enum_types(library: Library) -> dict[str, EnumType]:
    """Return the structs of all enums by the names of the enums; one with a message's name ends in `Enum`."""
    names = type_names((enum.name for enum in library.enums), _TAKEN_TYPES)
    messages = frozenset(message_types(library).values())
    free = distinct((f"{name}Enum" if name in messages else name for name in names.values()), messages)
    return {
        enum: EnumType(name, f"{'' if number.signed else 'U'}Int{number.bits}")
        for (enum, number), name in zip(enum_numbers(library).items(), free, strict=True)
    }


def enum_values(library: Library, types: dict[str, EnumType]) -> Iterable[dict[str, object]]:
    """Yield the values for the template of each enum."""
    short = enum_members(library)
    for enum in library.enums:
        names = _entry_identifiers(short[enum.name])
        first = {entry.value: entry.name for entry in reversed(enum.entries)}
        found = types[enum.name]
        yield {
            "official": enum.name,
            "type": found.name,
            "repr": found.number,
            "bitmask": enum.bitmask,
            "doc": one_line(enum.description),
            "names": [{"value": value, "official": name} for value, name in sorted(first.items())],
            "entries": [
                {
                    "name": names[entry.name],
                    # The compiler warns about an option set with the raw value 0.
                    "value": "[]"
                    if enum.bitmask and not entry.value
                    else f"{found.name}(rawValue: {entry.value})",
                    "doc": " ".join([f"`{entry.name}`", one_line(entry.description)]).strip(),
                }
                for entry in enum.entries
            ],
        }


def _entry_identifiers(short: dict[str, str]) -> dict[str, str]:
    """Return the names of the constants by those of the entries."""
    names = distinct((_camel(name.strip("_").lower()) for name in short.values()), _TAKEN_ENTRIES)
    return dict(zip(short, names, strict=True))


def message_values(message: MessageDefinition, name: str, types: dict[str, EnumType]) -> dict[str, object]:
    """Return the values for the template of a message."""
    names = properties(message)
    return {
        **message_facts(message),
        "type": name,
        "doc": one_line(message.description),
        "fields": [_field_values(item, names[item.name], types) for item in message.fields],
    }


def _field_values(item: FieldDefinition, name: str, types: dict[str, EnumType]) -> dict[str, object]:
    enum = types[item.enum] if item.enum else None
    element = enum.name if enum else WIRE_TYPES[item.type]
    zero = f"{element}(rawValue: 0)" if enum else "0"
    if item.type == "char" and item.array_length:
        element, zero = "Text", "Text()"
    elif item.array_length:
        element, zero = f"[{element}]", f"[{element}](repeating: {zero}, count: {item.array_length})"
    decode, encode = _conversions(item, name, enum)
    return {
        "name": name,
        "type": element,
        "zero": zero,
        "decode": decode,
        "encode": encode,
        "doc": field_description(item, one_line),
        "definition": _definition(item),
    }


def _conversions(item: FieldDefinition, name: str, enum: EnumType | None) -> tuple[str, str]:
    """Return the expression that decodes a field, and the arguments that encode it."""
    wire, offset, count = WIRE_TYPES[item.type], item.offset, item.array_length
    kind = wire.lower() if wire in ("Float", "Double") else "integer"
    if item.type == "char" and count:
        return f"reader.text({offset}, {count})", f"self.{name}, {offset}, {count}"
    place = f"{offset}, {count}" if count else f"{offset}"
    read = f"reader.{kind}{'s' if count else ''}({place})"
    if not enum:
        return read, f"self.{name}, {place}"
    if count:
        element = f"{enum.name}(rawValue: {enum.number}(truncatingIfNeeded: $0))"
        encode = f"self.{name}.map {{ {wire}(truncatingIfNeeded: $0.rawValue) }}, {place}"
        return f"({read} as [{wire}]).map {{ {element} }}", encode
    if wire == enum.number:
        return f"{enum.name}(rawValue: {read})", f"self.{name}.rawValue, {place}"
    number = f"{enum.number}(truncatingIfNeeded: {read} as {wire})"
    return f"{enum.name}(rawValue: {number})", f"{wire}(truncatingIfNeeded: self.{name}.rawValue), {place}"


def _definition(item: FieldDefinition) -> str:
    parts = [f'"{item.name}", "{item.type}", {item.array_length}, at: {item.offset}']
    parts += [f"units: {string_literal(item.units)}"] if item.units else []
    parts += [f'enumeration: "{item.enum}"'] if item.enum else []
    parts += ["isExtension: true"] if item.extension else []
    return f"FieldDefinition({', '.join(parts)})"
